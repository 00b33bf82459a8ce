"""One control cycle of estimation: what the thrusters should have done, what they do not explain, and what
disturbance that is.

Both are means over just the cycle that the latest inertial measurement covers
(:mod:`edl6dof.fsw.estimation.activity`), so neither rounding by the modulator nor the age of the measurement
is mistaken for a disturbance.
"""

from __future__ import annotations

import numpy as np

from edl6dof.fsw.estimation.activity import ACTIVITY, expect
from edl6dof.fsw.estimation.engine_shortfall import ENGINE_SHORTFALL
from edl6dof.fsw.estimation.held_thrust import HELD_THRUST
from edl6dof.fsw.estimation.registry import ESTIMATORS, MEASURED, estimate
from edl6dof.jit import kernel
from edl6dof.records import FLAG
from edl6dof.spatial.vector import add, cross, inertia_times, put3, scale, sub, take3

ESTIMATION = np.dtype(
    [
        ("activity", ACTIVITY),
        ("measured", MEASURED),
        ("rate", "f8", (3,)),  # rad/s, B: the last measurement
        ("gain", "f8", (3,)),  # m/s, B: and its count of the specific force
        ("started", FLAG),
        ("law", ESTIMATORS.memory),
        ("engine_shortfall", ENGINE_SHORTFALL),
        ("held_thrust", HELD_THRUST),
    ],
    align=True,
)


@kernel
def unexplained_torque(inertia, w, last, applied, dt):
    """Mean torque (N m, B) over a cycle in which the rate went from ``last`` to ``w`` (rad/s), less the
    ``applied`` one.

    ``inertia`` is a tensor: xx, yy, zz, xy, xz, yz, kg m2.
    """
    growth = inertia_times(inertia, scale(1.0 / dt, sub(w, last)))
    middle = scale(0.5, add(w, last))
    return sub(add(growth, cross(middle, inertia_times(inertia, middle))), applied)


@kernel
def unexplained_force(mass, gain, last, applied, dt):
    """Mean force (N, B) over a cycle from the velocity gained (m/s, B), less the ``applied`` one."""
    return sub(scale(mass / dt, sub(gain, last)), applied)


@kernel
def measure(inertia, mass, rate, gain, dt, memory):
    """Fill ``memory.measured`` for the cycle between the last inertial measurement and this one.

    Args:
        inertia: believed principal moments, kg m2.
        mass: believed mass, kg.
        rate: measured body rate, rad/s, B.
        gain: count of the specific force, m/s, B.
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
def estimate_disturbance(params, vehicle, state, nav, imu_delay, effectiveness, dt, memory, out):
    """Bring the estimate up to the latest inertial measurement.

    Args:
        params: estimation record.
        vehicle: believed vehicle.
        state: ``VEHICLE_STATE`` record (configuration, mass).
        nav: ``NAV`` record (readings of the inertial measurement unit).
        imu_delay: age of these readings, s.
        effectiveness: force and torque of each thruster at full thrust, rows of 6 (N, N m).
        dt: control cycle, s.
        memory: ``ESTIMATION`` record, updated.
        out: ``DISTURBANCE`` record, written.
    """
    end = nav.t - imu_delay
    expect(
        effectiveness,
        count=vehicle.n_thrusters,
        begin=end - dt,
        end=end,
        lag=params.valve_lag,
        memory=memory.activity,
    )
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
