"""Bridging of a gap in which too few gyros are within their range, and smoothing of the gap afterwards.

Bridge: Euler's equations give the rate w. Under a parachute, the torque is that of the riser, which pulls at
a known point of a body of known mass, centre of mass and inertia with the force m f (f: specific force at the
centre of mass). Without a riser force the torque is taken as zero. The inertial unit, at the position l from
the centre of mass, measures f + w' x l + w x (w x l); with Euler's equations this is a linear equation for
w'. When the gyros are back in range, they show the error of the computed rate. A torque error in proportion
to the force, as from a wrong centre of mass, causes an angle error in proportion to the rate error; this
first correction is made at once. Left out: the torque of air and thrusters, except for a part that grows with
the same law.

Smoothing: for half a second before the gap and a short time after it, the gyros show the part of the angular
acceleration that the riser does not explain. For pitch and yaw each, this part is fitted by

    a f_x + b f_lateral + c + d s + e 6 s (1 - s),

with the specific force f and the fraction s of the gap that has passed. The terms represent an error of the
centre of mass (a), an error of inertia or lever arm (b), and the torque of the air, linear in time (c, d)
with a bulge in the gap (e). The rate error at the end of the gap is one more equation, which mostly
determines the bulge. The fit is integrated twice over the gap, in the axes of the rotating body; the result
minus the first correction is the missing angle. Left out: roll, about which the riser exerts no torque, and
the velocity error due to the wrong attitude, which the radar corrects.

Source: this project; Euler's equations; linear equation: Sherman and Morrison 1950; least squares with prior:
Gelb, Applied Optimal Estimation (1974), section 4.
"""

from __future__ import annotations

from edl6dof.fsw.navigation.strapdown import turn_by
from edl6dof.kernels import kernel
from edl6dof.records import COUNT, FLAG, record
from edl6dof.spatial.quaternion import from_frame, to_frame
from edl6dof.spatial.vector import add, clamp, cross, dot, norm, put3, put4, scale, sub, take3, take4

#: Specific force (m/s2) of a riser pull with the same torque as air and thrusters.
_OTHER = 2.0

RATE_BRIDGE = record(
    ("push", "f8"),  # m/s: integral of the specific force over the gap; 0 while the rate is known
    ("reach", "f8"),  # m: integral of push
    ("added", "f8", (3,)),  # rad, B: correction of the angle after the last gap
)


@kernel
def acceleration_of(body, lever, force, rate):
    """Angular acceleration (rad/s2, B) by the pull of the riser.

    Args:
        body: believed ``CONFIGURATION`` record.
        lever: from the centre of mass to the accelerometers, m, B.
        force, rate: reading of the accelerometers, m/s2, B; body rate, rad/s, B.
    """
    arm, m = sub(take3(body.hung_at, 0), take3(body.centre, 0)), body.mass
    a, b, c = take3(body.inertia, 0)
    felt = sub(force, cross(rate, cross(rate, lever)))
    spin = (a * rate[0], b * rate[1], c * rate[2])
    torque = sub(scale(m, cross(arm, felt)), cross(rate, spin))
    more = m * dot(arm, lever)
    a, b, c = a + more, b + more, c + more
    x = (torque[0] / a, torque[1] / b, torque[2] / c)
    z = (m * lever[0] / a, m * lever[1] / b, m * lever[2] / c)
    return add(x, scale(dot(arm, x) / (1.0 - dot(arm, z)), z))


@kernel
def bridge_rate(body, lever, gain, most, dt, memory, motion):
    """Propagate angle and rate of ``motion`` (``MOTION``) from the last cycle, by the velocity ``gain`` (m/s,
    B) that the accelerometers measured in this cycle.

    Each component of the rate is limited to ``most`` (rad/s): the centripetal part of the reading grows with
    the square of the rate, and a wrong rate would diverge.
    """
    force = scale(1.0 / dt, gain)
    rate = take3(motion.rate, 0)
    change = scale(dt, acceleration_of(body, lever, force, rate))
    put3(motion.angle, 0, scale(dt, add(rate, scale(0.5, change))))
    for i in range(3):
        motion.rate[i] = clamp(rate[i] + change[i], -most, most)
    memory.reach += dt * (memory.push + 0.5 * dt * (norm(force) + _OTHER))
    memory.push += dt * (norm(force) + _OTHER)


@kernel
def end_bridge(body, lever, gain, most, dt, rate_before, memory, motion):
    """Correct the angle of ``motion``, which is again measured by the gyros, for the error of the bridged
    angle; ``rate_before``: last bridged rate (rad/s, B).
    """
    angle, rate = take3(motion.angle, 0), take3(motion.rate, 0)
    put3(motion.rate, 0, rate_before)
    bridge_rate(body, lever, gain, most, dt, memory=memory, motion=motion)
    off = scale(1.0 / dt, sub(angle, take3(motion.angle, 0)))
    put3(memory.added, 0, scale(memory.reach / memory.push, off))
    put3(motion.angle, 0, add(angle, take3(memory.added, 0)))
    put3(motion.rate, 0, rate)
    memory.push = memory.reach = 0.0


