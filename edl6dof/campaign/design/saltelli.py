"""The design of flights from which Sobol indices are formed: two matrices of unit numbers, A and B, and for
each group of inputs A with that group's columns from B.

Source: Saltelli et al., Comput. Phys. Commun. 181 (2010) 259; groups: Saltelli et al., Global Sensitivity
Analysis: The Primer (2008), 4.6.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import get_args

import numpy as np

from edl6dof.campaign.design.case import A, B, Of, group_of
from edl6dof.campaign.design.sampling import sobol_numbers
from edl6dof.campaign.design.sections import CampaignParams

#: Name of the random profiles (density, gusts), which are a group of their own.
PROFILES = "random profiles"


@dataclass(frozen=True)
class Swaps:
    """Cases row by row: A, B, then A with each group from B.

    Attributes:
        groups: columns of the unit numbers that belong together, by name; none for the random profiles.
        rows: of each matrix.
        seed: of the Sobol sequence.
    """

    groups: dict[str, list[int]]
    rows: int
    seed: int

    @property
    def width(self) -> int:
        """Cases of a row."""
        return len(self.groups) + 2

    def matrix(self, case: int) -> str:
        """To which matrix a case belongs, or which group it has from B."""
        return (A, B, *self.groups)[case % self.width]

    def profile(self, case: int) -> int:
        """Number of its random profiles: those of A are the first, those of B follow."""
        return case // self.width + self.rows * (self.matrix(case) in (B, PROFILES))

    def unit_numbers(self, start: int, stop: int) -> np.ndarray:
        """Unit numbers of cases ``start .. stop - 1``, shape (stop - start, columns)."""
        columns = sum(map(len, self.groups.values()))
        first, last = start // self.width, -(-stop // self.width)
        both = sobol_numbers(self.seed, 2 * columns, first, last)
        found = np.empty((stop - start, columns))
        for case in range(start, stop):
            a, b = np.split(both[case // self.width - first], 2)
            matrix = self.matrix(case)
            found[case - start] = b if matrix == B else a
            swapped = self.groups.get(matrix, [])
            found[case - start, swapped] = b[swapped]
        return found


def swaps_of(campaign: CampaignParams, columns: Sequence[str]) -> Swaps | None:
    """The design of a campaign that asks for one; ``columns`` of the results, one for each unit number."""
    if campaign.sampling != "sobol_indices":
        return None
    section = campaign.model_dump(include={*get_args(Of), "correlated"})
    groups: dict[str, list[int]] = {}
    for number, column in enumerate(columns):
        groups.setdefault(group_of(column, section), []).append(number)
    return Swaps(groups | ({PROFILES: []} if campaign.profiles else {}), campaign.cases, campaign.seed)
