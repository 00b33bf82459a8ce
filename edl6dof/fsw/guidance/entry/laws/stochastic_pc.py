"""Predictor-corrector that tells an unexpected wind from an error of density: the law of
:mod:`~edl6dof.fsw.guidance.entry.energy_plan`, whose predictions fly in the estimated air and wind.

Filter. A Kalman filter estimates the level of the drag ratio, its trend with height, the difference of the
wind from the expected one, and the sideslip at trim. Drag grows with density and with the square of the speed
through the air, so the effect 2 w/V of a wind w from behind grows as the vehicle slows down, whereas the
error of density depends on height alone. Across the flight the vehicle turns its nose into the wind: sideslip
of the planet-relative velocity shows the wind along the body axis y, plus an error of trim, which changes its
direction at each reversal while the wind does not. Density waves change the level at random with height, as
in :mod:`~edl6dof.fsw.guidance.entry.air_data`.

Floor of altitude. A lower last bank angle of the plan ends the flight higher, but leaves less lift in reserve
against a head wind. It is lowered below the floor only while the aim point stays in reach at a sigma point of
the filter in a head wind.

Sources: Harvey 1989, "Forecasting, Structural Time Series Models and the Kalman Filter", section 2.3 (level
and trend); Karlgaard et al. 2014, J. Spacecraft and Rockets 51(4) (wind from the attitude in the air); Julier
and Uhlmann 2004, Proc. IEEE 92(3) (sigma points); this combination: derived.
"""

from __future__ import annotations

from math import sqrt

from edl6dof.config.base import param
from edl6dof.fsw.guidance.entry.air_data import air_velocity
from edl6dof.fsw.guidance.entry.airframe import believed_aero
from edl6dof.fsw.guidance.entry.energy_plan import ENERGY_PLAN, EnergyPlanParams, bank_plan, fly_plan
from edl6dof.fsw.guidance.entry.predictor import linear, predict
from edl6dof.fsw.navigation.derived import expected_wind, model_atmosphere
from edl6dof.kernels import kernel
from edl6dof.records import FLAG, record
from edl6dof.registry import Member
from edl6dof.spatial.elementary import sincos
from edl6dof.spatial.quaternion import to_frame
from edl6dof.spatial.vector import clamp, take3, take4


class StochasticPcParams(EnergyPlanParams):
    """Predictor-corrector with estimated density and wind."""

    wind_sigma_m_s: float = param(
        20.0, "standard deviation of the wind from the expected one", status="design", gt=0.0, le=200.0
    )
    wind_change_m_s: float = param(
        0.7, "random walk of this difference in one second", status="estimate", ge=0.0, le=100.0
    )
    sideslip_deg: float = param(
        0.7, "standard deviation of the sideslip at trim", status="estimate", gt=0.0, le=20.0
    )
    sideslip_change_deg: float = param(
        0.05, "random walk of this sideslip in one second", status="estimate", ge=0.0, le=20.0
    )
    gust_m_s: float = param(
        8.0, "standard deviation of gusts in the sideslip", status="estimate", gt=0.0, le=200.0
    )
    gust_time_s: float = param(
        10.0, "time after which gusts are independent", status="estimate", gt=0.0, le=1000.0
    )
    floor_m: float = param(
        -5000.0,
        "least altitude of the parachute: the last bank angle of the plan is lowered where it ends below",
        status="design",
        ge=-20e3,
        le=100e3,
    )
    floor_bank_deg: float = param(
        30.0, "smallest last bank angle to which it is lowered", status="design", ge=0.0, le=180.0
    )
    sigmas: float = param(
        3.0, "standard deviations of a head wind in which the aim point stays in reach", ge=0.0, le=10.0
    )
    heading_speed_m_s: float | None = param(
        None, "this law's own value of heading.speed_m_s", status="design", record=False, ge=0.0, le=10e3
    )


