"""The telemetry channels, declared once: name with unit suffix, and meaning.

From this table follow the log record that compiled code fills (SI units, no suffix), the Parquet columns and
their metadata.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from edl6dof.config.units import split_unit
from edl6dof.interface.capacities import MAX_BEAMS, MAX_BRANCHES, MAX_THRUSTERS
from edl6dof.records import record


class Channel(NamedTuple):
    """One telemetry column: name with unit suffix, meaning, and True if campaigns record it (``brief``)."""

    name: str
    meaning: str
    brief: bool = False

    @property
    def group(self) -> str:
        """Part before the dot: truth, sensed, nav, guide, estimate, diagnosis, control."""
        return self.name.partition(".")[0]

    @property
    def field(self) -> str:
        """Name in the log record: after the dot, without the unit suffix."""
        return split_unit(self.name.partition(".")[2])[0]

    @property
    def unit(self) -> str:
        """Printed unit."""
        return split_unit(self.name.partition(".")[2])[1].label

    @property
    def from_si(self) -> float:
        """Factor from the logged SI value to the column's unit."""
        return 1.0 / split_unit(self.name.partition(".")[2])[1].to_si


def _vector(stem: str, suffix: str, axes: str, meaning: str, brief: bool = False) -> list[Channel]:
    return [
        Channel(f"{stem}_{axis}{'_' + suffix if suffix else ''}", f"{meaning}, {axis}", brief)
        for axis in axes.split()
    ]


