"""Believed vehicle of the flight computer: masses by configuration, the airframe trimmed on the ground,
engines and thrusters, and the backshell that leaves the lander.

The nominal capsule is trimmed at each Mach number, and its angle of attack, drag and lift are tabulated.
"""

from __future__ import annotations

from functools import lru_cache
from math import pi, radians

import numpy as np

from edl6dof.config.dtype import dtype_of, fill
from edl6dof.environment.gas import GAS, fill_gas
from edl6dof.fsw.guidance.entry.airframe import mach_nodes
from edl6dof.fsw.onboard import CONFIGURATION
from edl6dof.interface.capacities import MAX_PARTS
from edl6dof.interface.effectors import THRUSTER_GROUPS
from edl6dof.kernels import kernel
from edl6dof.scenario.schema import Scenario
from edl6dof.spatial.elementary import cos, sin, tan
from edl6dof.vehicle.aerodynamics.capsule import capsule_aero, capsule_coefficients
from edl6dof.vehicle.aerodynamics.surfaces import wing_force
from edl6dof.vehicle.mass import MassParams, Part, Tank, loaded
from edl6dof.vehicle.parachutes.parachute import SUSPENSION
from edl6dof.vehicle.propulsion.engine_models import THRUSTER_SET
from edl6dof.vehicle.propulsion.rcs import fill_branches
from edl6dof.vehicle.vehicle import VehicleParams, fill_suspension

#: Mach number at which the one believed drag and lift coefficient are taken.
BELIEF_MACH = 15.0
#: Density (kg/m3) dense enough for continuum flow.
CONTINUUM = 1e-3
#: Largest difference (rad) of the trim from the commanded angle of attack.
SEARCH = radians(12.0)
#: Angle of attack (rad) at which the slope of the side force is taken.
TILTED = radians(2.0)


def believe_vehicle(record: np.void, scenario: Scenario, tables: np.ndarray) -> None:
    """Fill the believed vehicle: masses, airframe, engines, thrusters and propellant branches."""
    vehicle = scenario.vehicle
    record["entry_mass"] = vehicle.mass.entry_kg
    _believe_airframe(record, scenario, tables)
    record["configuration"] = _configurations(vehicle.mass, tuple(vehicle.parts), tuple(vehicle.tanks))
    hung = np.zeros(len(record["pack"]), SUSPENSION)
    fill_suspension(hung, vehicle)
    record["pack"] = hung["pack"]
    _hang(record["configuration"], hung, vehicle)
    record["n_engines"] = len(vehicle.engines)
    for slot, engine in zip(record["engines"], vehicle.engines, strict=False):
        axial = slot["axial"] = abs(engine.direction[0])
        slot["full_thrust"] = axial * engine.full_thrust_n
        slot["specific_impulse"] = axial * engine.full_specific_impulse_s
        slot["throttle_min"] = axial * engine.throttle_min_n
        slot["throttle_max"] = axial * engine.throttle_max_n
        slot["by_thrusters"] = 1.0 if engine.model == THRUSTER_SET.name else 0.0
    record["n_thrusters"] = len(vehicle.rcs.thrusters)
    for slot, jet in zip(record["thrusters"], vehicle.rcs.thrusters, strict=False):
        slot["position"], slot["direction"] = jet.position_m, jet.direction
        slot["thrust"], slot["minimum_pulse"] = jet.thrust_n, jet.minimum_pulse_s
        slot["specific_impulse"] = jet.specific_impulse_s
        slot["group"] = THRUSTER_GROUPS.index(jet.group)
    fill_branches(record["branches"], vehicle.rcs.laid_branches, vehicle.rcs.thrusters)


@lru_cache(maxsize=16)
def _configurations(mass: MassParams, parts: tuple[Part, ...], tanks: tuple[Tank, ...]) -> np.ndarray:
    """Mass, centre and principal inertia, with full tanks, for each set of parts that are gone."""
    table = np.zeros(2**MAX_PARTS, CONFIGURATION)
    for gone, record in enumerate(table[: 2 ** len(parts)]):
        attached = tuple(part for bit, part in enumerate(parts) if not gone >> bit & 1)
        record["mass"], record["centre"], inertia = loaded(mass, parts, tanks, attached)
        record["inertia"] = np.diag(inertia)
    return table


