"""Disturbance estimation: the family of estimators, and the control cycle that runs the chosen one.

A member has one kernel, ``estimate(params, measured, dt, memory, out)``: it updates the estimate ``out``
(``DISTURBANCE``), which contains the last estimate, by ``measured`` (``MEASURED``), the control cycle of
``dt`` seconds that the latest inertial measurement covers. ``params`` and ``memory`` belong to the member.

Measured and expected thrust are means over the same cycle. The measurement is some base cycles old, and
thrust follows the valve a few milliseconds late: so the valve intervals commanded in the last control cycles
are stored (``ACTIVITY``), and give the share of the measured cycle in which each thruster should have given
thrust. Neither the rounding by pulse modulation nor the age of the measurement then counts as a disturbance.
"""

from __future__ import annotations

from typing import Any

from edl6dof.config.base import group, param
from edl6dof.fsw.estimation import first_order, unfiltered
from edl6dof.fsw.estimation.engine_thrust import (
    ENGINE_SHORTFALL,
    STUCK_THROTTLE,
    EngineShortfallParams,
    StuckThrottleParams,
)
from edl6dof.interface.capacities import MAX_THRUSTERS
from edl6dof.kernels import kernel
from edl6dof.records import FLAG, record
from edl6dof.registry import Family
from edl6dof.spatial.elementary import exp
from edl6dof.spatial.frames import total_angle_of_attack
from edl6dof.spatial.vector import add, cross, inertia_times, put3, scale, sub, take3

#: Control cycles whose valve intervals are stored: the measured cycle lies within the last two, and thrust
#: lags behind the valve into the third.
KEPT = 3

ACTIVITY = record(
    ("open_time", "f8", (KEPT, MAX_THRUSTERS)),
    ("close_time", "f8", (KEPT, MAX_THRUSTERS)),
    # share of the measured cycle in which each thruster should have given thrust
    ("share", "f8", (MAX_THRUSTERS,)),
    ("wrench", "f8", (6,)),  # N and N m, B: mean force and torque by these shares
)


@kernel
def remember_valves(valves, count, memory):
    """Store the intervals of the ``valves`` (``MODULATION`` record) of a new control cycle."""
    for k in range(KEPT - 1, 0, -1):
        for i in range(count):
            memory.open_time[k, i] = memory.open_time[k - 1, i]
            memory.close_time[k, i] = memory.close_time[k - 1, i]
    for i in range(count):
        memory.open_time[0, i] = valves.open_time[i]
        memory.close_time[0, i] = valves.close_time[i]


@kernel
def expect(effectiveness, count, begin, end, lag, memory):
    """Compute ``memory.share`` and ``memory.wrench`` (``ACTIVITY``) of ``count`` thrusters for the time from
    ``begin`` to ``end`` (s); ``lag``: time by which thrust follows the valve, s.
    """
    for j in range(6):
        memory.wrench[j] = 0.0
    for i in range(count):
        on = 0.0
        for k in range(KEPT):
            if memory.close_time[k, i] > memory.open_time[k, i]:
                on += max(
                    min(memory.close_time[k, i] + lag, end) - max(memory.open_time[k, i] + lag, begin), 0.0
                )
        share = on / (end - begin)
        memory.share[i] = share
        if share > 0.0:
            for j in range(6):
                memory.wrench[j] += share * effectiveness[i, j]


ESTIMATORS = Family("disturbance estimator", (first_order.MEMBER, unfiltered.MEMBER))

MEASURED = record(
    ("inertia", "f8", (3,)),  # kg m2, B: believed principal moments about the axes of B
    ("mass", "f8"),  # kg: believed
    ("rate", "f8", (3,)),  # rad/s, B: at the end of the cycle
    ("last_rate", "f8", (3,)),  # rad/s, B: at the beginning of the cycle
    ("velocity_gain", "f8", (3,)),  # m/s, B: integral of the specific force over the cycle
    ("applied", "f8", (6,)),  # N and N m, B: mean force and torque of the commanded thrusters
    ("unexplained", "f8", (6,)),  # N and N m, B: measured less applied force and torque
)

DISTURBANCE = record(
    ("torque", "f8", (3,)),  # N m, B: on the vehicle, without the commanded thrusters
    ("force", "f8", (3,)),  # N, B: on the vehicle, without the commanded thrusters and gravity
    ("pole", "f8"),  # rad/s: convergence speed of the torque
    ("unexplained", "f8", (6,)),  # N and N m, B: unexplained force and torque of the last cycle, not filtered
)

_Estimators: Any = ESTIMATORS.params_model(
    "Estimators", "estimator", "first_order", "Disturbance estimation."
)


class EstimationParams(_Estimators):
    """Disturbance estimation: the estimator, and the settings that all estimators share."""

    valve_lag_s: float = param(
        0.006,
        "time by which thrust lags the valve, half its rise",
        status="estimate",
        source="rise and decay of 12 ms",
        ge=0.0,
        le=0.02,
    )
    engine_shortfall: EngineShortfallParams = group(EngineShortfallParams, "belief in a loss of thrust")
    held_thrust: StuckThrottleParams = group(StuckThrottleParams, "belief in a stuck throttle")
    force_angle_lag_s: float = param(
        1.0,
        "time constant of the force angle; longer than the time in which diagnosis stops a leak",
        status="design",
        gt=0.0,
    )