#: Lowering of the last bank angle (rad) in one call, per altitude (m) below the floor.
FLOOR_GAIN = 5e-5

#: States of the filter: level, trend (1/m), wind north and east (m/s), sideslip at trim (rad).
STATES = 5
LEVEL, TREND, NORTH, EAST, SIDESLIP = range(STATES)

AIR_FILTER = record(
    ("started", FLAG),
    ("t", "f8"),  # s: flight time of the last reading
    ("altitude", "f8"),  # m: of the last reading
    ("state", "f8", (STATES,)),
    ("covariance", "f8", (STATES, STATES)),
    ("gain", "f8", (STATES,)),  # scratch
)
MEMORY = record(("air", AIR_FILTER), ("plan", ENERGY_PLAN))


@kernel
def begin(params, onboard, nav, memory):
    """Start from the expected air and wind."""
    p, P = onboard.guidance.entry.air_data, memory.covariance
    _, _, scale_height = model_atmosphere(onboard.atmosphere, nav.altitude)
    memory.started, memory.t, memory.altitude = 1, nav.t, nav.altitude
    memory.state[LEVEL] = 1.0
    P[LEVEL, LEVEL] = p.drag_error * p.drag_error
    P[TREND, TREND] = (p.scale_height_error / scale_height) * (p.scale_height_error / scale_height)
    P[NORTH, NORTH] = P[EAST, EAST] = params.wind_sigma * params.wind_sigma
    P[SIDESLIP, SIDESLIP] = params.sideslip * params.sideslip


@kernel
def propagate(params, p, climb, dt, memory):
    """Propagate over ``climb`` (m) and ``dt`` (s); ``p``: ``AirDataParams`` record."""
    P = memory.covariance
    memory.state[LEVEL] += climb * memory.state[TREND]
    for i in range(STATES):
        P[LEVEL, i] += climb * P[TREND, i]
    for i in range(STATES):
        P[i, LEVEL] += climb * P[i, TREND]
    P[LEVEL, LEVEL] += 2.0 * p.wave_sigma * p.wave_sigma / p.wave_length * abs(climb)
    for i in range(NORTH, EAST + 1):
        P[i, i] += params.wind_change * params.wind_change * dt
    P[SIDESLIP, SIDESLIP] += params.sideslip_change * params.sideslip_change * dt


@kernel
def update(h, noise, rest, memory):
    """Kalman update by a reading that exceeds its expectation by ``rest``; ``h``: its slopes, ``noise``: its
    variance.
    """
    P, gain = memory.covariance, memory.gain
    total = noise
    for i in range(STATES):
        gain[i] = 0.0
        for k in range(STATES):
            gain[i] += P[i, k] * h[k]
        total += h[i] * gain[i]
    for i in range(STATES):
        memory.state[i] += gain[i] / total * rest
        for k in range(STATES):
            P[i, k] -= gain[i] * gain[k] / total


@kernel
def learn_drag(onboard, nav, memory):
    """Correct the state by measured over believed drag."""
    p, x = onboard.guidance.entry.air_data, memory.state
    density, _, _ = model_atmosphere(onboard.atmosphere, nav.altitude)
    area, _ = believed_aero(onboard.vehicle, nav.mach, nav.speed)
    north, east, down = air_velocity(onboard, nav)
    square = north * north + east * east + down * down
    believed = 0.5 * density * square * area / onboard.vehicle.entry_mass
    if nav.drag < p.least_drag or believed < p.least_drag:
        return
    through = north - x[NORTH], east - x[EAST]
    share = (through[0] * through[0] + through[1] * through[1] + down * down) / square
    slope = -2.0 * x[LEVEL] / square
    ratio = clamp(nav.drag / believed, 1.0 - p.limit, 1.0 + p.limit)
    h = share, 0.0, slope * through[0], slope * through[1], 0.0
    update(h, p.reading_error * p.reading_error, ratio - share * x[LEVEL], memory)


