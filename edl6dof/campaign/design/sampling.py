"""Numbers in 0..1 for every case and dispersed quantity.

Each is a function of (seed, sampling plan, quantity, case) alone, so cases are the same in any order and
after any break.  Random and Latin-hypercube numbers of a quantity depend on its name and not on its
neighbours: a campaign with one dispersion more draws the same values for the others, which makes comparisons
on common random numbers.
"""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from edl6dof.spatial.stream import Stream

#: Third number of the seed of every generator here; 1 and 2 are the random profiles of
#: ``edl6dof.environment.profiles``.
_STREAM = 3

#: Random numbers are drawn for this many cases at a time.
_BLOCK = 1024


def unit_numbers(
    sampling: str, seed: int, names: Sequence[str], cases: int, first: int, last: int
) -> np.ndarray:
    """Unit numbers of cases ``first .. last - 1`` of ``cases``, shape (last - first, names)."""
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
    """A Latin hypercube is made whole, 8 bytes for each case and quantity; its columns are independent of
    each other.
    """
    numbers = _generator(seed, name)
    stratum = np.argsort(numbers.uniform(cases), kind="stable")
    return (stratum + numbers.uniform(cases)) / cases


def _random(seed: int, name: str, first: int, last: int) -> np.ndarray:
    start = first // _BLOCK
    blocks = [
        _generator(seed, name, block).uniform(_BLOCK) for block in range(start, (last - 1) // _BLOCK + 1)
    ]
    return np.concatenate(blocks)[first - start * _BLOCK : last - start * _BLOCK]


def sobol_numbers(seed: int, dimensions: int, first: int, last: int) -> np.ndarray:
    """Rows ``first .. last - 1`` of a scrambled Sobol sequence, shape (last - first, dimensions)."""
    from scipy.stats import qmc  # here: no other sampling needs it

    engine = qmc.Sobol(dimensions, scramble=True, rng=np.random.default_rng((seed, _STREAM)))
    if first:
        engine.fast_forward(first)
        return engine.random(last - first)
    # one point alone: scipy warns of a first draw that is no power of two, which a campaign of any length is
    start = engine.random(1)
    return np.concatenate([start, engine.random(last - 1)]) if last > 1 else start