_SUM = "the sum of 2 to the power of the index of each"
# fmt: off
CHANNELS: tuple[Channel, ...] = (
    Channel("truth.altitude_m", "height above the reference ellipsoid", brief=True),
    Channel("truth.height_above_areoid_m", "height above the areoid, on which the air depends", brief=True),
    Channel("truth.elevation_m", "height above the areoid of the ground below the vehicle"),
    Channel("truth.height_m", "height above the ground", brief=True),
    Channel("truth.latitude_deg", "geodetic latitude", brief=True),
    Channel("truth.longitude_deg", "east longitude", brief=True),
    *_vector("truth.site", "m", "east north up", "position relative to the landing site", brief=True),
    *_vector("truth.r_I", "m", "x y z", "position, inertial"),
    *_vector("truth.v_I", "m_s", "x y z", "velocity, inertial"),
    *_vector("truth.v", "m_s", "north east down", "planet-relative velocity"),
    Channel("truth.speed_m_s", "planet-relative speed", brief=True),
    Channel("truth.flight_path_angle_deg", "flight-path angle of the planet-relative velocity"),
    Channel("truth.azimuth_deg", "azimuth of the planet-relative velocity, from north through east"),
    Channel("truth.airspeed_m_s", "speed relative to the air"),
    Channel("truth.alpha_deg", "angle of attack in the air", brief=True),
    Channel("truth.beta_deg", "sideslip angle in the air", brief=True),
    Channel("truth.total_alpha_deg", "angle between the body axis and the air-relative velocity", brief=True),
    Channel("truth.bank_deg", "bank angle about the planet-relative velocity"),
    Channel("truth.mach", "Mach number", brief=True),
    Channel("truth.dynamic_pressure_pa", "dynamic pressure", brief=True),
    Channel("truth.density_kg_m3", "air density"),
    Channel("truth.temperature_k", "air temperature"),
    *_vector("truth.wind", "m_s", "north east down", "wind velocity"),
    Channel("truth.load_g0", "sensed acceleration, Earth g"),
    Channel("truth.heat_flux_w_cm2", "stagnation-point heat flux, convective and radiative"),
    Channel("truth.radiative_heat_flux_w_cm2", "stagnation-point radiative heat flux"),
    Channel("truth.heat_load_j_cm2", "integrated heat flux"),
    *_vector("truth.q_I2B", "", "w x y z", "attitude quaternion, scalar first, inertial to body"),
    *_vector("truth.rate", "deg_s", "p q r", "inertial body rate", brief=True),
    Channel("truth.tilt_deg", "angle of the thrust axis (-x of B) from the vertical"),
    Channel("truth.mass_kg", "mass"),
    *_vector("truth.centre", "m", "x y z", "centre of mass in B"),
    Channel("truth.propellant_kg", "propellant left", brief=True),
    *_vector("truth.aero_force", "n", "x y z", "aerodynamic force in B, trim wing included"),
    *_vector("truth.aero_moment", "nm", "x y z", "aerodynamic moment about the centre of mass in B"),
    *_vector("truth.disturbance", "nm", "x y z", "moment of everything but the thrusters, in B", brief=True),
    *_vector("truth.rcs_force", "n", "x y z", "mean thruster force of the last step, in B"),
    Channel("truth.engine_thrust_n", "main engine thrust"),
    Channel("truth.riser_tension_n", "tension in riser and lines"),
    *_vector("truth.canopy", "m", "east north up", "canopy relative to the landing site"),
    *_vector("truth.heat_shield", "m", "east north up",
             "jettisoned heat shield relative to the landing site"),
    *_vector("truth.backshell", "m", "east north up",
             "released backshell relative to the landing site", brief=True),
    Channel("truth.trim_wing", "trim-wing opening, 0 to 1"),
    Channel("truth.footpads", "footpads on the ground"),
    Channel("sensed.gyros_saturated", f"gyros at the end of their range: {_SUM}"),
    Channel("sensed.accelerometers_saturated", f"accelerometers at the end of their range: {_SUM}"),
    Channel("nav.mach", "navigated Mach number (no wind)"),
    Channel("nav.alpha_deg", "navigated angle of attack (no wind)"),
    Channel("nav.beta_deg", "navigated sideslip angle (no wind)"),
    Channel("nav.total_alpha_deg", "navigated angle between the body axis and the flow (estimated wind)"),
    Channel("nav.wind_north_m_s", "estimated wind, north"),
    Channel("nav.wind_east_m_s", "estimated wind, east"),
    Channel("nav.bank_deg", "navigated bank angle"),
    Channel("nav.drag_m_s2", "measured drag acceleration"),
    Channel("nav.mass_kg", "believed mass"),
    *_vector("nav.error", "m", "north east down", "estimated less true position", brief=True),
    *_vector("nav.error_v", "m_s", "north east down",
             "estimated less true velocity over the ground", brief=True),
    *_vector("nav.error_attitude", "deg", "north east down",
             "rotation vector from true to estimated attitude", brief=True),
    Channel("nav.error_height_m", "estimated less true height above the ground", brief=True),
    *_vector("nav.sigma", "m", "north east down", "estimated standard deviation of position"),
    *_vector("nav.sigma_v", "m_s", "north east down", "estimated standard deviation of velocity"),
    *_vector("nav.sigma_attitude", "deg", "north east down", "estimated standard deviation of attitude"),
    Channel("nav.sigma_height_m", "estimated standard deviation of the height above the ground"),
    Channel("nav.range_innovation", "largest range innovation of a beam over its standard deviation"),
    Channel("nav.speed_innovation", "largest speed innovation of a beam over its standard deviation"),
    Channel("nav.beams_used", f"radar beams used last: {_SUM}"),
    Channel("nav.gyros_in_use", f"gyros not excluded: {_SUM}"),
    Channel("nav.accelerometers_in_use", f"accelerometers not excluded: {_SUM}"),
    Channel("nav.beams_in_use", f"radar beams not excluded: {_SUM}"),
    Channel("guide.phase", "mission phase, index into the phase table", brief=True),
    Channel("guide.bank_deg", "commanded bank angle", brief=True),
    Channel("guide.reference_drag_m_s2", "reference drag acceleration"),
    Channel("guide.range_to_go_km", "great-circle range to the entry aim point"),
    Channel("guide.crossrange_km", "crossrange to the entry aim point, positive when heading right of it"),
    Channel("guide.time_to_go_s", "time to go of powered guidance"),
    Channel("guide.surface_m_s3", "sliding surface of the entry law"),
    Channel("guide.virtual_m_s3", "virtual state with which the entry law compensates saturation"),
    Channel("guide.drag_estimate_m_s2", "drag acceleration that the entry law uses"),
    Channel("guide.drag_rate_m_s3", "drag rate that the entry law uses"),
    Channel("guide.drag_disturbance_m_s4", "estimated disturbance of the second derivative of drag"),
    Channel("guide.path_disturbance_deg_s", "estimated disturbance of the flight-path rate"),
    Channel("guide.thrust_n", "commanded engine thrust"),
    *_vector("guide.thrust_direction", "", "north east down", "commanded thrust direction"),
    Channel(
        "guide.hazard_stage",
        "hazard detection: 0 not begun, 1 image asked for, 2 coarse point chosen, 3 scanning, 4 spot chosen"),
    Channel("guide.coarse_east_m", "coarse landing point as navigated, relative to the landing site, east"),
    Channel("guide.coarse_north_m", "coarse landing point as navigated, relative to the landing site, north"),
    Channel("guide.spot_east_m", "landing spot as navigated, relative to the landing site, east"),
    Channel("guide.spot_north_m", "landing spot as navigated, relative to the landing site, north"),
    *_vector("control.error", "deg", "roll pitch yaw", "attitude error used by the controller", brief=True),
    *_vector("control.torque", "nm", "x y z", "demanded torque in B"),
    *_vector("estimate.torque", "nm", "x y z", "estimated disturbance torque in B", brief=True),
    *_vector("estimate.force", "n", "x y z",
             "estimated disturbance force in B; the axial one contains engine and drag"),
    Channel("diagnosis.confidence", "confidence of the best hypothesis about a thruster fault"),
    Channel("diagnosis.leaking", "index of the propellant branch tested for a leak; -1 for none"),
    Channel("diagnosis.common_loss", "share of its flow that every propellant branch is thought to lose"),
    Channel("diagnosis.isolated", "thrusters isolated as failed"),
    Channel("diagnosis.in_use", f"thrusters that the flight computer may use: {_SUM}"),
    *_vector("control.unallocated", "nm", "x y z", "demanded torque that stays unallocated"),
)
# fmt: on

#: Channels that a flight of a campaign records.
BRIEF_CHANNELS: tuple[Channel, ...] = tuple(channel for channel in CHANNELS if channel.brief)


def _layout(channels: Sequence[Channel]) -> list[tuple]:
    groups = dict.fromkeys(channel.group for channel in channels)
    fields = [
        (group, np.dtype([(channel.field, "f8") for channel in channels if channel.group == group]))
        for group in groups
    ]
    return [("t", "f8"), *fields]


#: A row of telemetry.
TICK = record(
    *_layout(CHANNELS),
    ("duty", "f8", (MAX_THRUSTERS,)),
    ("fault", "i1", (MAX_THRUSTERS,)),
    ("valve", "i1", (MAX_THRUSTERS,)),
    ("range", "f8", (MAX_BEAMS,)),
    ("used", "f8", (MAX_BRANCHES,)),
    ("metered", "f8", (MAX_BRANCHES,)),
    ("expected", "f8", (MAX_BRANCHES,)),
)

#: A row of the brief telemetry: a quarter of the memory, and half of the time to write it.
BRIEF = np.dtype(_layout(BRIEF_CHANNELS), align=True)