def _hang(configurations: np.ndarray, hung: np.ndarray, vehicle: VehicleParams) -> None:
    """Set the point of the riser where a parachute is out of its pack and its carrier still attached."""
    configurations["hung_at"] = configurations["centre"]
    gone = np.arange(len(configurations))
    for chute, slot in zip(vehicle.parachutes, hung, strict=False):
        if slot["pack"] >= 0:
            carried = slot["carrier"] < 0 or gone >> max(slot["carrier"], 0) & 1 == 0
            configurations["hung_at"][(gone >> slot["pack"] & 1 == 1) & carried] = chute.confluence_m


def _believe_airframe(record: np.void, scenario: Scenario, tables: np.ndarray) -> None:
    """Fill drag area, lift-to-drag ratio and, relative to these two, the ``AIRFRAME`` record."""
    aero, airframe = scenario.vehicle.aero, record["airframe"]
    goal = radians(scenario.flight_software.guidance.entry.trim_alpha_deg)
    airframe["alpha"] = goal
    for name in ("drag", "lift", "drag_with_wing"):
        airframe[name] = 1.0
    if aero.model == "lift_drag":
        record["drag_area"] = aero.lift_drag.drag_coefficient * aero.lift_drag.reference_area_m2
        record["lift_to_drag"] = aero.lift_drag.lift_to_drag
    if aero.model != "capsule":
        return
    vehicle, gas = np.zeros(1, dtype_of(VehicleParams)), np.zeros(1, GAS)
    fill(vehicle[0], scenario.vehicle)
    fill_gas(gas[0], scenario.planet.gas)
    axial, normal, _, _ = capsule_coefficients(
        vehicle[0]["aero"]["capsule"],
        table=tables[0]["aero"],
        gas=gas[0],
        mach=BELIEF_MACH,
        rho=CONTINUUM,
        angle=abs(goal),
    )
    drag = axial * cos(abs(goal)) + normal * sin(abs(goal))
    lift = axial * sin(abs(goal)) - normal * cos(abs(goal))
    record["drag_area"] = drag * np.pi / 4.0 * np.square(aero.capsule.diameter_m)
    record["lift_to_drag"] = ratio = lift / drag
    airframe["wing_mach"] = _wing_opens(scenario, "mach")
    airframe["wing_speed"] = _wing_opens(scenario, "speed_m_s")
    # a point mass flies at the commanded angle
    search = SEARCH if scenario.dynamics == "six_dof" else 0.0
    alpha, drag_areas, lift_areas, braked, side = _along_mach(
        vehicle, tables=tables["aero"], gases=gas, nodes=mach_nodes(), goal=goal, search=search
    )
    airframe["alpha"] = alpha
    airframe["drag"] = drag_areas / record["drag_area"]
    airframe["lift"] = lift_areas / drag_areas / ratio if ratio else 1.0
    airframe["drag_with_wing"] = braked / record["drag_area"]
    airframe["side"], airframe["side_with_wing"], airframe["offset_with_wing"] = side


def _wing_opens(scenario: Scenario, quantity: str) -> float:
    """Value of ``quantity`` at which the mission opens the trim wing; 0 if it does so otherwise or never."""
    wings = (
        event.when
        for phase in scenario.mission.phases
        for event in phase.events
        if event.action == "extend" and event.component != "landing_gear"
    )
    return next((when.value for when in wings if when.quantity == quantity), 0.0)


