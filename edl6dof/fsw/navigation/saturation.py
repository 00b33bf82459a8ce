"""Gyros whose flag says that they met the end of their range: left out, or taken at their word.

Source: T. Tolker-Nielsen, EXOMARS 2016 Schiaparelli Anomaly Inquiry, ESA DG-I/2017/546/TTN (2017): as long as
the flag stayed on, the limit of the range was integrated, constant, while the body in truth swung to and fro.
"""

from __future__ import annotations

from math import copysign

from edl6dof.config.base import Params, param
from edl6dof.fsw.navigation.redundancy import usable
from edl6dof.kernels import kernel


class SaturationParams(Params):
    """Gyros at the end of their range."""

    left_out: bool = param(
        True,
        "whether they are left out while their flag is on; otherwise the rate is taken to be the end of the "
        "range at which the flag came on",
    )


@kernel
def usable_gyros(params, instruments, dt, healthy, inertial, redundant):
    """Bits of the gyros to use; where flagged ones are not left out their increments become the end of the
    range that they met first, for as long as the flag is on.
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
