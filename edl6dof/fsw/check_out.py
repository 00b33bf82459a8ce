"""Check-out of thrusters before they are needed: each is pulsed alone, and the gyros show whether it works.

In the first periods of the first phase the two 250 N thrusters of bank control are switched on and off; one
that does not turn the vehicle is not used for the rest of the flight. Source: Hu et al. 2022, section 3
(pulse length and threshold are estimates). Attitude control is off meanwhile; these are a few tenths of a
second in which the vehicle hardly moves.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from edl6dof.config.base import Params, param
from edl6dof.config.dtype import dtype_of, fill
from edl6dof.kernels import kernel
from edl6dof.records import FLAG, record, whole
from edl6dof.spatial.vector import dot, put3, sub, take3

MAX_CHECKED = 8


class CheckOutParams(Params):
    """Pulses at the start of the first phase that show which thrusters work."""

    thrusters: list[str] = param(
        None, "thrusters to try, in order; may be none", record=False, factory=list, max_length=MAX_CHECKED
    )
    pulse_s: float = param(0.08, "length of the trial pulse", status="estimate", ge=0.02, le=1.0)
    settle_s: float = param(
        0.08, "time after the pulse at which the gyros are read: valve decay, sensor delay", ge=0.0, le=1.0
    )
    share: float = param(
        0.5, "share of the expected rate change below which a thruster counts as dead", gt=0.0, lt=1.0
    )


CHECK_OUT = record(("setting", dtype_of(CheckOutParams)), ("thruster", "i8", (MAX_CHECKED,)), ("count", "i8"))

#: ``next``: number of thrusters already tried; ``under_way``: a trial has begun, at flight time ``since`` (s)
#: with the body rate ``rate`` (rad/s, B); ``response``: rate change of each thruster over the expected one.
CHECK_OUT_MEMORY = record(
    ("next", whole(0, MAX_CHECKED)),
    ("under_way", FLAG),
    ("since", "f8"),
    ("rate", "f8", (3,)),
    ("response", "f8", (MAX_CHECKED,)),
)


def check_out_problems(params: CheckOutParams, thrusters: Sequence[str]) -> dict[str, str]:
    """Return a message for each named thruster that does not exist, by its dotted key."""
    return {
        f"flight_software.check_out.thrusters.{index}": (
            f"no thruster named {name!r}; names: {', '.join(thrusters) or 'none'}"
        )
        for index, name in enumerate(params.thrusters)
        if name not in thrusters
    }


def fill_check_out(record: np.void, params: CheckOutParams, thrusters: Sequence[str]) -> None:
    """Write checked parameters into a ``CHECK_OUT`` record, names turned into indices."""
    fill(record["setting"], params)
    record["count"] = len(params.thrusters)
    record["thruster"][: len(params.thrusters)] = [thrusters.index(name) for name in params.thrusters]


@kernel
def response(wrench, inertia, pulse, before, after):
    """Return the rate change over a pulse along the expected rate change, relative to it: 1 for full thrust,
    0 for none.

    Args:
        wrench: force and torque of the thruster at full thrust, 6 values (N, N m).
        inertia: believed principal moments, kg m2.
        pulse: length of the pulse, s.
        before, after: body rate before and after the pulse, rad/s, B.
    """
    expected = (
        wrench[3] * pulse / inertia[0],
        wrench[4] * pulse / inertia[1],
        wrench[5] * pulse / inertia[2],
    )
    return dot(sub(after, before), expected) / max(dot(expected, expected), 1e-30)


@kernel
def under_check_out(params, phase, memory):
    """Return whether thrusters are still to be tried, which happens in the first phase only."""
    return phase == 0 and memory.next < params.count


@kernel
def put_off(memory):
    """Abandon the present trial, because something else turns the vehicle; the thruster is tried
    again later.
    """
    memory.under_way = 0


@kernel
def check_out(params, effectiveness, inertia, t, rate, dt, memory):
    """Run one control cycle of check-out at flight time ``t`` (s) with the measured body ``rate`` (rad/s, B).

    Returns:
        number of the thruster to open from now on; time for which it is open (s); fraction of its thrust that
        is lost, 0 if it responds or is not evaluated yet.
    """
    thruster, pulse = params.thruster[memory.next], params.setting.pulse
    if memory.under_way == 0:
        memory.under_way, memory.since = 1, t
        put3(memory.rate, 0, rate)
    elapsed = t - memory.since
    if elapsed < pulse - 1e-9:
        return thruster, min(dt, pulse - elapsed), 0.0
    loss = 0.0
    if elapsed >= pulse + params.setting.settle - 1e-9:
        seen = response(effectiveness[thruster], inertia, pulse, take3(memory.rate, 0), rate)
        memory.response[memory.next] = seen
        if seen < params.setting.share:
            loss = min(1.0 - seen, 1.0)
        memory.next += 1
        memory.under_way = 0
    return thruster, 0.0, loss
