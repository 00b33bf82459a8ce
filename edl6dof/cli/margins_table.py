"""Margins of attitude control on standard output and in a file."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from dataclasses import astuple, fields
from math import isinf, isnan
from pathlib import Path

from rich.console import Console

from edl6dof.campaign.margins import AxisMargins
from edl6dof.report.document import significant
from edl6dof.report.terminal import open_table, print_whole

_LINEAR = (
    "phase",
    "axis",
    "gain dB>",
    "less dB>",
    "phase deg>",
    "delay ms>",
    "disk>",
    "crossover rad/s>",
    "at s>",
)
_NOTE = """\
gain, less: by how much it may grow and shrink; disk: gain by (1 + d/2) / (1 - d/2) and phase by 2 atan(d/2)
together; inf: any; * linearised beyond the deadband of the law"""


def show(name: str, rows: Sequence[AxisMargins]) -> None:
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
