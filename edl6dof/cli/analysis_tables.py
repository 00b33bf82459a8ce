"""Covariance of an event and margins of attitude control, on standard output and in files."""

from __future__ import annotations

import csv
from collections.abc import Iterator, Sequence
from dataclasses import astuple, fields
from math import isinf, isnan
from pathlib import Path
from textwrap import wrap

import numpy as np
from rich.console import Console
from rich.table import Table

from edl6dof.campaign.covariance_estimate import Alone, Covariance, Sampled, Spread, along_axes
from edl6dof.campaign.covariance_flights import EventFigures
from edl6dof.campaign.margins import AxisMargins
from edl6dof.config.wording import counted
from edl6dof.metrics.figures import figure_of_merit
from edl6dof.report.document import significant
from edl6dof.report.terminal import open_table, print_whole

#: Figures in a row of the budget on a terminal, letters in a line of their headings, and of a figure's name.
_COLUMNS, _HEADING, _LABEL = 4, 12, 32
_AXES = ("long half axis", "short half axis")
#: Number of standard errors from which a source is significant.
_CLEAR = 3.0


def show_covariance(
    name: str, event: str, found: Covariance, sampled: np.ndarray | None, took_s: float
) -> None:
    """Print the spread of every figure, also that of a campaign's flights if given, and the budget."""
    console = Console(highlight=False, soft_wrap=True)
    flights = 2 * len(found.pairs.odd) + len(found.pairs.changes)
    console.print(f"{name}, {event}: {counted(flights, 'flight')} in {took_s:.1f} s", style="bold")
    print_whole(_spreads(found, sampled))
    if sampled is not None:
        share = len(sampled) / flights
        console.print(f"campaign: {counted(len(sampled), 'flight')}, {share:.1f} times as many")
    if found.event.position:
        along, towards = (figure_of_merit(name).meaning for name in found.event.position)
        degrees = np.degrees(np.arctan2(found.axes[1, 0], found.axes[0, 0])) % 180.0
        print(f"long axis {degrees:.0f} deg from '{along}' to '{towards}'")
    print_whole(_budget(found))
    if found.together:
        names = ", ".join(source.name for source in found.together)
        print(f"not significant: {names}")


def _spreads(found: Covariance, sampled: np.ndarray | None) -> Table:
    beside = () if sampled is None else ("campaign>", "+->", "its middle 68 %>", "difference>")
    table = open_table("", "figure", "unit", "mean>", "1 sigma>", "+->", "linear>", *beside)
    for label, unit, spread, own in _rows(found, sampled):
        cells = [
            "" if label in _AXES else significant(spread.mean[0]),
            significant(spread.deviation[0]),
            significant(spread.error[0], 2),
            f"{100.0 * (spread.linear[0] / spread.deviation[0]) ** 2:.0f} %",
        ]
        if own is not None:
            cells += [
                significant(own.deviation[0]),
                significant(own.error[0], 2),
                significant(own.core[0]),
                f"{100.0 * (spread.deviation[0] / own.deviation[0] - 1.0):+.1f} %",
            ]
        table.add_row("\n".join(wrap(label, _LABEL)), unit, *cells)
    return table


def _rows(found: Covariance, sampled: np.ndarray | None) -> Iterator[tuple[str, str, Spread, Sampled | None]]:
    """Label, unit, predicted spread and sampled spread (or ``None``) of each half axis and of each figure."""
    event = found.event
    if size := len(event.position):
        own = along_axes(sampled, size) if sampled is not None else None
        unit = figure_of_merit(event.position[0]).unit.label
        for k, label in enumerate(_AXES):
            spread = found.pairs.spread(found.axes[:, k : k + 1])
            yield label, unit, spread, None if own is None else Sampled.of(own[:, k : k + 1])
    for k, name in enumerate(event.all):
        figure = figure_of_merit(name)
        spread = found.pairs.spread(np.eye(len(event.all))[:, k : k + 1])
        beside = None if sampled is None else Sampled.of(sampled[:, k : k + 1])
        yield figure.meaning, figure.unit.label, spread, beside


def _budget(found: Covariance) -> Table:
    """Return the sources in the order of their share in the position, or in all figures without one."""
    names = found.event.all[:_COLUMNS]
    table = _table("1 sigma of each source", names)
    floor = _CLEAR * found.pairs.slope_error[: len(names)]
    hidden = 0
    for source, values in found.contributions:
        shown = np.abs(values[: len(names)]) >= floor
        if not shown.any():
            hidden += 1
            continue
        cells = [significant(v, 3) if clear else "-" for v, clear in zip(values, shown, strict=False)]
        table.add_row(source, *cells)
    for name, values in _totals(found):
        table.add_row(name, *(significant(v, 3) for v in values[: len(names)]))
    more = f"{counted(hidden, 'more source')}, '-' in every column"
    table.caption = f"-: less than {_CLEAR:g} standard errors; not listed: {more}"
    return table


