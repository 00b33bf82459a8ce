"""One figure: rocks under the lander by abundance, the largest of them, touchdowns from their spots, and the
way past backshell and canopy.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from edl6dof.campaign.rows import Row
from edl6dof.report.figure import Figure, Panel, Trace
from edl6dof.studies import plots
from edl6dof.studies.hazards.conditions import ABUNDANCES, BLIND, blind_share
from edl6dof.studies.hazards.tables import AT, CLEAR_M, SPOT_M, of, on_a_rock, values, ways


def drawings(rows: Sequence[Row]) -> Iterator[Figure]:
    """The comparison."""
    panels = [
        _abundances(rows),
        _shares(rows, "largest_rock_m", "diameter (m)", "largest rock under the lander", None),
        _shares(rows, "spot_miss_m", "distance (m)", "touchdown from the chosen spot", SPOT_M),
        _shares(rows, "min_drift_distance_m", "least distance (m)", "past backshell and canopy", CLEAR_M),
    ]
    yield Figure("comparison", "", panels, columns=2, height=360)


def _abundances(rows: Sequence[Row]) -> Panel:
    percent = 100.0 * np.array(ABUNDANCES)
    flown = [
        plots.curve(percent, np.array([on_a_rock(of(rows, k, way)) for k in ABUNDANCES]), way)
        for way in ways(rows)
    ]
    fine = np.linspace(ABUNDANCES[0], ABUNDANCES[-1], 60)
    known = plots.reference(
        100.0 * fine, 100.0 * np.array([blind_share(k) for k in fine]), f"{BLIND}: expected"
    )
    return plots.panel("landings on a rock >= 0.5 m", "rocks, % of the ground", "%", (*flown, known))


def _shares(rows: Sequence[Row], name: str, label: str, title: str, bound: float | None) -> Panel:
    traces = [_share(values(of(rows, AT, way), name), way) for way in ways(rows)]
    if bound is not None:
        traces.append(plots.reference(np.array([bound, bound]), np.array([0.0, 100.0]), f"{bound:g} m"))
    return plots.panel(f"{title}, {100.0 * AT:g} % rocks", label, "flights within (%)", traces)


def _share(sample: np.ndarray, name: str) -> Trace:
    """Share of the flights that have a figure which it is not above."""
    known = np.sort(sample[np.isfinite(sample)])
    return plots.curve(known, np.arange(1, len(known) + 1) / max(len(known), 1) * 100.0, name)
