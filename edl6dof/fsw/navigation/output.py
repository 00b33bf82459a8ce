"""Output of navigation: the solution extrapolated to the present cycle, with a checked height."""

from __future__ import annotations

from edl6dof.fsw.navigation.integrity import (
    check_solution,
    height_and_climb,
    height_while_lost,
    plausible_height,
)
from edl6dof.fsw.navigation.strapdown import gravity_I, turn_by
from edl6dof.kernels import kernel
from edl6dof.spatial.quaternion import from_frame
from edl6dof.spatial.vector import add, norm, put3, scale, take3


@kernel
def extrapolate(planet, motion, solution, estimate):
    """Fill ``estimate`` (``ESTIMATE``), except its time and height: ``solution`` extrapolated from the time
    of the last reading to the cycle, with the latest rate and specific force of ``motion``.
    """
    age = estimate.t - solution.t
    q = (solution.q_I2B[0], solution.q_I2B[1], solution.q_I2B[2], solution.q_I2B[3])
    r, v = take3(solution.r_I, 0), take3(solution.v_I, 0)
    rate = take3(motion.rate, 0)
    force = scale(1.0 / motion.dt if motion.dt > 0.0 else 0.0, take3(motion.gain, 0))
    gained = scale(age, add(from_frame(q, force), gravity_I(planet, r)))
    r = add(r, scale(age, add(v, scale(0.5, gained))))
    put3(estimate.r_I, 0, r)
    put3(estimate.v_I, 0, add(v, gained))
    turned = turn_by(q, scale(age, rate))
    for i in range(4):
        estimate.q_I2B[i] = turned[i]
    put3(estimate.w_B, 0, rate)
    put3(estimate.specific_force_B, 0, force)
    put3(estimate.imu_rate_B, 0, rate)


@kernel
def take_given(sensed, estimate):
    """Copy the readings of ideal instruments."""
    for i in range(4):
        estimate.q_I2B[i] = sensed.q_I2B[i]
    put3(estimate.r_I, 0, take3(sensed.r_I, 0))
    put3(estimate.v_I, 0, take3(sensed.v_I, 0))
    put3(estimate.w_B, 0, take3(sensed.w_B, 0))
    put3(estimate.specific_force_B, 0, take3(sensed.specific_force_B, 0))
    put3(estimate.imu_rate_B, 0, take3(sensed.imu_rate_B, 0))
    put3(estimate.imu_gain_B, 0, take3(sensed.imu_gain_B, 0))
    estimate.height_above_ground = sensed.height_above_ground


@kernel
def check_integrity(onboard, sensed, memory, estimate):
    """Set the height of ``estimate`` to one that is plausible, and start the recovery of the vertical where
    the solution cannot be true.
    """
    params, solution, instruments = onboard.navigation.guards, memory.solution, onboard.instruments
    r, v = take3(estimate.r_I, 0), take3(estimate.v_I, 0)
    height, climb, up = height_and_climb(onboard.planet, onboard.site, r, v, solution.terrain)
    height = plausible_height(
        params,
        height,
        climb,
        sigma=solution.sigma_height,
        contact=sensed.footpad_contact,
        dt=memory.motion.dt,
        memory=memory.integrity,
    )
    spin = onboard.planet.rotation_rate
    speed = norm((v[0] + spin * r[1], v[1] - spin * r[0], v[2]))
    q = (estimate.q_I2B[0], estimate.q_I2B[1], estimate.q_I2B[2], estimate.q_I2B[3])
    check_solution(
        params, instruments, memory.health, sensed, speed, sigma=norm(take3(solution.sigma_v, 0)), q=q, up=up,
        memory=memory.integrity, recovery=memory.recovery,
    )  # fmt: skip
    if memory.recovery.lost != 0:
        height = height_while_lost(instruments, memory.health, sensed.radar, memory.integrity)
    estimate.height_above_ground = height
