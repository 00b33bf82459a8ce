"""One figure that compares all laws: fuel, miss, tilt, and what a divert costs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import inf

import numpy as np

from edl6dof.campaign.rows import Row
from edl6dof.report.figure import Axis, Figure, Panel, Trace
from edl6dof.studies import plots
from edl6dof.studies.landing.conditions import DIVERTS, divert
from edl6dof.studies.landing.tables import MISS_M, laws, mean, of, values

#: Miss (m) at which the axis of misses ends.
_WORST_M = 1000.0


def drawings(rows: Sequence[Row]) -> Iterator[Figure]:
    """The comparison."""
    panels = [
        _shares(rows, "hover_fuel_kg", "propellant from ignition to hover (kg)", "fuel"),
        _misses(rows),
        _shares(rows, "peak_tilt_deg", "largest tilt (deg)", "tilt of the thrust axis"),
        _diverts(rows),
    ]
    yield Figure("comparison", "", panels, columns=2, height=360)


def _shares(rows: Sequence[Row], name: str, label: str, title: str) -> Panel:
    traces = [_share(values(of(rows, law), name, inf), law) for law in laws(rows)]
    return plots.panel(title, label, "flights within (%)", traces)


def _share(sample: np.ndarray, name: str) -> Trace:
    """Share of flights that a figure is not above; those without it are missing at the top."""
    ordered = np.sort(sample)
    share = np.arange(1, len(sample) + 1) / len(sample) * 100.0
    known = np.isfinite(ordered)
    return plots.curve(ordered[known], share[known], name)


def _misses(rows: Sequence[Row]) -> Panel:
    traces = [_share(values(of(rows, law), "target_miss_m", inf), law) for law in laws(rows)]
    traces.append(plots.reference(np.array([MISS_M, MISS_M]), np.array([0.0, 100.0]), f"{MISS_M:g} m"))
    return Panel(
        Axis("distance from the target where hover begins (m)", (0.01, _WORST_M), log=True),
        Axis("flights within (%)"),
        traces,
        title="miss",
    )


def _diverts(rows: Sequence[Row]) -> Panel:
    traces = [
        plots.curve(
            np.array(DIVERTS),
            np.array([mean(of(rows, law, divert(m)), "hover_fuel_kg") for m in DIVERTS]),
            law,
        )
        for law in laws(rows)
    ]
    return plots.panel("cost of a divert", "divert (m)", "propellant to hover (kg)", traces)
