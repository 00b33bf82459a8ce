"""Belief of the flight computer: filled from the nominal scenario, without dispersions and faults.

It contains the nominal places and axes of the instruments, and the standard deviations of their errors.
"""

from __future__ import annotations

from math import sqrt

import numpy as np

from edl6dof.config.dtype import fill, in_si
from edl6dof.environment.atmosphere import ATMOSPHERE, air, fill_atmosphere
from edl6dof.environment.gas import GAS, fill_gas
from edl6dof.fsw.check_out import fill_check_out
from edl6dof.fsw.guidance.entry.registry import ENTRY_LAWS
from edl6dof.fsw.navigation.filters.registry import NAVIGATION_FILTERS
from edl6dof.fsw.onboard import NODES, ONBOARD
from edl6dof.scenario.entry_target import plan, wind_at, wind_of
from edl6dof.scenario.mission_events import event_number, fill_mission
from edl6dof.scenario.onboard_vehicle import believe_drifter, believe_vehicle
from edl6dof.scenario.schema import Scenario, fill_site
from edl6dof.sensors.registry import SENSOR_FAMILY
from edl6dof.spatial.arrays import product
from edl6dof.spatial.elementary import cos, hypot, log, sin, tan
from edl6dof.spatial.frames import ned_to_fixed

#: Sections of the flight software that are copied to the record.
FILLED = (
    *("rates", "navigation", "hazard", "guidance", "control"),
    *("estimation", "diagnosis", "allocation", "modulation"),
)
#: Least extent (m) of the believed atmosphere below the site and above the initial state.
BEYOND = 1000.0
#: Least error of the flow computed from commands, as a share of the full flow of a branch.
LEAST_FLOW_SHARE = 1e-3


def believe(scenario: Scenario, tables: np.ndarray) -> np.ndarray:
    """Build the belief of the flight computer, shape (1,): nominal models and the mean wind expected."""
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
    believe_vehicle(record["vehicle"], scenario, tables)
    software = scenario.flight_software
    for name in FILLED:
        fill(record[name], getattr(software, name))
    record["guidance"]["entry"]["heading"]["speed"] = software.guidance.entry.heading_below_m_s
    record["navigation"]["filter"] = NAVIGATION_FILTERS.names.index(scenario.navigation_filter)
    fill_check_out(record["check_out"], software.check_out, scenario.thruster_names)
    sensors = scenario.sensors_in_flight
    unit = sensors.inertial_unit if "inertial_unit" in sensors.flown else sensors.imu
    record["imu_delay"] = unit.delay_cycles / software.rates.base_hz
    _believe_instruments(record["instruments"], scenario)
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
    """Tabulate air and wind against altitude, with the height of the areoid at the landing site."""
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
    """Lowest and highest height (m above the areoid) of the believed air, site and start included."""
    air, start = scenario.atmosphere, scenario.initial_altitude_m - scenario.site_areoid_m
    bottom = min(air.bottom_m, scenario.terrain.site_elevation_m - BEYOND, start - BEYOND)
    return bottom, max(air.top_m, start + BEYOND)


def _set_site(record: np.void, scenario: Scenario) -> None:
    fill_site(record["frame"], scenario)
    record["latitude"], record["longitude"], record["altitude"] = scenario.site
    record["aim_latitude"], record["aim_longitude"] = record["latitude"], record["longitude"]


def _believe_instruments(record: np.void, scenario: Scenario) -> None:
    """Fill an ``INSTRUMENTS`` record of zeros; instruments that do not fly stay zero."""
    sensors = scenario.sensors_in_flight
    if "inertial_unit" in sensors.flown:
        unit = in_si(sensors.inertial_unit)
        record["unit_position"] = unit["position"]
        record["unit_delay"] = unit["delay_cycles"] / scenario.flight_software.rates.base_hz
        _believe_axes(record, "gyro", unit["gyros"])
        _believe_axes(record, "accelerometer", unit["accelerometers"])
    if "star_tracker" in sensors.flown:
        stars = in_si(sensors.star_tracker)
        square = (2.0 * np.square(stars["noise"]) + np.square(stars["boresight_noise"])) / 3.0
        record["star_sigma"], record["star_bias"] = np.sqrt(square), stars["misalignment"]
        record["n_trackers"] = stars["n_heads"]
        record["star_lowest"], record["star_rate"] = stars["lowest"], stars["rate"]
        record["star_until"] = event_number(scenario.mission, sensors.star_tracker.until)
    if "ground_tracking" in sensors.flown:
        ground, axes = in_si(sensors.ground_tracking), _orbit_axes(scenario)
        for name in ("position", "velocity"):
            record[f"tracking_{name}"] = product(axes.T * np.square(ground[name]), axes)
    if "pressure_ports" in sensors.flown:
        ports = in_si(sensors.pressure_ports)
        record["n_ports"] = ports["n_ports"]
        record["port_axis"][: ports["n_ports"]] = ports["ports"]["axis"][: ports["n_ports"]]
        record["port_bias"], record["port_scale"] = ports["bias"], ports["scale"]
    if "radar" in sensors.flown:
        _believe_radar(record, in_si(sensors.radar))
    if "landing_camera" in sensors.flown:
        _believe_eye(record["imagers"]["camera"], in_si(sensors.landing_camera))
    if "lidar" in sensors.flown:
        lidar = in_si(sensors.lidar)
        _believe_eye(record["imagers"]["lidar"], lidar)
        record["imagers"]["lidar"]["sigma"] = hypot(lidar["range_noise"], lidar["quantum"] / sqrt(12.0))
    if "stereo" in sensors.flown:
        _believe_stereo(record["imagers"]["stereo"], in_si(sensors.stereo))
    if "landmark_camera" in sensors.flown:
        _believe_landmarks(record["landmarks"], in_si(sensors.landmark_camera))
    _believe_flow_meters(record, in_si(sensors.flow_meters) if "flow_meters" in sensors.flown else None)


