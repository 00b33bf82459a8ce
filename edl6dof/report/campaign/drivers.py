"""Sensitivities: the dispersed inputs that significantly move a figure, with their shares of its variance."""

from __future__ import annotations

from collections.abc import Iterator
from textwrap import fill

import numpy as np

from edl6dof.campaign.row_columns import A, B
from edl6dof.campaign.sensitivity import CHANCE, FEWEST, Drivers, drivers, sobol_indices
from edl6dof.metrics.figures import FigureOfMerit, figure_of_merit
from edl6dof.report.campaign.campaign_results import Results
from edl6dof.report.document import Block, Cell, Row, Table, Text, in_percent
from edl6dof.report.figure import Axis, Band, Figure, Panel, legend_entry
from edl6dof.report.palette import GREY, SERIES

#: Figures to explain after those with limits, which are always explained.
_FIGURES = (
    *("landing_east_m", "landing_north_m", "landing_distance_m"),
    *("parachute_height_m", "propellant_used_kg", "touchdown_s"),
)
#: Indent of an input in a row below its figure.
_INDENT = "\u2003"
#: Inputs of each figure whose Sobol indices are shown.
_SHOWN = 5
#: Widest interval of a total index at which the indices of a figure still mean something.
_WIDEST = 1.0
#: Most letters in a line of a figure's name next to the bars.
_LETTERS = 24
#: Figures and their drivers.
Explained = list[tuple[FigureOfMerit, Drivers]]


def blocks(results: Results) -> Iterator[Block]:
    """Show which inputs drive each figure, and their shares of its variance with intervals."""
    if not (results.groups and results.is_sample):
        return
    if len(results.cases) < FEWEST:
        yield Text(f"Needs at least {FEWEST} flights.")
        return
    moving = {name: results[name] for name in _figures(results)}
    found = drivers(results.groups, list(moving.values()))
    explained = list(zip(map(figure_of_merit, moving), found, strict=True))
    yield Text(
        "Share: part of the variance of a figure's ranks that an input explains, with its 95 % interval. "
        "Inputs drawn together (*) count as one. Only significant inputs are shown: without any effect, "
        f"{in_percent(1.0 - CHANCE)} of campaigns would show none in any figure. The rest comes from the "
        "random profiles of density and gusts, from inputs with a share that is not significant, and from "
        "interactions of inputs."
    )
    if driven := [(figure, own) for figure, own in explained if own.found]:
        yield chart(driven)
    heads = ["figure, and inputs that drive it", "share>", "95 % interval>", "effect"]
    yield Table(heads, list(_rows(explained)))


def indices(results: Results) -> Iterator[Block]:
    """Show Sobol indices of each figure, for a campaign that flew their design."""
    if not results.has_design:
        return
    rows: list[Row] = []
    for name in _figures(results):
        matrices = results.swapped(name)
        a, b = matrices.pop(A), matrices.pop(B)
        found = sobol_indices(a, b, matrices)[:_SHOWN]
        if any(high - low > _WIDEST for _, low, high in (index.total for index in found)):
            found = []
        words = "" if found else f": not significant with {len(a):,} rows"
        rows.append([figure_of_merit(name).meaning + words, *[""] * 4])
        rows += [[_INDENT + one.name, *_shares(one.first), *_shares(one.total)] for one in found]
    yield Text(
        "Sobol indices: the share of a figure's variance that goes when an input is known (alone), and that "
        f"stays when all others are known (in all), with 95 % intervals; the {_SHOWN} largest of each figure."
    )
    yield Table(["figure, and inputs", "alone>", "95 %>", "in all>", "95 %>"], rows)


def _shares(index: tuple[float, float, float]) -> tuple[Cell, str]:
    value, low, high = (min(max(bound, 0.0), 1.0) for bound in index)
    return Cell(in_percent(value), bar=value), _ends(low, high)


def _ends(low: float, high: float) -> str:
    return f"{100.0 * low:.0f} .. {in_percent(high)}"


def _figures(results: Results) -> list[str]:
    """Names of the figures to explain, without those that never change."""
    names = dict.fromkeys([*(figure.name for figure, _ in results.limits), *_FIGURES])
    values = {name: results[name] for name in names if results.has(name)}
    return [name for name, own in values.items() if len(set(own[np.isfinite(own)])) > 1]


def _rows(explained: Explained) -> Iterator[Row]:
    """Rows of the table: one for each figure, followed by one for each of its drivers."""
    for figure, own in explained:
        least, flights = in_percent(own.least), f"not significant with {own.flights:,} flights"
        remains = f"{in_percent(max(1.0 - own.explained, 0.0))} remains, shares below {least} {flights}"
        words = remains if own.found else f"{flights}, no share above {least}"
        yield [f"{figure.meaning}: {words}", "", "", ""]
        for driver in own.found:
            share = Cell(in_percent(driver.share), bar=driver.share)
            yield [_INDENT + driver.name, share, _ends(driver.low, driver.high), driver.effect]


def chart(explained: Explained) -> Figure:
    """Draw each figure's variance as a bar, divided into the shares of its drivers."""
    every = sorted((driver for _, own in explained for driver in own.found), key=lambda one: -one.share)
    ranked = list(dict.fromkeys(driver.name for driver in every))
    colours = dict(zip(ranked, SERIES, strict=False))
    bands = [band for row, (_, own) in enumerate(reversed(explained)) for band in _bar(own, row, colours)]
    legend = {name.removeprefix("vehicle."): colour for name, colour in colours.items()}
    legend |= {"others": GREY} if len(ranked) > len(colours) else {}
    traces = [legend_entry(name, colour, 1.6) for name, colour in legend.items()]
    names = [fill(figure.meaning, _LETTERS) for figure, _ in reversed(explained)]
    x = Axis("share of the variance (%)", range=(0.0, 100.0))
    panel = Panel(x, Axis("", names=names), traces, bands)
    caption = "What no colour covers is not significant. Figures without a driver are left out."
    height = 40 + 24 * len(legend) + 34 * len(explained)
    return Figure("drivers", "What drives what", [panel], caption, height=height)


def _bar(own: Drivers, row: int, colours: dict[str, str]) -> Iterator[Band]:
    start = 0.0
    for driver in own.found:
        end = min(start + 100.0 * driver.share, 100.0)
        yield Band(colours.get(driver.name, GREY), (start, end), (row - 0.36, row + 0.36), opacity=1.0)
        start = end
