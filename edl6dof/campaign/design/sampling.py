"""Numbers in 0..1 for every case and dispersed quantity, and the design of flights behind Sobol indices.

Each number is a function of (seed, sampling plan, quantity, case) alone, so cases are the same in any order
and after any interruption.  Random and Latin-hypercube numbers of a quantity depend on its name and not on
its neighbours: a campaign with one dispersion more draws the same values for the others, which makes
comparisons on common random numbers.
"""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import get_args

import numpy as np

from edl6dof.campaign.design.case import A, B, Of, group_of
from edl6dof.campaign.design.sections import CampaignParams
from edl6dof.spatial.random_numbers import Stream

#: Third number of the seed of every generator here; the random profiles have 1 and 2.
_STREAM = 3
#: Random numbers are drawn for this many cases at a time.
_BLOCK = 1024


def unit_numbers(
    sampling: str, seed: int, names: Sequence[str], cases: int, first: int, last: int
) -> np.ndarray:
    """Numbers in 0..1 of cases ``first .. last - 1`` out of ``cases``, shape (last - first, names)."""
    if not names or last <= first:
        return np.zeros((max(last - first, 0), len(names)))
    if sampling == "sobol":
        return sobol_numbers(seed, len(names), first, last)
    if sampling == "latin_hypercube":
        columns = [_stratified(seed, name, cases)[first:last] for name in names]
    else:
        columns = [_random(seed, name, first, last) for name in names]
    return np.stack(columns, axis=1)


def _generator(seed: int, name: str, block: int = 0) -> Stream:
    key = int.from_bytes(hashlib.sha256(name.encode()).digest()[:8], "little")
    return Stream(seed, block, _STREAM, key)


@lru_cache(maxsize=1024)
def _stratified(seed: int, name: str, cases: int) -> np.ndarray:
    """Make the column of a quantity of a Latin hypercube for all cases; columns are independent."""
    numbers = _generator(seed, name)
    stratum = np.argsort(numbers.uniform(cases), kind="stable")
    return (stratum + numbers.uniform(cases)) / cases


def _random(seed: int, name: str, first: int, last: int) -> np.ndarray:
    start, end = first // _BLOCK, (last - 1) // _BLOCK + 1
    blocks = [_generator(seed, name, block).uniform(_BLOCK) for block in range(start, end)]
    return np.concatenate(blocks)[first - start * _BLOCK : last - start * _BLOCK]


def sobol_numbers(seed: int, dimensions: int, first: int, last: int) -> np.ndarray:
    """Rows ``first .. last - 1`` of a scrambled Sobol sequence, shape (last - first, dimensions)."""
    from scipy.stats import qmc  # here: no other sampling needs it

    engine = qmc.Sobol(dimensions, scramble=True, rng=np.random.default_rng((seed, _STREAM)))
    if first:
        engine.fast_forward(first)
        return engine.random(last - first)
    # one point alone: scipy warns of a first draw whose length is no power of two
    start = engine.random(1)
    return np.concatenate([start, engine.random(last - 1)]) if last > 1 else start


#: Name of the random profiles (density, gusts), which are a group of their own.
PROFILES = "random profiles"


@dataclass(frozen=True)
class SaltelliDesign:
    """The design for Sobol indices: two matrices A and B of numbers from 0 to 1, and for each group of inputs
    a copy of A whose columns of that group are taken from B. Cases are numbered row by row.

    Source: Saltelli et al., Comput. Phys. Commun. 181 (2010) 259; groups: Saltelli et al., Global Sensitivity
    Analysis: The Primer (2008), 4.6.

    Attributes:
        groups: columns of each group by its name; an empty list for the random profiles.
        rows: number of rows of each matrix.
        seed: seed of the Sobol sequence.
    """

    groups: dict[str, list[int]]
    rows: int
    seed: int

    @property
    def width(self) -> int:
        """Number of cases in each row of the design."""
        return len(self.groups) + 2

    def matrix(self, case: int) -> str:
        """Return the matrix of a case (A or B), or the group whose columns it takes from B."""
        return (A, B, *self.groups)[case % self.width]

    def profile(self, case: int) -> int:
        """Number of the random profiles of a case: first those of matrix A, then those of matrix B."""
        return case // self.width + self.rows * (self.matrix(case) in (B, PROFILES))

    def unit_numbers(self, start: int, stop: int) -> np.ndarray:
        """Numbers in 0..1 of cases ``start .. stop - 1``, shape (stop - start, columns)."""
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


def saltelli_design(campaign: CampaignParams, columns: Sequence[str]) -> SaltelliDesign | None:
    """The design of a campaign that asks for Sobol indices, else ``None``; ``columns``: columns of the
    results, one for each dispersed quantity.
    """
    if campaign.sampling != "sobol_indices":
        return None
    section = campaign.model_dump(include={*get_args(Of), "correlated"})
    groups: dict[str, list[int]] = {}
    for number, column in enumerate(columns):
        groups.setdefault(group_of(column, section), []).append(number)
    return SaltelliDesign(
        groups | ({PROFILES: []} if campaign.profiles else {}), campaign.cases, campaign.seed
    )
