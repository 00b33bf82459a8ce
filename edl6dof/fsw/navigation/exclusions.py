"""Exclusion of radar beams as failed, and the log of all exclusions.

Each use of a radar measurement by the filter, a look, reports the ranges and speeds that the filter refused
(``SOLUTION.ranges_refused``, ``speeds_refused``). Ranges and speeds are monitored separately: terrain of an
unexpected shape contradicts ranges, but not speeds. A look in which most beams are refused isolates no beam:
the solution is wrong, or dust hides the ground from all beams. The score of a reading rises by one when it is
refused and falls by one when it is not; at the limit the reading is excluded, and after a long agreement with
the filter it is used again. A beam without an echo in many looks in a row, while most others have one, is
excluded as well, once the vehicle has moved on: a steep slope returns no echo, however often it is looked at.
A refused echo that moves away, by its speed and by its range alike, raises no score: it comes from a part
that falls ahead of the vehicle, such as the heat shield, and the beam works.

The log lists, in the order of time, each instrument that is excluded or used again by ``INSTRUMENT_HEALTH``,
and the inertial unit as out of use while too few gyros are in range for the rate.

Source: this project.
"""

from __future__ import annotations

from math import sqrt

from edl6dof.config.base import Params, param
from edl6dof.fsw.navigation.radar_beams import locked_beams
from edl6dof.interface.capacities import MAX_ACCELEROMETERS, MAX_BEAMS, MAX_GYROS, MAX_TRACKERS
from edl6dof.kernels import kernel
from edl6dof.records import COUNT, FLAG, record, whole
from edl6dof.spatial.elementary import cos
from edl6dof.spatial.quaternion import to_frame
from edl6dof.spatial.vector import cross, dot, norm, scale, sub, take3, take4, unit


class BeamWatchParams(Params):
    """Exclusion of beams of the radar."""

    enabled: bool = param(True, "whether beams are excluded")
    refused_looks: int = param(
        30, "score of a beam, rejected minus used readings, at which it is excluded", ge=1, le=10000
    )
    silent_looks: int = param(
        30, "consecutive looks without an echo, while at least half of the beams have one, that "
"exclude a beam", ge=1, le=10000
    )  # fmt: skip
    silent_path_m: float = param(
        30.0, "least path over the ground in these looks", status="estimate", ge=0.0, le=1e5
    )
    silent_angle_deg: float = param(
        45.0, "angle to the vertical beyond which a beam may lack an echo", status="estimate", gt=0.0, le=90.0
    )
    agreed_looks: int = param(
        100, "consecutive looks without rejection after which a beam is used again", ge=1, le=10000
    )


_SCORES = record(
    ("refused", COUNT, (MAX_BEAMS,)),  # score
    ("silent", COUNT, (MAX_BEAMS,)),  # looks in a row
    ("silent_m", "f8", (MAX_BEAMS,)),  # m: path over the ground in these looks
    ("agreed", COUNT, (MAX_BEAMS,)),  # looks in a row
)
#: Echo of a beam that moves away by its speed.
_RECEDING = record(
    ("first", "f8", (MAX_BEAMS,)),  # m: its first range
    ("travel", "f8", (MAX_BEAMS,)),  # m: integral of its speed since then
    ("t", "f8", (MAX_BEAMS,)),  # s: time of the last such echo
)
BEAM_WATCH = record(
    ("range", _SCORES),
    ("speed", _SCORES),
    ("receding", _RECEDING),
    ("t", "f8"),  # s: time of the last look; 0: none
)


@kernel
def watch_beams(params, planet, instruments, radar, solution, health, memory):
    """Exclude ranges and speeds of beams, or use them again, after the filter has processed the ``radar``."""
    if params.enabled != 0 and solution.looked != 0:
        locked, due = locked_beams(radar, instruments.n_beams), steep_beams(params, instruments, solution)
        echoes = locked, due, receding_beams(instruments, radar, solution.t, memory.receding)
        path = (solution.t - memory.t) * ground_speed(planet, solution) if memory.t > 0.0 else 0.0
        memory.t = solution.t
        refused = solution.ranges_refused
        watch_readings(
            params, instruments.n_beams, echoes, refused, path, healthy=health.beam_range, memory=memory.range
        )
        refused = solution.speeds_refused
        watch_readings(
            params, instruments.n_beams, echoes, refused, path, healthy=health.beam_speed, memory=memory.speed
        )


@kernel
def ground_speed(planet, solution):
    """Speed (m/s) of the solution relative to the planet."""
    r, v = take3(solution.r_I, 0), take3(solution.v_I, 0)
    return norm(sub(v, cross((0.0, 0.0, planet.rotation_rate), r)))