#: Cycles before and after the gap in the fit, and capacity of the ring.
BEFORE, AFTER, KEPT = 25, 15, 256
UNKNOWNS = 5
#: Standard deviations of a (1/m), b (1/m), c, d, e (rad/s2): an error of 6 mm of the centre of mass, of a
#: sixth of the lever, the torque of the air at the opening of the parachute.
_EXPECTED = (0.01, 0.6, 0.2, 0.2, 0.1)
#: Standard deviation of the residual of the fit in a cycle, rad/s2, and of the rate error after the gap,
#: rad/s.
_SCATTER, _RATE = 0.087, 0.001
#: Largest correction (rad): the method is made for degrees.
_LARGEST = 1.0

GAP_SMOOTHING = record(
    ("kept", COUNT),  # cycles stored since the riser pulls
    ("gap", COUNT),  # cycles of the gap; 0: no gap to smooth
    ("after", COUNT),  # cycles after the gap
    ("hung", FLAG),  # a riser pulls
    ("rate", "f8", (3,)),  # rad/s, B: at the end of the last cycle
    ("dt", "f8", (KEPT,)),  # s
    ("turning", "f8", (KEPT, 3)),  # rad/s, B: mean rate, as bridged
    ("force", "f8", (KEPT, 3)),  # m/s2, B
    ("unexplained", "f8", (KEPT, 3)),  # rad/s2, B: angular acceleration less that of the riser
    ("off", "f8", (3,)),  # rad/s, B: error of the bridged rate
    ("added", "f8", (3,)),  # rad, B: correction added at the end of the gap
    ("q_I2B", "f8", (4,)),  # attitude at the end of the gap
    ("equations", "f8", (UNKNOWNS, UNKNOWNS + 1)),
    ("found", "f8", (3, UNKNOWNS)),  # a to e about each axis
)


@kernel
def smooth_gap(body, lever, inertial, motion, memory, solution):
    """Record a cycle of ``motion``; a little after a gap, turn ``solution`` by the missing angle.

    Args:
        body: believed configuration of the vehicle.
        lever: from the centre of mass to the accelerometers, m, B.
        inertial: ``INERTIAL_MEMORY`` record: velocity gain, and correction at the end of the bridge.
        motion, solution: ``MOTION`` record; ``SOLUTION`` record, updated.
        memory: ``GAP_SMOOTHING`` record, updated.
    """
    hung = 1 if norm(sub(take3(body.hung_at, 0), take3(body.centre, 0))) > 0.0 else 0
    if hung != memory.hung:
        memory.hung, memory.kept = hung, 0
        # a gap that began in another configuration is not smoothed
        memory.gap = KEPT if motion.rate_known == 0 else 0
    if hung != 0:
        _record_cycle(body, lever, take3(inertial.gain, 0), motion, memory)
        if motion.rate_known == 0:
            memory.gap, memory.after = memory.gap + 1, 0
        elif memory.gap > 0:
            _follow_gap(body, lever, inertial.rate_bridge, memory, solution)
    for i in range(3):
        memory.rate[i] = motion.rate[i]


@kernel
def _record_cycle(body, lever, gain, motion, memory):
    """Store a cycle in the ring; ``gain``: velocity gained at the accelerometers (m/s, B)."""
    row = memory.kept % KEPT
    memory.kept += 1
    force = scale(1.0 / motion.dt, gain)
    middle = scale(0.5, add(take3(memory.rate, 0), take3(motion.rate, 0)))
    given = acceleration_of(body, lever, force, middle)
    memory.dt[row] = motion.dt
    for i in range(3):
        memory.force[row, i], memory.turning[row, i] = force[i], middle[i]
        change = (motion.rate[i] - memory.rate[i]) / motion.dt
        memory.unexplained[row, i] = change - given[i]


@kernel
def _follow_gap(body, lever, bridge, memory, solution):
    """Store the errors at the end of the gap, and correct the attitude after enough further cycles."""
    if memory.after == 0:
        last = (memory.kept - 1) % KEPT
        for i in range(3):
            memory.off[i] = memory.unexplained[last, i] * memory.dt[last]
            memory.added[i] = bridge.added[i]
        put4(memory.q_I2B, solution.q_I2B)
    memory.after += 1
    if memory.after == AFTER:
        if memory.gap + BEFORE + AFTER < KEPT:
            _correct_attitude(body, lever, memory, solution)
        memory.gap = 0


