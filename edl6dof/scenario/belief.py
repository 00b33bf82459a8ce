"""What the flight computer believes: filled from the nominal scenario, blind to dispersions and faults."""

from __future__ import annotations

from functools import lru_cache
from math import radians

import numpy as np

from edl6dof.config.dtype import dtype_of, fill
from edl6dof.environment.atmosphere import ATMOSPHERE, air, fill_atmosphere
from edl6dof.environment.gas import GAS, fill_gas
from edl6dof.fsw.check_out import fill_check_out
from edl6dof.fsw.guidance.entry.registry import ENTRY_LAWS
from edl6dof.fsw.navigation.filters.registry import NAVIGATION_FILTERS
from edl6dof.fsw.onboard import CONFIGURATION, NODES, ONBOARD
from edl6dof.interface.capacities import MAX_PARTS
from edl6dof.interface.thrusters import THRUSTER_GROUPS
from edl6dof.scenario.aim import plan
from edl6dof.scenario.believed_aero import fill_airframe
from edl6dof.scenario.believed_drifter import believe_drifter
from edl6dof.scenario.believed_instruments import believe_instruments
from edl6dof.scenario.events import fill_mission
from edl6dof.scenario.expected_descent import wind_at, wind_of
from edl6dof.scenario.schema import Scenario
from edl6dof.scenario.site import fill_site
from edl6dof.sensors.registry import SENSOR_FAMILY
from edl6dof.spatial.elementary import cos, log, sin
from edl6dof.vehicle.aerodynamics.capsule import capsule_coefficients
from edl6dof.vehicle.mass import MassParams, Part, Tank, loaded
from edl6dof.vehicle.parachutes.parachute import SUSPENSION
from edl6dof.vehicle.propulsion.branches import fill_branches
from edl6dof.vehicle.propulsion.engine_models import thruster_set
from edl6dof.vehicle.vehicle import VehicleParams, fill_suspension

#: Sections of the flight software that stand in the record as they are.
FILLED = (
    *("rates", "navigation", "hazard", "guidance", "control", "estimation", "diagnosis", "allocation"),
    "modulation",
)
#: Mach number at which the one believed drag and lift coefficient are taken.
BELIEF_MACH = 15.0
#: How far (m) the believed atmosphere reaches at least below the site and above the initial state.
BEYOND = 1000.0


def believe(scenario: Scenario, tables: np.ndarray) -> np.ndarray:
    """What the flight computer believes, shape (1,): nominal models, no perturbation, and of the wind
    the expected mean.
    """
    onboard = np.zeros(1, ONBOARD)
    record = onboard[0]
    planet = scenario.planet
    record["planet"]["mu"] = planet.gravity.mu_m3_s2
    record["planet"]["equatorial_radius"] = planet.equatorial_radius_m
    record["planet"]["flattening"] = planet.flattening
    record["planet"]["rotation_rate"] = planet.rotation_rate_rad_s
    record["planet"]["j2"] = 0.0 if planet.gravity.model in ("central", "none") else planet.gravity.j2
    record["planet"]["gravity_radius"] = planet.gravity.reference_radius_m
    record["planet"]["sutton_graves_constant"] = planet.gas.sutton_graves_constant
    _believe_atmosphere(record["atmosphere"], scenario, tables)
    _believe_vehicle(record["vehicle"], scenario, tables)
    software = scenario.flight_software
    for name in FILLED:
        fill(record[name], getattr(software, name))
    record["guidance"]["entry"]["heading"]["speed"] = software.guidance.entry.heading_below_m_s
    record["navigation"]["filter"] = NAVIGATION_FILTERS.names.index(scenario.navigation_filter)
    fill_check_out(record["check_out"], software.check_out, scenario.thruster_names)
    sensors = scenario.sensors_in_flight
    unit = sensors.inertial_unit if "inertial_unit" in sensors.flown else sensors.imu
    record["imu_delay"] = unit.delay_cycles / software.rates.base_hz
    believe_instruments(record["instruments"], scenario)
    record["flow_meters"] = any("branch_used" in SENSOR_FAMILY.member(name).writes for name in sensors.flown)
    believe_drifter(record["drifter"], scenario.vehicle)
    fill_mission(record["mission"], scenario.mission, scenario.vehicle)
    _set_site(record["site"], scenario)
    if any(phase.guidance == "entry" for phase in scenario.mission.phases):
        planned, law = plan(onboard, scenario, tables), ENTRY_LAWS.member(software.guidance.entry.law)
        if law.plan is not None:
            law.plan(onboard, planned)
    return onboard


def _believe_atmosphere(record: np.void, scenario: Scenario, tables: np.ndarray) -> None:
    """Against altitude: the flight computer takes the areoid to stand everywhere where it does at the
    landing site.
    """
    nominal = np.zeros(1, ATMOSPHERE)
    fill_atmosphere(nominal[0], scenario.atmosphere.undispersed, tables[0]["atmosphere"])
    gas = np.zeros(1, GAS)
    fill_gas(gas[0], scenario.planet.gas)
    wind = wind_of(scenario.flight_software.guidance.entry.expected_wind)
    heights, areoid = np.linspace(*_span_of_air(scenario), NODES), scenario.site_areoid_m
    record["bottom"], record["top"], record["spacing"] = (
        heights[0] + areoid,
        heights[-1] + areoid,
        heights[1] - heights[0],
    )
    for i, height in enumerate(heights):
        density, _, _, sound = air(nominal[0], gas[0], tables[0]["atmosphere"], height)
        record["ln_density"][i] = log(max(density, 1e-30))
        record["speed_of_sound"][i] = sound
        north, east = wind_at(wind, tables[0]["atmosphere"], height)
        record["wind_north"][i], record["wind_east"][i] = north, east