@kernel
def _along_mach(vehicles, tables, gases, nodes, goal, search):
    """Angle of attack (rad), drag and lift area (m2) at trim, and drag area with the wing open at zero angle
    of attack, at each Mach number; and slope of the side force at trim, slope and offset with the wing open.
    """
    vehicle, table, gas = vehicles[0], tables[0], gases[0]
    alpha, drag = np.empty(len(nodes)), np.empty(len(nodes))
    lift, braked, side = np.empty(len(nodes)), np.empty(len(nodes)), np.empty((3, len(nodes)))
    for i in range(len(nodes)):
        mach = nodes[i]
        alpha[i] = _trim(vehicle, table, gas, mach, goal, search=search)
        drag[i], lift[i] = _drag_and_lift(vehicle, table, gas, mach, alpha=alpha[i], wing=0.0)
        braked[i], _ = _drag_and_lift(vehicle, table, gas, mach, alpha=0.0, wing=1.0)
        tilted = alpha[i] if abs(alpha[i]) > TILTED else TILTED
        side[0, i] = _side(vehicle, table, gas, mach, alpha=tilted, wing=0.0) / tan(tilted)
        up = _side(vehicle, table, gas, mach, alpha=TILTED, wing=1.0)
        down = _side(vehicle, table, gas, mach, alpha=-TILTED, wing=1.0)
        side[1, i], side[2, i] = 0.5 * (up - down) / tan(TILTED), 0.5 * (up + down)
    return alpha, drag, lift, braked, side


@kernel
def _side(vehicle, table, gas, mach, alpha, wing):
    """Ratio of the forces along z and x."""
    fx, fz, _ = _force_and_moment(vehicle, table, gas, mach, alpha, wing=wing)
    return fz / fx


@kernel
def _drag_and_lift(vehicle, table, gas, mach, alpha, wing):
    """Drag and upward lift area (m2) at bank 0."""
    fx, fz, _ = _force_and_moment(vehicle, table, gas, mach, alpha, wing=wing)
    return -(fx * cos(alpha) + fz * sin(alpha)), fx * sin(alpha) - fz * cos(alpha)


@kernel
def _trim(vehicle, table, gas, mach, goal, search):
    """Angle of attack (rad) without pitching moment within ``search`` of ``goal``, else ``goal``."""
    low, high = goal - search, goal + search
    at_low = _force_and_moment(vehicle, table, gas, mach, alpha=low, wing=0.0)[2]
    at_high = _force_and_moment(vehicle, table, gas, mach, alpha=high, wing=0.0)[2]
    if not at_low * at_high < 0.0:
        return goal
    rising = at_high > 0.0
    while True:
        middle = 0.5 * (low + high)
        if not (low < middle < high and high - low > 1e-12):
            return middle
        if (_force_and_moment(vehicle, table, gas, mach, alpha=middle, wing=0.0)[2] > 0.0) == rising:
            high = middle
        else:
            low = middle


@kernel
def _force_and_moment(vehicle, table, gas, mach, alpha, wing):
    """Fx and Fz (m2, force over dynamic pressure) and pitching moment about the centre of mass (m3)."""
    v_air = cos(alpha), 0.0, sin(alpha)
    air = gas, 1.0, mach, CONTINUUM
    fx, _, fz, _, my, _ = capsule_aero(vehicle.aero, table, air, v_air, (0.0, 0.0, 0.0))
    cg_x, cg_z = vehicle.mass.entry_centre[0], vehicle.mass.entry_centre[2]
    my += (0.0 - cg_z) * fx - (table.moment_reference_x - cg_x) * fz
    for i in range(vehicle.n_surfaces):
        gx, _, gz, _, ny, _ = wing_force(vehicle.surfaces[i], wing, 1.0, v_air)
        ny += -cg_z * gx + cg_x * gz
        fx, fz, my = fx + gx, fz + gz, my + ny
    return fx, fz, my


def believe_drifter(record: np.void, vehicle: VehicleParams) -> None:
    """Fill a ``DRIFTER`` record of zeros from the nominal backshell and its parachute, if there is one."""
    masses = {part.name: part.mass_kg for part in vehicle.parts}
    shells = [part for part in vehicle.parts if part.shape == "backshell"]
    for chute in vehicle.parachutes:
        if shells and chute.carried_by == shells[0].name:
            record["mass"] = shells[0].mass_kg + (masses[chute.pack] if chute.pack is not None else 0.0)
            canopy = pi / 4.0 * chute.diameter_m * chute.diameter_m * chute.drag_coefficient
            record["drag_area"] = shells[0].drag_area_m2 + canopy
            record["length"] = chute.line_length_m
