"""Rows of flights: draws, columns, statistics, and the findings and tables that are made of them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from math import isinf, nan
from typing import Any, NamedTuple

import numpy as np

from edl6dof.campaign.ensemble import SampleMean
from edl6dof.campaign.executor import Row
from edl6dof.campaign.statistics import flights_needed, percent, quantile
from edl6dof.config.base import stated
from edl6dof.fsw.guidance.entry.drag_dynamics import drag_dynamics
from edl6dof.metrics.published import Published, published_figures
from edl6dof.report.document import significant
from edl6dof.sim.flight import Flight
from edl6dof.studies.frame import Finding, Grid


class Spread(NamedTuple):
    """Gaussian dispersion of the true value of one parameter, named by its dotted path."""

    path: str
    mean: float
    three_sigma: float


def draw(spreads: Sequence[Spread], runs: int, seed: int) -> list[dict[str, float]]:
    """True values of ``runs`` flights by path; a longer series begins with the flights of a shorter."""
    rows = np.random.default_rng(seed).standard_normal((runs, len(spreads))).tolist()
    drawn = (zip(spreads, row, strict=True) for row in rows)
    return [{s.path: s.mean + s.three_sigma / 3.0 * x for s, x in pairs} for pairs in drawn]


def pick(rows: Iterable[Row], **wanted: Any) -> list[Row]:
    """The rows whose columns have the ``wanted`` values."""
    return [row for row in rows if all(row.get(key) == value for key, value in wanted.items())]


def kinds(rows: Iterable[Row], label: str) -> list[str]:
    """The values of a label, in the order of the rows."""
    return list(dict.fromkeys(row[label] for row in rows))


def column(rows: Iterable[Row], name: str, missing: float = nan) -> np.ndarray:
    """Return a figure of each row, shape (rows,); ``missing`` for a flight without this figure."""
    return np.array([missing if row.get(name) is None else row[name] for row in rows], dtype=float)


def mean(rows: Iterable[Row], name: str) -> float:
    """Mean of a figure over the flights that have it."""
    found = column(rows, name)
    found = found[np.isfinite(found)]
    return float(np.mean(found)) if len(found) else nan


def rms(sample: np.ndarray) -> float:
    """Root of the mean square."""
    return float(np.sqrt(np.mean(sample**2)))


def percentage(kept: Iterable[bool]) -> float:
    """Share (%) of true values."""
    return 100.0 * float(np.mean(list(kept)))


def last_time(t: np.ndarray, holds: np.ndarray) -> float:
    """Last time at which a condition holds; the first time of all if the condition never holds."""
    rows = np.flatnonzero(holds)
    return float(t[rows[-1] if len(rows) else 0])


def drag_dynamics_of(flight: Flight, rows: Mapping[str, np.ndarray]) -> np.ndarray:
    """D' (m/s3), and a and b (m/s4) of D'' = b + a cos(bank), of a point mass as known on board, for rows of
    its telemetry; shape (rows, 3).
    """
    planet, drag = flight.scenario.planet, rows["nav.drag_m_s2"]
    lift = drag * flight.scenario.vehicle.aero.lift_drag.lift_to_drag
    scale_height = stated(flight.scenario.atmosphere.exponential).scale_height_m
    radius = planet.equatorial_radius_m + rows["truth.altitude_m"]
    gamma, gravity = np.radians(rows["truth.flight_path_angle_deg"]), planet.gravity.mu_m3_s2 / radius**2
    state = zip(drag, rows["truth.speed_m_s"], gamma, radius, gravity, lift, strict=True)
    return np.array([drag_dynamics(*values, scale_height) for values in state])


#: Quantiles of a table, where its flights can bound them.
SHARES = (0.5, 0.95, 0.99)


def quantile_grid(title: str, head: str, samples: Mapping[str, np.ndarray]) -> Grid:
    """A line for each sample, shape (flights,), infinite where a flight failed: number of flights, quantiles,
    and their bounds at 95 % confidence.  Quantiles that no sample bounds are named in the title.
    """
    flights = {name: int(np.sum(~np.isnan(sample))) for name, sample in samples.items()}
    most = max(flights.values(), default=0)
    bounded = [share for share in SHARES if flights_needed(share) <= most]
    heads = [words for share in map(percent, bounded) for words in (share, f"{share} from", f"{share} to")]
    others = (share for share in SHARES if share not in bounded)
    refused = ", ".join(f"{percent(share)} needs {flights_needed(share):,}" for share in others)
    too_small = f"; n = {most} too small: {refused}" if refused else ""
    rows = []
    for name, sample in samples.items():
        found = [quantile(sample, share, flown=True) for share in bounded]
        figures = [(nan, nan, nan) if one is None else (one.value, one.low, one.high) for one in found]
        rows.append((name, float(flights[name]), *sum(figures, ())))
    return Grid(f"{title}, bounds at 95 %{too_small}", (head, "n", *heads), tuple(rows))


def with_quantile(finding: Finding, sample: np.ndarray, share: float) -> Finding:
    """Put the quantile of ``sample`` into a finding, and its bounds into the note; a finding without number
    and result if the flights are too few to bound it.
    """
    note = f"{finding.note}, " if finding.note else ""
    found = quantile(sample, share, flown=True)
    if found is None:
        note += f"n = {len(sample)} too small: needs {flights_needed(share):,}"
        return replace(finding, computed=nan, published=None, bound="", note=note)
    low, high = ("fails" if isinf(end) else significant(end, 3) for end in (found.low, found.high))
    return replace(finding, computed=found.value, note=f"{note}{low} .. {high} at 95 %")


def beside_published(
    published: Published, means: Mapping[str, SampleMean], notes: Mapping[str, str] | None = None
) -> Iterator[Finding]:
    """Mean and spread of every published figure, or of those with ``notes``, and the published value."""
    for figure, entry in published_figures(published):
        if notes is None or figure.name in notes:
            own, note = means.get(figure.name, SampleMean(nan, nan, 0)), (notes or {}).get(figure.name, "")
            about = (figure.meaning, figure.unit.label, entry.of(own.mean))
            yield Finding(*about, entry.number, entry.bound, note, own.deviation)