def _span_of_air(scenario: Scenario) -> tuple[float, float]:
    """Lowest and highest height (m above the areoid) of the believed atmosphere: at least from below the site
    to above the initial state.
    """
    air, start = scenario.atmosphere, scenario.initial_altitude_m - scenario.site_areoid_m
    bottom = min(air.bottom_m, scenario.terrain.site_elevation_m - BEYOND, start - BEYOND)
    return bottom, max(air.top_m, start + BEYOND)


def _believe_vehicle(record: np.void, scenario: Scenario, tables: np.ndarray) -> None:
    vehicle = scenario.vehicle
    mass = vehicle.mass
    record["entry_mass"] = mass.entry_kg
    airframe = record["airframe"]
    for name in ("drag", "lift", "drag_with_wing"):
        airframe[name] = 1.0
    airframe["alpha"] = radians(scenario.flight_software.guidance.entry.trim_alpha_deg)
    if vehicle.aero.model == "capsule":
        truth = np.zeros(1, dtype_of(VehicleParams))
        fill(truth[0], vehicle)
        alpha = radians(abs(scenario.flight_software.guidance.entry.trim_alpha_deg))
        capsule = truth[0]["aero"]["capsule"]
        gas = np.zeros(1, GAS)
        fill_gas(gas[0], scenario.planet.gas)
        axial, normal, _, _ = capsule_coefficients(
            capsule, tables[0]["aero"], gas[0], BELIEF_MACH, 1e-3, alpha
        )
        drag = axial * cos(alpha) + normal * sin(alpha)
        lift = axial * sin(alpha) - normal * cos(alpha)
        record["drag_area"] = drag * np.pi / 4.0 * np.square(vehicle.aero.capsule.diameter_m)
        record["lift_to_drag"] = lift / drag
        fill_airframe(airframe, scenario, tables, float(record["drag_area"]), float(record["lift_to_drag"]))
    elif vehicle.aero.model == "lift_drag":
        record["drag_area"] = (
            vehicle.aero.lift_drag.drag_coefficient * vehicle.aero.lift_drag.reference_area_m2
        )
        record["lift_to_drag"] = vehicle.aero.lift_drag.lift_to_drag
    record["configuration"] = _configurations(mass, tuple(vehicle.parts), tuple(vehicle.tanks))
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
        slot["by_thrusters"] = 1.0 if engine.model == thruster_set.NAME else 0.0
    record["n_thrusters"] = len(vehicle.rcs.thrusters)
    for slot, jet in zip(record["thrusters"], vehicle.rcs.thrusters, strict=False):
        slot["position"], slot["direction"] = jet.position_m, jet.direction
        slot["thrust"], slot["minimum_pulse"] = jet.thrust_n, jet.minimum_pulse_s
        slot["specific_impulse"] = jet.specific_impulse_s
        slot["group"] = THRUSTER_GROUPS.index(jet.group)
    fill_branches(record["branches"], vehicle.rcs.laid_branches, vehicle.rcs.thrusters)


@lru_cache(maxsize=16)
def _configurations(mass: MassParams, parts: tuple[Part, ...], tanks: tuple[Tank, ...]) -> np.ndarray:
    """Mass, centre and principal inertia, with full tanks, by the set of the parts that are gone."""
    table = np.zeros(2**MAX_PARTS, CONFIGURATION)
    for gone, record in enumerate(table[: 2 ** len(parts)]):
        attached = tuple(part for bit, part in enumerate(parts) if not gone >> bit & 1)
        record["mass"], record["centre"], inertia = loaded(mass, parts, tanks, attached)
        record["inertia"] = np.diag(inertia)
    return table


def _hang(configurations: np.ndarray, hung: np.ndarray, vehicle: VehicleParams) -> None:
    """Where the riser pulls, in the configurations in which a pack is gone and what carries it is not."""
    configurations["hung_at"] = configurations["centre"]
    gone = np.arange(len(configurations))
    for chute, slot in zip(vehicle.parachutes, hung, strict=False):
        if slot["pack"] >= 0:
            carried = slot["carrier"] < 0 or gone >> max(slot["carrier"], 0) & 1 == 0
            configurations["hung_at"][(gone >> slot["pack"] & 1 == 1) & carried] = chute.confluence_m


def _set_site(record: np.void, scenario: Scenario) -> None:
    fill_site(record["frame"], scenario)
    terrain = scenario.terrain
    record["latitude"], record["longitude"] = (
        radians(terrain.site_latitude_deg),
        radians(terrain.site_longitude_deg),
    )
    record["aim_latitude"], record["aim_longitude"] = record["latitude"], record["longitude"]
    record["altitude"] = scenario.site_areoid_m + terrain.site_elevation_m
