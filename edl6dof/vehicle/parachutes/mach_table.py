"""A factor tabulated over Mach number: on straight lines between its points, held beyond the first and
last.
"""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import model_validator

from edl6dof.config.base import Capacity, Hardware, param
from edl6dof.kernels import kernel
from edl6dof.spatial.table_index import between, cell_among

MAX_MACH_POINTS = 16


class MachTable(Hardware):
    """A factor over Mach number, by its points; without points there is no table."""

    mach: Annotated[list[float], Capacity(MAX_MACH_POINTS)] = param(
        None, "Mach numbers, ascending; none: no table", factory=list, max_length=MAX_MACH_POINTS
    )
    factor: Annotated[list[float], Capacity(MAX_MACH_POINTS)] = param(
        None, "the factor at each of them, 0 to 2", factory=list, max_length=MAX_MACH_POINTS
    )

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        problems = []
        points = len(self.mach)
        if points == 1 or any(b <= a for a, b in zip(self.mach, self.mach[1:], strict=False)):
            problems.append(f"mach must be two or more numbers that ascend, or none (got {self.mach})")
        elif any(mach < 0.0 for mach in self.mach):
            problems.append(f"mach must not be negative (got {self.mach})")
        if len(self.factor) != points:
            problems.append(f"factor must be as many as mach, {points} (got {len(self.factor)})")
        elif not all(0.0 < factor <= 2.0 for factor in self.factor):
            problems.append(f"factor must be above 0 and at most 2 (got {self.factor})")
        if problems:
            raise ValueError("; ".join(problems))
        return self


@kernel
def tabulated(table, mach):
    """The factor at a Mach number; the table must have points."""
    index, share = cell_among(table.mach, table.n_mach, mach)
    return between(table.factor, index, share)
