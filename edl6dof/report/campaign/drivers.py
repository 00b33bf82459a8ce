"""What drives what: the dispersed quantities that can be told to move a figure, with their shares."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from edl6dof.campaign.drivers import CHANCE, FEWEST, Drivers, drivers
from edl6dof.metrics.figures import FigureOfMerit, figure_of_merit
from edl6dof.report.campaign.results import Results
from edl6dof.report.document import Block, Cell, Row, Table, Text
from edl6dof.report.figure import Axis, Figure, Heat, Panel

#: Figures to explain; those with limits come first by themselves.
_FIGURES = (
    *("landing_east_m", "landing_north_m", "landing_distance_m"),
    *("parachute_height_m", "propellant_used_kg", "touchdown_s"),
)


@dataclass(frozen=True)
class Told:
    """A figure and what is told of it."""

    figure: FigureOfMerit
    drivers: Drivers


def blocks(results: Results) -> Iterator[Block]:
    """A map of who drives what, and the shares with their intervals."""
    if not results.groups:
        return
    if len(results.cases) < FEWEST:
        yield Text(f"Cannot be told with fewer than {FEWEST} flights.")
        return
    told = list(_told(results))
    yield Text(
        "Share: how much of the variance of a figure's ranks an input explains, in its 95 % interval. Inputs "
        "that are drawn together (*) count as one. An input is named where chance alone would name none in "
        f"{1.0 - CHANCE:.0%} of campaigns, all figures together. What remains is the work of the random "
        "profiles of density and gusts, of inputs whose share is too small to be told, and of what only "
        "several inputs together do."
    )
    if any(one.drivers.found for one in told):
        yield chart([one for one in told if one.drivers.found])
    yield Table(["figure", "input", "share>", "95 % interval>", "effect"], list(_rows(told)))


def _told(results: Results) -> Iterator[Told]:
    names = dict.fromkeys([*(name for name, *_ in results.limits), *_FIGURES])
    moving = {name: results[name] for name in names if results.has(name) and _moves(results[name])}
    for name, values in moving.items():
        level = -np.expm1(np.log1p(-CHANCE) / len(moving))  # Sidak: for each figure
        yield Told(figure_of_merit(name), drivers(results.groups, values, level))


def _moves(values: np.ndarray) -> bool:
    finite = values[np.isfinite(values)]
    return bool(len(finite)) and float(np.ptp(finite)) > 0.0


def _rows(told: list[Told]) -> Iterator[Row]:
    for one in told:
        found, label = one.drivers.found, one.figure.meaning
        for k, driver in enumerate(found):
            interval = f"{driver.low:.0%} .. {driver.high:.0%}"
            share = Cell(f"{driver.share:.0%}", bar=driver.share)
            yield [label if k == 0 else "", driver.name, share, interval, driver.effect]
        least = f"shares below {one.drivers.least:.0%} cannot be told with {one.drivers.flights} flights"
        remains = max(1.0 - one.drivers.explained, 0.0)
        words = f"remains; {least}" if found else f"none: {least}"
        yield ["" if found else label, words, f"{remains:.0%}", "", ""]


def chart(told: list[Told]) -> Figure:
    """Shares as a map, the inputs that drive most on top."""
    columns = [{driver.name: driver.share for driver in one.drivers.found} for one in told]
    names = sorted(set().union(*columns), key=lambda name: sum(column.get(name, 0.0) for column in columns))
    shares = np.array([[column.get(name, np.nan) for column in columns] for name in names])
    heat = Heat(
        np.arange(float(len(told))),
        np.arange(float(len(names))),
        100.0 * shares,
        "share of the variance (%)",
        0.0,
        100.0,
        labels=[["" if np.isnan(share) else f"{share:.0%}" for share in line] for line in shares],
        written=True,
    )
    panel = Panel(
        Axis("", names=[one.figure.meaning for one in told]),
        Axis("", names=[name.removeprefix("vehicle.") for name in names]),
        heat=heat,
    )
    caption = (
        "Of each figure, below, what share of its variance an input explains; empty: not told from chance."
    )
    return Figure("drivers", "What drives what", [panel], caption, height=120 + 26 * len(names))
