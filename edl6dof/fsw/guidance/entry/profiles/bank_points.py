"""A bank profile as points: linear between them, constant beyond the ends."""

from __future__ import annotations

from collections.abc import Sequence

from edl6dof.config.base import REQUIRED, Params, param
from edl6dof.kernels import kernel

MAX_POINTS = 32


class BankPoint(Params):
    """One point of a bank profile."""

    at: float = param(REQUIRED, "speed in m/s, or time from t = 0 in s", ge=0.0, le=20e3)
    bank_deg: float = param(
        REQUIRED, "bank angle there; linear between points, constant beyond the ends", ge=-180.0, le=180.0
    )


def must_ascend(points: Sequence[BankPoint]) -> None:
    """Refuse points that do not ascend.

    Raises:
        ValueError: they do not.
    """
    if any(after.at <= before.at for before, after in zip(points, points[1:], strict=False)):
        raise ValueError("the points must ascend in 'at'")


@kernel
def bank_at(points, count, x):
    """Bank angle (rad) of the first ``count`` ``points`` at speed or time ``x``."""
    if x <= points[0].at:
        return points[0].bank
    for i in range(count - 1):
        low, high = points[i], points[i + 1]
        if x < high.at:
            return low.bank + (x - low.at) / (high.at - low.at) * (high.bank - low.bank)
    return points[count - 1].bank
