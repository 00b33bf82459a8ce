"""Gyros and accelerometers whose flag says that they reached the end of their range.

A flagged gyro is left out, or taken to read that end.  A flag that stays on while the other instruments read
a motion far inside the range is itself a failure, and its instrument is excluded.

Source: T. Tolker-Nielsen, EXOMARS 2016 Schiaparelli Anomaly Inquiry, ESA DG-I/2017/546/TTN (2017): as long as
the flag stayed on, the limit of the range was integrated as a constant rate, while the body oscillated.
"""

from __future__ import annotations

from math import copysign

from edl6dof.config.base import Params, param
from edl6dof.fsw.navigation.redundancy import usable
from edl6dof.kernels import kernel
from edl6dof.spatial.vector import dot, take3


class SaturationParams(Params):
    """Gyros at the end of their range."""

    left_out: bool = param(
        True,
        "whether they are left out while their flag is on; otherwise the rate is taken to be the end of the "
        "range at which the flag came on",
    )


@kernel
def usable_gyros(params, instruments, dt, healthy, inertial, redundant):
    """Bits of the gyros to use. Where flagged gyros are not left out, their increments become the end of the
    range that they reached first, for as long as the flag is on.
    """
    number = instruments.n_gyros
    if params.left_out != 0:
        return usable(number, healthy, inertial.gyro_saturated)
    bits = 0
    for i in range(number):
        if healthy[i] != 0:
            bits |= 1 << i
        if inertial.gyro_saturated[i] == 0:
            redundant.end[i] = 0.0
            continue
        if redundant.end[i] == 0.0:
            redundant.end[i] = copysign(1.0, redundant.increment[i])
        redundant.increment[i] = redundant.end[i] * instruments.gyro_range * dt
    return bits


#: Share of the range below which a motion is far inside it.
_FAR_INSIDE = 0.5


@kernel
def exclude_stale_flags(patience, axis, number, end, flags, vector, dt, healthy, flagged):
    """Exclude instruments whose flag has been contradicted by the motion for more than ``patience`` s.

    Args:
        patience: s.
        axis: of each of ``number`` instruments.
        end: of the range, rad/s or m/s2.
        flags: of saturation, as the instruments report them.
        vector: increment of ``dt`` seconds by the others.
        healthy: flags, updated.
        flagged: s, duration of each contradicted flag, updated.
    """
    for i in range(number):
        if flags[i] == 0 or abs(dot(take3(axis[i], 0), vector)) > _FAR_INSIDE * end * dt:
            flagged[i] = 0.0
        elif healthy[i] != 0:
            flagged[i] += dt
            if flagged[i] > patience:
                healthy[i] = 0