@kernel
def steep_beams(params, instruments, solution):
    """Bits of the beams steep enough to the ground that an echo is expected."""
    q = take4(solution.q_I2B)
    down = to_frame(q, scale(-1.0, unit(take3(solution.r_I, 0))))
    least, bits = cos(params.silent_angle), 0
    for i in range(instruments.n_beams):
        if dot(take3(instruments.beam_axis[i], 0), down) > least:
            bits |= 1 << i
    return bits


#: Standard deviations within which the range follows the speed; the travel must be longer.
_FOLLOWS = 3.0


@kernel
def receding_beams(instruments, radar, t, memory):
    """Bits of the beams whose echo has moved away, by its speed and by its range alike; ``t``: s."""
    bits = 0
    for i in range(instruments.n_beams):
        reach, speed = radar.range[i], radar.speed[i]
        if radar.locked[i] == 0 or speed >= 0.0:
            continue
        memory.travel[i] -= speed * (t - memory.t[i])
        memory.t[i] = t
        off = _FOLLOWS * sqrt(2.0) * (instruments.range_sigma + instruments.range_sigma_relative * reach)
        if abs(reach - memory.first[i] - memory.travel[i]) >= off:  # another echo than before
            memory.first[i], memory.travel[i] = reach, 0.0
        elif memory.travel[i] > off:
            bits |= 1 << i
    return bits


@kernel
def watch_readings(params, n_beams, echoes, refused, path, healthy, memory):
    """Exclude ranges or speeds, or use them again. ``echoes``: beams with an echo, with an expected echo and
    with one that moves away, ``refused``: beams refused by the filter, a bit for each; ``path``: path over
    the ground since the last look, m; ``healthy``: flags, updated.
    """
    locked, due, receding = echoes
    with_echo = against = 0
    for i in range(n_beams):
        with_echo += locked >> i & 1
        against += refused >> i & 1
    few_refused, few_silent = 2 * against <= with_echo and with_echo > 2, 2 * with_echo >= n_beams
    for i in range(n_beams):
        if locked >> i & 1 == 0 and few_silent and due >> i & 1:
            memory.silent[i] += 1
            memory.silent_m[i] += path
        else:
            memory.silent[i], memory.silent_m[i] = 0, 0.0
        if locked >> i & 1 == 0:
            memory.agreed[i] = 0
        elif refused >> i & 1:
            memory.agreed[i] = 0
            memory.refused[i] += 1 if few_refused and receding >> i & 1 == 0 else 0
        else:
            memory.refused[i] = max(memory.refused[i] - 1, 0)
            memory.agreed[i] += 1
        silent = memory.silent[i] >= params.silent_looks and memory.silent_m[i] >= params.silent_path
        if memory.refused[i] >= params.refused_looks or silent:
            healthy[i] = 0
            memory.refused[i] = memory.agreed[i] = 0
        elif healthy[i] == 0 and memory.agreed[i] >= params.agreed_looks:
            healthy[i] = 1


#: Numbers in the log: first gyro, first accelerometer, first beam, first star tracker, inertial unit.
GYROS = 0
ACCELEROMETERS = GYROS + MAX_GYROS
BEAMS = ACCELEROMETERS + MAX_ACCELEROMETERS
STAR_TRACKER = BEAMS + MAX_BEAMS
INERTIAL_UNIT = STAR_TRACKER + MAX_TRACKERS
#: Capacity of the log.
MAX_CHANGES = 32

CHANGE = record(
    ("t", "f8"),  # s, flight time
    ("number", whole(0, INERTIAL_UNIT)),  # of the instrument that changed
    ("back", FLAG),  # 0: excluded; 1: used again
)
EXCLUSIONS = record(
    ("out", FLAG, (INERTIAL_UNIT + 1,)),  # instruments out of use
    ("changes", CHANGE, (MAX_CHANGES,)),
    ("n_changes", whole(0, MAX_CHANGES)),
)


@kernel
def note_changes(instruments, t, health, motion, memory):
    """Log at ``t`` (s) the changes of ``health`` and ``motion`` since the last cycle."""
    for i in range(instruments.n_gyros):
        _note(t, GYROS + i, health.gyro[i], memory)
    for i in range(instruments.n_accelerometers):
        _note(t, ACCELEROMETERS + i, health.accelerometer[i], memory)
    for i in range(instruments.n_beams):
        _note(t, BEAMS + i, health.beam_range[i] & health.beam_speed[i], memory)
    for i in range(instruments.n_trackers):
        _note(t, STAR_TRACKER + i, health.star_tracker[i], memory)
    _note(t, INERTIAL_UNIT, motion.rate_known, memory)


@kernel
def _note(t, number, in_use, memory):
    """Log a change of one instrument; changes beyond the capacity of the log are lost."""
    if memory.out[number] == 1 - in_use:
        return
    memory.out[number] = 1 - in_use
    if memory.n_changes < MAX_CHANGES:
        change = memory.changes[memory.n_changes]
        change.t, change.number, change.back = t, number, in_use
        memory.n_changes += 1