def _believe_radar(record: np.void, radar: np.void) -> None:
    """Fill antenna, beams, and the errors of one beam: noise, and errors that are constant in a flight.

    A misaligned beam has another scale, half its angle at usual angles to the vertical.
    """
    beams = radar["n_beams"]
    record["antenna_position"], record["n_beams"] = radar["position"], beams
    record["radar_ceiling"] = radar["highest"]
    record["beam_axis"][:beams] = radar["beams"]["axis"][:beams]
    for kind in ("range", "speed"):
        record[f"{kind}_sigma"] = radar[f"{kind}_noise"]
        record[f"{kind}_sigma_relative"] = radar[f"{kind}_noise_relative"]
        record[f"{kind}_scale"] = hypot(radar[f"{kind}_scale"], 0.5 * radar["misalignment"])
    record["range_bias"] = radar["reflectivity"]


def _believe_eye(record: np.void, given: np.void) -> None:
    """Fill the place and the field of view of an optical instrument."""
    record["place"] = given["position"]
    record["tangent"] = tan(0.5 * given["field_of_view"])


def _believe_stereo(record: np.void, stereo: np.void) -> None:
    """Fill place, field of view, and noise, which increases with the square of the range."""
    _believe_eye(record, stereo)
    focal_px = 0.5 * stereo["pixels"] / record["tangent"]
    record["sigma_square"] = stereo["disparity_noise_px"] / (focal_px * stereo["baseline"])


def _believe_landmarks(record: np.void, camera: np.void) -> None:
    """Fill place, focal length, and the errors of landmark camera and map."""
    record["place"], record["noise"] = camera["position"], camera["noise_px"]
    record["focal"] = 0.5 * camera["pixels"] / tan(0.5 * camera["field_of_view"])
    record["misalignment"], record["map_noise"] = camera["misalignment"], camera["map_noise"]
    record["map_offset"] = np.sqrt(np.mean(np.square(camera["map_offset"])))


def _believe_flow_meters(record: np.void, meters: np.void | None) -> None:
    """Fill the errors of the flow meters; for ideal meters at least ``LEAST_FLOW_SHARE``."""
    for field, name in (("scale_sigma", "scale"), ("bias_share", "bias"), ("noise_share", "noise")):
        given = 0.0 if meters is None else float(meters[name])
        record[f"flow_{field}"] = max(given, LEAST_FLOW_SHARE)


def _believe_axes(record: np.void, kind: str, given: np.void) -> None:
    """Fill the fields of the gyros or accelerometers, which begin with ``kind``."""
    count = given["n_axes"]
    record[f"n_{kind}s"] = count
    record[f"{kind}_axis"][:count] = given["axes"]["axis"][:count]
    record[f"{kind}_scale"] = hypot(given["scale"], given["misalignment"])
    record[f"{kind}_step"] = given["quantum"]
    for name in ("range", "noise", "bias", "bias_walk"):
        record[f"{kind}_{name}"] = given[name]


def _orbit_axes(scenario: Scenario) -> np.ndarray:
    """Up, along the ground track and across it, at the initial state, as rows in I (as F at t = 0)."""
    lat, lon = scenario.initial.place
    place = (sin(lat), cos(lat), sin(lon), cos(lon))
    north, east, _ = scenario.initial.velocity_ned
    ahead = np.array([north, east]) / (hypot(north, east) or 1.0)
    in_ned = ((0.0, 0.0, -1.0), (*ahead, 0.0), (-ahead[1], ahead[0], 0.0))
    return np.array([ned_to_fixed(*place, row) for row in in_ned])
