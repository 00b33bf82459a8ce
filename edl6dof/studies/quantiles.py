"""Quantiles in the tables of studies: with the bounds that so many flights give them, or none at all."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from math import isinf, nan

import numpy as np

from edl6dof.campaign.quantiles import flights_needed, percent, quantile
from edl6dof.report.numbers import significant
from edl6dof.studies.study import Finding, Grid

#: Quantiles of a table, where its flights can bound them.
SHARES = (0.5, 0.95, 0.99)


def quantile_grid(title: str, head: str, samples: Mapping[str, np.ndarray]) -> Grid:
    """A row for each sample, shape (flights,), infinite where one failed: how many flights, quantiles, and
    beside each between which values it lies at 95 %.  Those that no sample bounds are named in the title.
    """
    flights = {name: int(np.sum(~np.isnan(sample))) for name, sample in samples.items()}
    most = max(flights.values(), default=0)
    told = [share for share in SHARES if flights_needed(share) <= most]
    heads = [words for share in map(percent, told) for words in (share, f"{share} from", f"{share} to")]
    refused = [f"{percent(share)} takes {flights_needed(share):,}" for share in SHARES if share not in told]
    too_small = f"; n = {most} too small: {', '.join(refused)}" if refused else ""
    rows: tuple[tuple[str | float, ...], ...] = tuple(
        (name, float(flights[name]), *(figure for share in told for figure in _bounded(sample, share)))
        for name, sample in samples.items()
    )
    return Grid(f"{title}, bounds at 95 %{too_small}", (head, "n", *heads), rows)


def _bounded(sample: np.ndarray, share: float) -> tuple[float, float, float]:
    found = quantile(sample, share, flown=True)
    return (nan, nan, nan) if found is None else (found.value, found.low, found.high)


def with_quantile(finding: Finding, sample: np.ndarray, share: float) -> Finding:
    """A finding of which ``sample`` has the quantile, its bounds in the note; without number and result
    where the flights are too few to bound it.
    """
    found = quantile(sample, share, flown=True)
    if found is None:
        small = f"n = {len(sample)} too small: takes {flights_needed(share):,}"
        return replace(finding, computed=nan, published=None, bound="", note=_joined(finding.note, small))
    low, high = ("fails" if isinf(end) else significant(end, 3) for end in (found.low, found.high))
    return replace(finding, computed=found.value, note=_joined(finding.note, f"{low} .. {high} at 95 %"))


def _joined(note: str, more: str) -> str:
    return f"{note}, {more}" if note else more
