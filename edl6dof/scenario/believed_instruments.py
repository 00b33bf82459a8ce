"""What the flight computer believes of the instruments that fly: their nominal places and axes, and the
standard deviations that the errors of each case are drawn from.
"""

from __future__ import annotations

from math import radians, sqrt

import numpy as np

from edl6dof.config.dtype import in_si
from edl6dof.scenario.events import event_number
from edl6dof.scenario.schema import Scenario
from edl6dof.spatial.arrays import product
from edl6dof.spatial.elementary import cos, hypot, sin, tan
from edl6dof.spatial.frames import ned_to_fixed

#: Share of a branch's full flow by which the flow computed from commands differs from the true one at best.
LEAST_FLOW_SHARE = 1e-3


def believe_instruments(record: np.void, scenario: Scenario) -> None:
    """Fill an ``INSTRUMENTS`` record of zeros; what does not fly stays zero."""
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
        record["star_lowest"], record["star_rate"] = stars["lowest"], stars["rate"]
        record["star_until"] = event_number(scenario.mission, sensors.star_tracker.until)
    if "ground_tracking" in sensors.flown:
        ground, axes = in_si(sensors.ground_tracking), _orbit_axes(scenario)
        record["tracking_position_sigma"] = np.sqrt(product(np.square(ground["position"]), np.square(axes)))
        record["tracking_velocity_sigma"] = np.sqrt(product(np.square(ground["velocity"]), np.square(axes)))
    if "radar" in sensors.flown:
        _believe_radar(record, in_si(sensors.radar))
    if "landing_camera" in sensors.flown:
        _believe_eye(record["eyes"]["camera"], in_si(sensors.landing_camera))
    if "lidar" in sensors.flown:
        lidar = in_si(sensors.lidar)
        _believe_eye(record["eyes"]["lidar"], lidar)
        record["eyes"]["lidar"]["sigma"] = hypot(lidar["range_noise"], lidar["quantum"] / sqrt(12.0))
    if "stereo" in sensors.flown:
        _believe_stereo(record["eyes"]["stereo"], in_si(sensors.stereo))
    _believe_flow_meters(record, in_si(sensors.flow_meters) if "flow_meters" in sensors.flown else None)


def _believe_radar(record: np.void, radar: np.void) -> None:
    """Antenna, beams, and the errors of one beam: noise, and what the copy that flies has for good.

    A beam that looks elsewhere than it should has another scale: of its own at usual angles to the vertical.
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
    """Place and field of view."""
    record["place"] = given["position"]
    record["tangent"] = tan(0.5 * given["field_of_view"])


def _believe_stereo(record: np.void, stereo: np.void) -> None:
    """Place, field of view, and noise as it grows with the square of the range."""
    _believe_eye(record, stereo)
    focal_px = 0.5 * stereo["pixels"] / record["tangent"]
    record["sigma_square"] = stereo["disparity_noise_px"] / (focal_px * stereo["baseline"])


def _believe_flow_meters(record: np.void, meters: np.void | None) -> None:
    """Ideal meters, too, are not trusted beyond ``LEAST_FLOW_SHARE``."""
    for field, name in (("scale_sigma", "scale"), ("bias_share", "bias"), ("noise_share", "noise")):
        given = 0.0 if meters is None else float(meters[name])
        record[f"flow_{field}"] = max(given, LEAST_FLOW_SHARE)


def _believe_axes(record: np.void, kind: str, given: np.void) -> None:
    """Gyros or accelerometers: the fields that begin with ``kind``."""
    count = given["n_axes"]
    record[f"n_{kind}s"] = count
    record[f"{kind}_axis"][:count] = given["axes"]["axis"][:count]
    record[f"{kind}_scale"] = hypot(given["scale"], given["misalignment"])
    record[f"{kind}_step"] = given["quantum"]
    for name in ("range", "noise", "bias", "bias_walk"):
        record[f"{kind}_{name}"] = given[name]


def _orbit_axes(scenario: Scenario) -> np.ndarray:
    """Up, along the ground track and across it, at the initial state, as rows in I (as F at t = 0)."""
    initial = scenario.initial
    lat, lon = radians(initial.latitude_deg), radians(initial.longitude_deg)
    place = (sin(lat), cos(lat), sin(lon), cos(lon))
    north, east, _ = initial.velocity_ned
    ahead = np.array([north, east]) / (hypot(north, east) or 1.0)
    in_ned = ((0.0, 0.0, -1.0), (*ahead, 0.0), (-ahead[1], ahead[0], 0.0))
    return np.array([ned_to_fixed(*place, row) for row in in_ned])
