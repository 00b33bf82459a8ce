"""Open loop: bank angle against speed or time, from a table in the scenario.

The baseline without feedback, and the way to fly a bank history taken from elsewhere.  With ``reversal.logic:
own_sign`` the signs of the table are flown; with any other logic its magnitudes, reversed by crossrange.
Source: the open-loop profiles of Yan, Sun & Guo 2016, section 3, which are piecewise linear in speed.
"""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import model_validator

from edl6dof.config.base import REQUIRED, Capacity, Params, param
from edl6dof.jit import kernel
from edl6dof.registry import Member

MAX_POINTS = 32


class BankPoint(Params):
    """One point of the profile."""

    at: float = param(REQUIRED, "speed in m/s, or time from t = 0 in s", ge=0.0, le=20e3)
    bank_deg: float = param(
        REQUIRED, "bank angle there; linear between points, constant beyond the ends", ge=-180.0, le=180.0
    )


class BankProfileParams(Params):
    """Bank angle against speed or time."""

    over: Literal["speed", "time"] = param("speed", "what the table runs over")
    points: Annotated[list[BankPoint], Capacity(MAX_POINTS)] = param(
        None,
        "points of the table, ascending",
        status="published",
        source="Yan 2016: 75 deg above 3500 m/s, 50 deg below 1500 m/s",
        factory=lambda: [BankPoint(at=1500.0, bank_deg=50.0), BankPoint(at=3500.0, bank_deg=75.0)],
        min_length=1,
        max_length=MAX_POINTS,
    )

    @model_validator(mode="after")
    def _ascend(self) -> Self:
        if any(after.at <= before.at for before, after in zip(self.points, self.points[1:], strict=False)):
            raise ValueError("the points must ascend in 'at'")
        return self


@kernel
def guide(params, plan, onboard, nav, memory, out):
    """Wanted bank angle: the table at the present speed or time, its sign included."""
    p = params
    x = nav.speed if p.over == 0 else nav.t
    last = p.n_points - 1
    if x <= p.points[0].at:
        return p.points[0].bank
    for i in range(last):
        low, high = p.points[i], p.points[i + 1]
        if x < high.at:
            return low.bank + (x - low.at) / (high.at - low.at) * (high.bank - low.bank)
    return p.points[last].bank


MEMBER = Member("bank_profile", BankProfileParams, {"guide": guide}, "Yan, Sun & Guo 2016, section 3")
