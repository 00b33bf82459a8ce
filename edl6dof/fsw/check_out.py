"""Check-out of thrusters before they are needed: each is pulsed alone, and its work is judged by the gyros.

In the first periods of the first phase the two 250 N thrusters of bank control are switched on and off; one
that does not turn the vehicle is taken out of the selection for the rest of the flight.  Source: Hu et al.
2022, section 3 (pulse length and threshold are estimates).  Attitude control rests meanwhile, a few tenths of
a second in which the vehicle hardly moves.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from edl6dof.config.base import Params, param
from edl6dof.config.dtype import dtype_of, fill
from edl6dof.jit import kernel
from edl6dof.records import FLAG, whole
from edl6dof.spatial.vector import dot, put3, sub, take3

MAX_CHECKED = 8


class CheckOutParams(Params):
    """Pulses at the start of the first phase that show which thrusters work."""

    thrusters: list[str] = param(
        None,
        "thrusters that are tried, in order; none for no check-out",
        record=False,
        factory=list,
        max_length=MAX_CHECKED,
    )
    pulse_s: float = param(0.08, "length of the trial pulse", status="estimate", ge=0.02, le=1.0)
    settle_s: float = param(
        0.08,
        ("time after the pulse at which the gyros are read: valve decay and sensor delay"),
        ge=0.0,
        le=1.0,
    )
    share: float = param(
        0.5, "share of the expected rate change below which a thruster counts as dead", gt=0.0, lt=1.0
    )


CHECK_OUT = np.dtype(
    [("setting", dtype_of(CheckOutParams)), ("thruster", "i8", (MAX_CHECKED,)), ("count", "i8")],
    align=True,
)

#: ``next`` counts the thrusters done; ``response`` is the rate change of each over the expected one.
CHECK_OUT_MEMORY = np.dtype(
    [
        ("next", whole(0, MAX_CHECKED)),
        ("under_way", FLAG),
        ("since", "f8"),
        ("rate", "f8", (3,)),
        ("response", "f8", (MAX_CHECKED,)),
    ],
    align=True,
)


def check_out_problems(params: CheckOutParams, thrusters: Sequence[str]) -> dict[str, str]:
    """Names of thrusters that do not exist, by dotted key."""
    known = ", ".join(thrusters) or "none"
    return {
        f"flight_software.check_out.thrusters.{index}": f"no thruster named {name!r}; names: {known}"
        for index, name in enumerate(params.thrusters)
        if name not in thrusters
    }


def fill_check_out(record: np.void, params: CheckOutParams, thrusters: Sequence[str]) -> None:
    """Write checked parameters into a ``CHECK_OUT`` record, names turned into indices."""
    fill(record["setting"], params)
    record["count"] = len(params.thrusters)
    record["thruster"][: len(params.thrusters)] = [thrusters.index(name) for name in params.thrusters]


@kernel
def response(effect, inertia, pulse, before, after):
    """Rate change over a pulse along the expected one, in units of it: 1 for full thrust, 0 for none.

    Args:
        effect: force and torque of the thruster, 6 values.
        inertia: believed principal moments, kg m2.
        pulse: its length, s.
        before: rate before it, rad/s.
        after: rate after it, rad/s.
    """
    expected = (
        effect[3] * pulse / inertia[0],
        effect[4] * pulse / inertia[1],
        effect[5] * pulse / inertia[2],
    )
    return dot(sub(after, before), expected) / max(dot(expected, expected), 1e-30)


@kernel
def check_out(onboard, dt, fsw):
    """One control cycle of check-out: writes the valve intervals and, at the end of a trial, ``fsw.healthy``;
    false once all is done.
    """
    p, memory, nav = onboard.check_out, fsw.check_out, fsw.nav
    if fsw.phase != 0 or memory.next >= p.count:
        return False
    thruster = p.thruster[memory.next]
    rate = take3(nav.imu_rate_B, 0)
    if memory.under_way == 0:
        memory.under_way, memory.since = 1, nav.t
        put3(memory.rate, 0, rate)
    elapsed = nav.t - memory.since
    for i in range(onboard.vehicle.n_thrusters):
        fsw.command.opens[i] = fsw.command.closes[i] = nav.t
    if elapsed < p.setting.pulse - 1e-9:
        fsw.command.closes[thruster] = nav.t + min(dt, p.setting.pulse - elapsed)
    elif elapsed >= p.setting.pulse + p.setting.settle - 1e-9:
        inertia = onboard.vehicle.configuration[fsw.configuration].inertia
        seen = response(fsw.allocator.effect[thruster], inertia, p.setting.pulse, take3(memory.rate, 0), rate)
        memory.response[memory.next] = seen
        if seen < p.setting.share:
            fsw.healthy[thruster] = 0
        memory.next += 1
        memory.under_way = 0
    return True