estimate = ESTIMATORS.role("estimate", "params", "measured", "dt", "memory", "out", own=("params", "memory"))


@kernel
def force_angle(lag, force_B, dt, last):
    """Return the filtered angle (rad) of ``force_B`` from the -x axis of B; at zero the air meets the vehicle
    along its axis.

    On a body of revolution, air along its axis exerts a force along that axis, whatever the wind; a lateral
    force shows an angle of attack, or a thruster that fires without a command. The angle of attack of
    navigation is only as good as the expected wind. Source: the acceleration ratios technique of entry
    reconstruction (Withers et al. 2003, Planetary and Space Science 51, 541-561), without its aerodynamic
    table.

    Args:
        lag: first-order lag, s; longer than a leak lasts before diagnosis stops it.
        force_B: force that the commanded thrusters do not explain, N, B.
        dt: time since the last call, s.
        last: result of the last call, rad.
    """
    return last + (1.0 - exp(-dt / lag)) * (total_angle_of_attack(scale(-1.0, force_B)) - last)


ESTIMATION = record(
    ("activity", ACTIVITY),
    ("measured", MEASURED),
    ("rate", "f8", (3,)),  # rad/s, B: the last measurement
    ("gain", "f8", (3,)),  # m/s, B: its integral of the specific force
    ("started", FLAG),
    ("law", ESTIMATORS.memory),
    ("engine_shortfall", ENGINE_SHORTFALL),
    ("held_thrust", STUCK_THROTTLE),
)


@kernel
def unexplained_torque(inertia, w, last, applied, dt):
    """Return the mean torque (N m, B) over a cycle of ``dt`` (s) in which the rate changed from ``last`` to
    ``w`` (rad/s), less the ``applied`` torque; ``inertia``: tensor xx, yy, zz, xy, xz, yz (kg m2).
    """
    growth = inertia_times(inertia, scale(1.0 / dt, sub(w, last)))
    middle = scale(0.5, add(w, last))
    return sub(add(growth, cross(middle, inertia_times(inertia, middle))), applied)


@kernel
def unexplained_force(mass, gain, last, applied, dt):
    """Return the mean force (N, B) over a cycle in which the integral of the specific force changed from
    ``last`` to ``gain`` (m/s, B), less the ``applied`` force.
    """
    return sub(scale(mass / dt, sub(gain, last)), applied)


@kernel
def measure(inertia, mass, rate, gain, dt, memory):
    """Fill ``memory.measured`` for the cycle between the last inertial measurement and this one.

    Args:
        inertia, mass: believed principal moments, kg m2, and mass, kg.
        rate: measured body rate, rad/s, B.
        gain: integral of the specific force since the start, m/s, B.
        dt: control cycle, s.
        memory: ``ESTIMATION`` record, its ``activity`` up to date.
    """
    measured, last_rate, last_gain = memory.measured, take3(memory.rate, 0), take3(memory.gain, 0)
    applied = memory.activity.wrench
    measured.mass = mass
    put3(measured.inertia, 0, inertia)
    put3(measured.rate, 0, rate)
    put3(measured.last_rate, 0, last_rate)
    put3(measured.velocity_gain, 0, sub(gain, last_gain))
    put3(measured.applied, 0, take3(applied, 0))
    put3(measured.applied, 3, take3(applied, 3))
    tensor = (inertia[0], inertia[1], inertia[2], 0.0, 0.0, 0.0)
    put3(measured.unexplained, 0, unexplained_force(mass, gain, last_gain, take3(applied, 0), dt))
    put3(measured.unexplained, 3, unexplained_torque(tensor, rate, last_rate, take3(applied, 3), dt))


@kernel
def estimate_disturbance(estimate, params, vehicle, state, nav, imu_delay, effectiveness, dt, memory, out):
    """Update the estimate ``out`` (``DISTURBANCE``) by the latest inertial measurement, which is
    ``imu_delay`` s old, with the chosen estimator.
    """
    end = nav.t - imu_delay
    activity = memory.activity
    expect(effectiveness, vehicle.n_thrusters, end - dt, end, params.valve_lag, memory=activity)
    rate, gain = take3(nav.imu_rate_B, 0), take3(nav.imu_gain_B, 0)
    if memory.started != 0:
        inertia = take3(vehicle.configuration[state.configuration].inertia, 0)
        measure(inertia, state.mass, rate, gain, dt, memory=memory)
        for i in range(6):
            out.unexplained[i] = memory.measured.unexplained[i]
        estimate(params.estimator, params, memory.measured, dt, memory=memory.law, out=out)
    memory.started = 1
    put3(memory.rate, 0, rate)
    put3(memory.gain, 0, gain)
