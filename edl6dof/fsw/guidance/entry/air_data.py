"""Air data of entry guidance: the wind expected before the flight, and the ratios of measured to believed
drag and lift, for every law that predicts.

The expected wind is the climatology of the table that the believed air is read from; it is not corrected in
flight. The believed drag is computed in the expected wind, as in a prediction. Errors of density, mass, wind
and aerodynamics act on accelerometer and trajectory alike; the ratio of measured to believed drag brings
their sum into a prediction.

Ratio of drag: a Kalman filter of a level and a trend with height. Density waves change the level at random,
as a Gauss-Markov process of their size and length does over small height differences. Air that is warmer or
colder than believed causes the trend: over a height z the density is off by z/H times the relative error of
its scale height H. Ratio of lift: a fading memory with a long time constant, since errors of the vehicle are
constant, while unexpected wind changes with height. Source: the density and lift-to-drag estimates of fully
numerical entry guidance (Lu 2014, section V.C; Brunner & Lu 2008, eqs. 33-34), there first-order fading
memories; local linear trend: Harvey 1989, "Forecasting, Structural Time Series Models and the Kalman Filter",
section 2.3.
"""

from __future__ import annotations

from edl6dof.config.base import Params, param
from edl6dof.fsw.guidance.entry.airframe import believed_aero
from edl6dof.fsw.navigation.derived import expected_wind, model_atmosphere
from edl6dof.kernels import kernel
from edl6dof.records import FLAG, record
from edl6dof.spatial.elementary import exp
from edl6dof.spatial.vector import clamp

#: Usual winds, m/s.
_JETS = (-150, 150, "jet streams")


class ExpectedWindParams(Params):
    """Mean wind against height: a factor on the winds of a table, and a wind that is the same everywhere."""

    table_factor: float = param(
        1.0, "factor on the mean wind of atmosphere.table, where it has one", record=False, ge=-10.0, le=10.0
    )
    north_m_s: float = param(
        0.0, "wind towards north, added at all heights", record=False, ge=-200.0, le=200.0, usual=_JETS
    )
    east_m_s: float = param(
        0.0, "wind towards east, added at all heights", record=False, ge=-200.0, le=200.0, usual=_JETS
    )


class AirDataParams(Params):
    """Filtered ratio of measured to believed drag, and of measured to believed lift-to-drag ratio."""

    drag_error: float = param(
        0.1, "standard deviation of the ratio of drag before entry", status="estimate", gt=0.0, lt=1.0
    )
    scale_height_error: float = param(
        0.025, "relative standard deviation of the scale height: 5 K", status="estimate", ge=0.0, lt=1.0
    )
    wave_sigma: float = param(
        0.03, "relative standard deviation of waves of density", status="estimate", gt=0.0, lt=1.0
    )
    wave_length_m: float = param(
        5000.0, "height over which their correlation falls to 1/e", status="estimate", gt=0.0, le=1e6
    )
    reading_error: float = param(
        0.02, "standard deviation of one reading of drag ratio, by gusts", status="estimate", gt=0.0, lt=1.0
    )
    lift_memory_s: float = param(25.0, "time constant of the lift ratio", status="design", gt=0.0, le=1000.0)
    least_drag_m_s2: float = param(0.5, "drag below which the ratios are not updated", gt=0.0)
    limit: float = param(0.5, "largest deviation of a ratio from one", gt=0.0, lt=1.0)


AIR_DATA = record(
    ("started", FLAG),
    ("t", "f8"),
    ("altitude", "f8"),  # m: of the last reading
    ("drag", "f8"),
    ("trend", "f8"),  # of the ratio of drag with height, 1/m
    ("drag_variance", "f8"),
    ("covariance", "f8"),
    ("trend_variance", "f8"),
    ("lift", "f8"),
)


@kernel
def start(p, altitude, scale_height, t, memory):
    """Start with ratios of one and no trend; ``altitude`` and ``scale_height``: m."""
    memory.started, memory.t, memory.altitude = 1, t, altitude
    memory.drag, memory.trend, memory.lift = 1.0, 0.0, 1.0
    memory.drag_variance, memory.covariance = p.drag_error * p.drag_error, 0.0
    sigma = p.scale_height_error / scale_height
    memory.trend_variance = sigma * sigma


@kernel
def learn_drag(p, altitude, ratio, memory):
    """Propagate level and trend of the drag ratio to the ``altitude`` (m) of a reading, and correct them by
    its ``ratio``.
    """
    climb = altitude - memory.altitude
    memory.altitude = altitude
    memory.drag += climb * memory.trend
    waves = 2.0 * p.wave_sigma * p.wave_sigma / p.wave_length
    memory.drag_variance += climb * (2.0 * memory.covariance + climb * memory.trend_variance)
    memory.drag_variance += waves * abs(climb)
    memory.covariance += climb * memory.trend_variance

    total = memory.drag_variance + p.reading_error * p.reading_error
    gain, trend_gain = memory.drag_variance / total, memory.covariance / total
    error = ratio - memory.drag
    memory.drag += gain * error
    memory.trend += trend_gain * error
    memory.trend_variance -= trend_gain * memory.covariance
    memory.covariance *= 1.0 - gain
    memory.drag_variance *= 1.0 - gain


@kernel
def drag_ratio_at(p, ratio, trend, climb):
    """Expected ratio of drag ``climb`` (m) above the height where it is ``ratio``, within its limits."""
    return clamp(ratio + trend * climb, 1.0 - p.limit, 1.0 + p.limit)


@kernel
def air_velocity(onboard, nav):
    """Velocity (m/s, N: north, east, down) through the air of the expected wind."""
    to_north, to_east = expected_wind(onboard.atmosphere, nav.altitude)
    return nav.v_N[0] - to_north, nav.v_N[1] - to_east, nav.v_N[2]


@kernel
def measure_air(onboard, nav, memory):
    """Update ``memory`` (``AIR_DATA``) by the accelerometer reading of this cycle."""
    p = onboard.guidance.entry.air_data
    density, _, scale_height = model_atmosphere(onboard.atmosphere, nav.altitude)
    if memory.started == 0:
        start(p, nav.altitude, scale_height, nav.t, memory)
    area, lift_to_drag = believed_aero(onboard.vehicle, nav.mach, nav.speed)
    north, east, down = air_velocity(onboard, nav)
    believed = 0.5 * density * (north * north + east * east + down * down) * area / onboard.vehicle.entry_mass
    share = 1.0 - exp(-max(nav.t - memory.t, 0.0) / p.lift_memory)
    memory.t = nav.t
    if nav.drag < p.least_drag or believed < p.least_drag:
        memory.altitude = nav.altitude
        return
    learn_drag(p, nav.altitude, clamp(nav.drag / believed, 1.0 - p.limit, 1.0 + p.limit), memory)
    if lift_to_drag > 0.0:
        ratio = nav.lift / nav.drag / lift_to_drag
        memory.lift += share * (clamp(ratio, 1.0 - p.limit, 1.0 + p.limit) - memory.lift)
