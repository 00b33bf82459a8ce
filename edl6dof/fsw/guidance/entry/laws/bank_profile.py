"""Open loop: bank angle against speed or time, from a table in the scenario.

A baseline without feedback, which also flies a given bank history. With ``reversal.logic: own_sign`` the
signs of the table are flown; with any other logic only its magnitudes, and the logic chooses the side.
Source: the open-loop profiles of Yan, Sun & Guo 2016, section 3, which are piecewise linear in speed.
"""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import model_validator

from edl6dof.config.base import Capacity, Params, param
from edl6dof.fsw.guidance.entry.reference import MAX_POINTS, BankPoint, bank_at, must_ascend
from edl6dof.kernels import kernel
from edl6dof.registry import Member


class BankProfileParams(Params):
    """Bank angle against speed or time."""

    over: Literal["speed", "time"] = param("speed", "independent variable of the table")
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
        must_ascend(self.points)
        return self


@kernel
def guide(params, plan, onboard, nav, memory, out):
    """Wanted bank angle: that of the table at the present speed or time, its sign included."""
    return bank_at(params.points, params.n_points, nav.speed if params.over == 0 else nav.t)


MEMBER = Member("bank_profile", BankProfileParams, {"guide": guide}, "Yan, Sun & Guo 2016, section 3")