@kernel
def learn_sideslip(params, onboard, nav, dt, memory):
    """Correct the state by the planet-relative velocity along the body axis y."""
    p, x = onboard.guidance.entry.air_data, memory.state
    if nav.drag < p.least_drag or dt <= 0.0:
        return
    q = take4(nav.q_I2B)
    along_north, along_east = to_frame(q, take3(nav.north_I, 0))[1], to_frame(q, take3(nav.east_I, 0))[1]
    north, east = expected_wind(onboard.atmosphere, nav.altitude)
    rest = to_frame(q, take3(nav.v_rel_I, 0))[1] - nav.speed * x[SIDESLIP]
    rest -= along_north * (north + x[NORTH]) + along_east * (east + x[EAST])
    noise = params.gust * params.gust * params.gust_time / dt
    update((0.0, 0.0, along_north, along_east, nav.speed), noise, rest, memory)


@kernel
def learn(params, onboard, nav, memory):
    """Update the estimate of air and wind by the readings of this call; ``memory``: ``AIR_FILTER``."""
    if memory.started == 0:
        begin(params, onboard, nav, memory)
    dt = nav.t - memory.t
    propagate(params, onboard.guidance.entry.air_data, nav.altitude - memory.altitude, dt, memory)
    memory.t, memory.altitude = nav.t, nav.altitude
    learn_drag(onboard, nav, memory)
    learn_sideslip(params, onboard, nav, dt, memory)


@kernel
def believe(nav, memory, sigmas, out):
    """Write into ``out`` the estimate with the wind along the flight ``sigmas`` standard deviations above its
    mean, and density and trend as they are expected then.
    """
    P, x, spread = memory.covariance, memory.state, memory.gain
    sine, cosine = sincos(nav.azimuth)
    for i in range(STATES):
        spread[i] = cosine * P[i, NORTH] + sine * P[i, EAST]
    scale = sigmas / sqrt(max(cosine * spread[NORTH] + sine * spread[EAST], 1e-9))
    out.drag_ratio, out.drag_trend = x[LEVEL] + scale * spread[LEVEL], x[TREND] + scale * spread[TREND]
    out.wind_shift_N[0] = x[NORTH] + scale * spread[NORTH]
    out.wind_shift_N[1] = x[EAST] + scale * spread[EAST]


@kernel
def keep_floor(params, onboard, nav, memory, out):
    """Lower the last bank angle of the plan where the flight ends below the floor: it then banks more at
    high speed, and ends higher. Raise it where the flight ends above, or where the range at the smallest bank
    angle would be short in a head wind: the plan has less lift in reserve with a lower last bank angle.
    """
    plan, least = memory.plan, onboard.guidance.entry.bank_min
    believe(nav, memory.air, -params.sigmas, out)
    smallest = linear(least, least, nav.speed, plan.side, plan.turn, second_turn=plan.later)
    reserve, _, _, _ = predict(onboard, nav, out, smallest)
    believe(nav, memory.air, 0.0, out)
    ahead = bank_plan(params, onboard, nav, plan, plan.bank, turn=plan.turn)
    _, _, height, _ = predict(onboard, nav, out, ahead)
    short = min(params.floor - height, reserve)
    most = max(params.last_bank - params.floor_bank, 0.0)
    plan.lowered = clamp(plan.lowered + FLOOR_GAIN * short, 0.0, most)


@kernel
def guide(params, plan, onboard, nav, memory, out):
    """Wanted bank angle, its sign included, in the estimated air and wind."""
    learn(params, onboard, nav, memory.air)
    believe(nav, memory.air, 0.0, out)
    if memory.plan.started != 0:
        keep_floor(params, onboard, nav, memory, out)
    return fly_plan(params, onboard, nav, memory.plan, out)


MEMBER = Member(
    "stochastic_pc", StochasticPcParams, {"guide": guide}, "Lu 2014, J. Guidance 37(3); derived", MEMORY
)
