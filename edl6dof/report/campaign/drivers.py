"""What drives what: the dispersed quantities ranked by their effect on each figure."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from edl6dof.campaign.statistics import Driver, drivers
from edl6dof.metrics.figures import figure_of_merit
from edl6dof.report.campaign.results import Results
from edl6dof.report.document import Block, Cell, Row, Table, Text
from edl6dof.report.figure import BLUE, ORANGE, Axis, Figure, Panel, Trace

#: Where a flight landed.
_LANDING = ("landing_east_m", "landing_north_m")
#: Figures to explain; those with limits come first by themselves.
_FIGURES = (*_LANDING, "parachute_height_m", "propellant_used_kg", "touchdown_s")

#: Rows of a ranking.
_SHOWN = 6


def blocks(results: Results) -> Iterator[Block]:
    """A ranking for each figure that varies, and the footprint's drivers as a figure."""
    if len(results.inputs) < 1 or len(results.cases) <= len(results.inputs) + 2:
        yield Text("Too few flights for a ranking: it needs more flights than dispersed quantities.")
        return
    yield Text(
        "Rank correlation (Spearman) finds every monotonic effect; a standardised regression coefficient b "
        "explains a share b² of the variance, which is the first-order Sobol index where the figure is "
        "linear in the inputs. R² is what all coefficients explain together; where it is low, the random "
        "profiles of density and gusts, or effects that are not linear, do the rest. By chance alone, "
        f"correlations reach {2.6 / np.sqrt(len(results.cases)):.2f} in one of a hundred."
    )
    for name in dict.fromkeys([*(name for name, *_ in results.limits), *_FIGURES]):
        if results.has(name):
            found, explained = drivers(results.inputs, results[name])
            if found:
                yield ranking(figure_of_merit(name).meaning, found, explained)
    yield from _chart(results)


def ranking(label: str, found: list[Driver], explained: float) -> Table:
    """The strongest drivers of one figure."""
    rows: list[Row] = [
        [
            driver.name,
            f"{driver.rank_correlation:+.2f}",
            f"{driver.regression:+.2f}",
            Cell(f"{driver.regression**2:.0%}", bar=driver.regression**2),
        ]
        for driver in found[:_SHOWN]
    ]
    return Table([f"{label} (R² = {explained:.2f})", "rank correlation>", "regression b>", "b²"], rows)


def _chart(results: Results) -> Iterator[Figure]:
    """Regression coefficients of the landing point, side by side."""
    ways = [figure_of_merit(name) for name in _LANDING if results.has(name)]
    found = {
        way.meaning: {d.name: d.regression for d in drivers(results.inputs, results[way.name])[0]}
        for way in ways
    }
    if len(found) < 2 or not all(found.values()):
        return
    names = sorted(
        set().union(*found.values()),
        key=lambda name: -max(abs(column.get(name, 0.0)) for column in found.values()),
    )[:10]
    at = np.arange(len(names), dtype=float)
    traces = [
        Trace(
            np.array([column.get(name, 0.0) for name in names]),
            at + shift,
            label,
            "points",
            colour,
            width=3.0,
        )
        for (label, column), colour, shift in zip(found.items(), (BLUE, ORANGE), (-0.1, 0.1), strict=True)
    ]
    panel = Panel(
        Axis("standardised regression coefficient", range=(-1.0, 1.0)), Axis("", names=names), traces
    )
    yield Figure(
        "drivers",
        "What moves the landing point",
        [panel],
        "Positive: a larger value moves it east or north.",
        height=380,
    )
