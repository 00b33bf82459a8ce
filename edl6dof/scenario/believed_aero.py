"""Trim the nominal vehicle on the ground and tabulate for the flight computer its angle of attack, and what
drag and lift follow, over Mach number.
"""

from __future__ import annotations

from math import radians

import numpy as np

from edl6dof.config.dtype import dtype_of, fill
from edl6dof.environment.gas import GAS, fill_gas
from edl6dof.fsw.guidance.entry.prediction.airframe import mach_nodes
from edl6dof.kernels import kernel
from edl6dof.scenario.schema import Scenario
from edl6dof.spatial.elementary import cos, sin
from edl6dof.vehicle.aerodynamics.capsule import capsule_aero
from edl6dof.vehicle.aerodynamics.surfaces import wing_force
from edl6dof.vehicle.vehicle import VehicleParams

#: Density (kg/m3) dense enough for continuum flow.
CONTINUUM = 1e-3
#: How far from the commanded angle of attack (rad) the trim is sought.
SEARCH = radians(12.0)


def fill_airframe(
    airframe: np.void, scenario: Scenario, tables: np.ndarray, drag_area: float, lift_to_drag: float
) -> None:
    """Fill an ``AIRFRAME`` record for the nominal capsule of ``scenario``, relative to one drag area and
    lift-to-drag ratio.
    """
    vehicle = np.zeros(1, dtype_of(VehicleParams))
    fill(vehicle[0], scenario.vehicle)
    gas = np.zeros(1, GAS)
    fill_gas(gas[0], scenario.planet.gas)
    airframe["wing_mach"] = _wing_opens(scenario, "mach")
    airframe["wing_speed"] = _wing_opens(scenario, "speed_m_s")
    goal = radians(scenario.flight_software.guidance.entry.trim_alpha_deg)
    # a point mass flies at the angle it is told
    search = SEARCH if scenario.dynamics == "six_dof" else 0.0
    alpha, drag, lift, braked = _along_mach(vehicle, tables["aero"], gas, mach_nodes(), goal, search)
    airframe["alpha"] = alpha
    airframe["drag"] = drag / drag_area
    airframe["lift"] = lift / drag / lift_to_drag if lift_to_drag else 1.0
    airframe["drag_with_wing"] = braked / drag_area


def _wing_opens(scenario: Scenario, quantity: str) -> float:
    """Value of ``quantity`` at which the mission table opens the trim wing; 0 when it does not, or by
    another.
    """
    events = [
        event
        for phase in scenario.mission.phases
        for event in phase.events
        if event.action == "extend" and event.thing != "landing_gear"
    ]
    return next((event.when.value for event in events if event.when.quantity == quantity), 0.0)


@kernel
def _along_mach(vehicles, tables, gases, nodes, goal, search):
    """Angle of attack (rad), drag and lift area (m2) at trim, and drag area with the wing open at zero angle
    of attack, at each Mach number.
    """
    vehicle, table, gas = vehicles[0], tables[0], gases[0]
    alpha, drag = np.empty(len(nodes)), np.empty(len(nodes))
    lift, braked = np.empty(len(nodes)), np.empty(len(nodes))
    for i in range(len(nodes)):
        mach = nodes[i]
        alpha[i] = _trim(vehicle, table, gas, mach, goal, search)
        drag[i], lift[i] = _drag_and_lift(vehicle, table, gas, mach, alpha[i], 0.0)
        braked[i], _ = _drag_and_lift(vehicle, table, gas, mach, 0.0, 1.0)
    return alpha, drag, lift, braked


@kernel
def _drag_and_lift(vehicle, table, gas, mach, alpha, wing):
    """Drag and upward lift area (m2) at bank 0."""
    fx, fz, _ = _force_and_moment(vehicle, table, gas, mach, alpha, wing)
    return -(fx * cos(alpha) + fz * sin(alpha)), fx * sin(alpha) - fz * cos(alpha)


@kernel
def _trim(vehicle, table, gas, mach, goal, search):
    """Angle of attack (rad) without pitching moment within ``search`` of the commanded one; that itself where
    there is none.
    """
    low, high = goal - search, goal + search
    at_low, at_high = (
        _force_and_moment(vehicle, table, gas, mach, low, 0.0)[2],
        _force_and_moment(vehicle, table, gas, mach, high, 0.0)[2],
    )
    if not at_low * at_high < 0.0:
        return goal
    rising = at_high > 0.0
    while True:
        middle = 0.5 * (low + high)
        if not (low < middle < high and high - low > 1e-12):
            return middle
        if (_force_and_moment(vehicle, table, gas, mach, middle, 0.0)[2] > 0.0) == rising:
            high = middle
        else:
            low = middle


@kernel
def _force_and_moment(vehicle, table, gas, mach, alpha, wing):
    """Fx and Fz (m2, force over dynamic pressure) and pitching moment about the centre of mass (m3)."""
    u, w = cos(alpha), sin(alpha)
    fx, _, fz, _, my, _ = capsule_aero(
        vehicle.aero, table, gas, 1.0, mach, CONTINUUM, u, 0.0, w, 0.0, 0.0, 0.0
    )
    cg_x, cg_z = vehicle.mass.entry_centre[0], vehicle.mass.entry_centre[2]
    my += (0.0 - cg_z) * fx - (table.moment_reference_x - cg_x) * fz
    for i in range(vehicle.n_surfaces):
        gx, _, gz, _, ny, _ = wing_force(vehicle.surfaces[i], wing, 1.0, u, 0.0, w)
        ny += -cg_z * gx + cg_x * gz
        fx, fz, my = fx + gx, fz + gz, my + ny
    return fx, fz, my