@kernel
def _correct_attitude(body, lever, memory, solution):
    """Turn the attitude by the missing angle about the pitch and yaw axes at the end of the gap."""
    begins = memory.kept - memory.after - memory.gap
    length = 0.0
    for k in range(begins, begins + memory.gap):
        length += memory.dt[k % KEPT]
    _fit(1, 2, length, memory)
    _fit(2, 1, length, memory)
    x, y, z = _missing_angle(body, lever, begins, length, memory)
    lacked = sub((x, y, z), take3(memory.added, 0))
    if not norm(lacked) < _LARGEST:  # nor a diverged fit, which is not a number
        return
    q = take4(memory.q_I2B)
    now = take4(solution.q_I2B)
    turned = turn_by(now, to_frame(now, from_frame(q, lacked)))
    put4(solution.q_I2B, turned)


@kernel
def _fit(axis, lateral, length, memory):
    """Fit a to e for the rotation about ``axis`` (index in B) over a gap of ``length`` s; ``lateral``: index
    of the lateral force that causes torque about it.
    """
    ends = memory.kept - memory.after
    begins = ends - memory.gap
    first = max(begins - BEFORE, 0)
    equations = memory.equations
    equations[:] = 0.0
    for i in range(UNKNOWNS):
        equations[i, i] = 1.0 / _EXPECTED[i] ** 2
    at = 0.0
    for k in range(first, begins):
        at -= memory.dt[k % KEPT]
    rate = (0.0, 0.0, 0.0, 0.0, 0.0)
    for k in range(first, memory.kept):
        row = k % KEPT
        dt = memory.dt[row]
        terms = _terms((at + 0.5 * dt) / length, memory.force[row, 0], memory.force[row, lateral])
        at += dt
        if begins <= k <= ends:  # the rate is corrected at the end of the gap
            rate = _plus(rate, dt, terms)
        else:
            _add_equation(terms, memory.unexplained[row, axis], _SCATTER, equations)
    _add_equation(rate, memory.off[axis], _RATE, equations)
    _solve(equations)
    for i in range(UNKNOWNS):
        memory.found[axis, i] = equations[i, UNKNOWNS]


@kernel
def _missing_angle(body, lever, begins, length, memory):
    """Angle (rad, B) missing at the end of the gap by the fit; the remaining rate error is assumed to have
    grown evenly.
    """
    rate, angle = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    at = 0.0
    for k in range(begins, begins + memory.gap):
        row = k % KEPT
        dt, force = memory.dt[row], take3(memory.force[row], 0)
        s = (at + 0.5 * dt) / length
        pitch = _times(memory.found[1], _terms(s, force[0], force[2]))
        yaw = _times(memory.found[2], _terms(s, force[0], force[1]))
        half = scale(0.5 * dt, (0.0, pitch, yaw))
        rate = add(rate, half)
        bridged = take3(memory.turning[row], 0)
        turning = add(bridged, rate)
        # the force at the unit contains the rotation, which the bridge had wrong
        more = acceleration_of(body, lever, force, turning)
        less = acceleration_of(body, lever, force, bridged)
        half = add(half, scale(0.5 * dt, sub(more, less)))
        angle = add(angle, scale(dt, sub(rate, cross(turning, angle))))
        rate = add(rate, half)
        at += dt
    # the rate error includes the cycle after the gap
    off = scale(length / (length + memory.dt[begins % KEPT]), take3(memory.off, 0))
    return add(angle, scale(0.5 * length, sub(off, rate)))


@kernel
def _terms(s, force, lateral):
    """The five terms of the fit at the share ``s`` of the gap; the bulge is zero outside the gap."""
    bulge = 6.0 * s * (1.0 - s) if 0.0 < s < 1.0 else 0.0
    return force, lateral, 1.0, s - 0.5, bulge


@kernel
def _times(found, terms):
    """Sum of the products of coefficients and terms."""
    total = 0.0
    for i in range(UNKNOWNS):
        total += found[i] * terms[i]
    return total


@kernel
def _plus(total, dt, terms):
    """``total + dt terms``."""
    return (
        total[0] + dt * terms[0],
        total[1] + dt * terms[1],
        total[2] + dt * terms[2],
        total[3] + dt * terms[3],
        total[4] + dt * terms[4],
    )


@kernel
def _add_equation(terms, value, sigma, equations):
    """Add the normal equations of one measured ``value`` with standard deviation ``sigma``."""
    weight = 1.0 / (sigma * sigma)
    for i in range(UNKNOWNS):
        for j in range(UNKNOWNS):
            equations[i, j] += weight * terms[i] * terms[j]
        equations[i, UNKNOWNS] += weight * terms[i] * value


@kernel
def _solve(equations):
    """Solve a positive definite system without pivoting, in place; its last column is the right-hand side,
    then the solution.
    """
    for k in range(UNKNOWNS):
        for j in range(k + 1, UNKNOWNS + 1):
            equations[k, j] /= equations[k, k]
        for i in range(UNKNOWNS):
            if i != k:
                for j in range(k + 1, UNKNOWNS + 1):
                    equations[i, j] -= equations[i, k] * equations[k, j]