def _totals(found: Covariance) -> list[tuple[str, np.ndarray]]:
    """Standard deviations by everything but the separated sources, and by everything, shape (figures,)."""
    random = [("random profiles and noise", np.sqrt(found.pairs.random))] if len(found.pairs.changes) else []
    return [*random, ("rest: second order, lists", found.rest), ("all", found.spread.deviation)]


def show_alone(found: Alone, event: EventFigures) -> None:
    """Print slope and bend (first, second difference) of each source alone; marked if the bend is larger."""
    names = event.all[:_COLUMNS]
    table = _table("parameter", names)
    targets = [target for source in found.found for draw in source.draws for target in draw.targets]
    for target, slopes, bends in zip(targets, found.slopes, found.bends, strict=True):
        cells = [
            f"{significant(slope, 2)}, {significant(bend, 2)}{'*' if abs(bend) > abs(slope) else ' '}"
            for slope, bend in zip(slopes[: len(names)], bends[: len(names)], strict=True)
        ]
        table.add_row(target.path, *cells)
    print("each alone about one flight: slope, bend over 1 sigma (*: not linear)")
    print_whole(table)


def _table(first: str, names: Sequence[str]) -> Table:
    """An empty table with a column for each figure, under its meaning and unit, broken into lines."""
    headings = (f"{figure.meaning} ({figure.unit.label or '1'})" for figure in map(figure_of_merit, names))
    broken = ("\n".join(wrap(heading, _HEADING, break_long_words=False)) for heading in headings)
    return open_table("", first, *(f"{heading}>" for heading in broken), narrow=True)


def write_budget(found: Covariance, path: Path) -> None:
    """Write the error budget as CSV: rows for each source, the rest, the total, and their standard errors."""
    rows = [
        *found.contributions,
        *_totals(found),
        ("standard error of a source", found.pairs.slope_error),
        ("standard error of all", found.spread.error),
    ]
    with path.open("w", newline="", encoding="utf-8") as file:
        out = csv.writer(file)
        out.writerow(["source", *found.event.all])
        out.writerows([name, *(float(value) for value in values)] for name, values in rows)


#: Headings of the table of linear margins, and the note below it.
_LINEAR = (
    *("phase", "axis", "gain dB>", "less dB>", "phase deg>", "delay ms>", "disk>"),
    *("crossover rad/s>", "at s>"),
)
_NOTE = """\
gain, less: by how much it may grow and shrink; disk: gain by (1 + d/2) / (1 - d/2) and phase by 2 atan(d/2)
together; inf: any; * linearised beyond the deadband of the law"""


def show_margins(name: str, rows: Sequence[AxisMargins]) -> None:
    """Print the margins, the limit cycles of axes that rest, and measured margins."""
    loops, resting = [row for row in rows if not row.rests], [row for row in rows if row.rests]
    console = Console(highlight=False, soft_wrap=True)
    if loops:
        dispersed = any(row.vehicle is not None for row in loops)
        table = open_table(
            f"{name}: linear margins", *_LINEAR, *(["case>"] if dispersed else []), narrow=True
        )
        for row in loops:
            axis = f"{row.axis}{'*' if row.added_rate_deg_s > 0.0 else ''}"
            numbers = row.gain_db, row.gain_down_db, row.phase_deg, 1e3 * row.delay_s, row.disk
            cells = [_cell(value) for value in (*numbers, row.crossover_rad_s)]
            case = [str(row.vehicle)] if dispersed else []
            table.add_row(row.phase, axis, *cells, f"{row.at_s:.1f}", *case)
        print_whole(table)
        console.print(_NOTE, style="dim")
    if any(not isnan(row.flown_s) or not isnan(row.predicted_s) for row in resting):
        heads = ["phase", "axis", "predicted deg>", "flown deg>", "predicted s>", "flown s>"]
        table = open_table("limit cycles: amplitude and period", *heads, narrow=True)
        for row in resting:
            found = row.predicted_deg, row.flown_deg, row.predicted_s, row.flown_s
            table.add_row(row.phase, row.axis, *map(_cell, found))
        print_whole(table)
    if tried := {row.phase: row for row in rows if not isnan(row.measured_gain_db)}:
        heads = ["phase", "gain dB>", "linear>", "delay ms>", "linear>"]
        table = open_table("measured, all axes together", *heads, narrow=True)
        for phase, row in tried.items():
            delays = 1e3 * row.measured_delay_s, 1e3 * row.linear_delay_s
            table.add_row(phase, *map(_cell, (row.measured_gain_db, row.linear_gain_db, *delays)))
        print_whole(table)


def _cell(value: float) -> str:
    return "-" if isnan(value) else "inf" if isinf(value) else significant(value, 3)


def write_rows(rows: Sequence[AxisMargins], path: Path) -> None:
    """Write the rows as CSV, numbers with six digits; empty where there is none."""
    with path.open("w", newline="", encoding="utf-8") as file:
        out = csv.writer(file)
        out.writerow([field.name for field in fields(AxisMargins)])
        for row in rows:
            values = (significant(value, 6) if isinstance(value, float) else value for value in astuple(row))
            out.writerow(["" if value in (None, "nan") else value for value in values])
