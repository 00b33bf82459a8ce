"""Print the comparison of entry laws as Markdown: ``python tools/entry_laws.py FOLDER``.

FOLDER is that of ``edl6dof study guidance --out FOLDER``.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Sequence
from math import isfinite
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq

from edl6dof.campaign.executor import Row
from edl6dof.campaign.statistics import flights_needed, quantile
from edl6dof.studies.guidance import CONDITIONS, DISPERSED, best_first, bias, misses, not_exceeded
from edl6dof.studies.samples import column, kinds, mean, percentage, pick

#: Column of a table: its heading, and its cell of the flights of one law.
Columns = dict[str, Callable[[list[Row]], str]]


def figures(entries: int) -> Columns:
    """Figures of the entries as dispersed, with bounds at 95 % confidence in brackets; the largest miss and
    the lowest altitude where the entries are too few to bound 99 %.
    """
    miss: Columns = {"99 %": lambda rows: bounded(misses(rows), 0.99), "altitude, 1 %, km": lowest}
    if entries < flights_needed(0.99):
        miss = {
            "largest": lambda rows: number(float(misses(rows).max()), 2),
            "lowest altitude, km": lambda rows: number(float(altitude(rows).min()), 1),
        }
    return {
        "bias, km": lambda rows: f"{bias(rows):+.2f}",
        "50 %, km": lambda rows: bounded(misses(rows), 0.5),
        "95 %, km": lambda rows: bounded(misses(rows), 0.95),
        **miss,
        "in the box, %": lambda rows: f"{percentage(row['success'] for row in rows):.0f}",
        "travel, deg": lambda rows: f"{mean(rows, 'extra_travel_deg'):.0f}",
        "propellant, kg": lambda rows: number(mean(rows, "extra_propellant_kg"), 1),
    }


def altitude(rows: Sequence[Row]) -> np.ndarray:
    """Altitude at mortar fire, km."""
    return column(rows, "parachute_altitude_m") / 1e3


def lowest(rows: Sequence[Row]) -> str:
    """Altitude that 99 % of the entries exceed, with bounds."""
    return bounded(-altitude(rows), 0.99, -1.0)


def main(folder: Path) -> None:
    """Print a section for each vehicle."""
    rows = [
        row for row in pq.read_table(folder / "runs.parquet").to_pylist() if row["condition"] in CONDITIONS
    ]
    grids = json.loads((folder / "summary.json").read_text(encoding="utf-8"))["grids"]
    for vehicle in kinds(rows, "vehicle"):
        own = pick(rows, vehicle=vehicle)
        costs = [grid["rows"] for grid in grids if grid["title"].startswith(f"{vehicle}: mean of")]
        section(vehicle, own, {row["law"]: f"{row['call us']:.1f}" for row in costs[0]})


def section(vehicle: str, rows: Sequence[Row], calls: dict[str, str]) -> None:
    """Print the tables of a vehicle; ``calls``: time of a call of each law."""
    dispersed, others = pick(rows, condition=DISPERSED), [name for name in CONDITIONS if name != DISPERSED]
    many, again = flights(rows, DISPERSED), flights(rows, others[0])
    laws = best_first(dispersed)
    print(f"\n## {vehicle}\n\nAs dispersed, {many} entries of each law:\n")

    def call(rows: list[Row]) -> str:
        return calls[rows[0]["law"]]

    table({law: pick(dispersed, law=law) for law in laws}, {**figures(many), "call, us": call})
    print(f"\nMiss of 95 % and bias (km) under each condition, {again} entries of each law:\n")
    table({law: pick(rows, law=law) for law in laws}, {name: under(name) for name in others})


def flights(rows: Sequence[Row], condition: str) -> int:
    """Number of entries of each law under a condition."""
    return len(pick(rows, condition=condition)) // len(kinds(rows, "law"))


def under(condition: str) -> Callable[[list[Row]], str]:
    """Cell of a condition: the miss that 95 % do not exceed, and the bias (km)."""

    def cell(rows: list[Row]) -> str:
        own = pick(rows, condition=condition)
        return f"{number(not_exceeded(own, 0.95), 1)}; {bias(own):+.1f}"

    return cell


def table(laws: dict[str, list[Row]], columns: Columns) -> None:
    """Print a row for each law."""
    print("| law | " + " | ".join(columns) + " |")
    print("|---" + "|---:" * len(columns) + "|")
    for law, rows in laws.items():
        print(f"| `{law}` | " + " | ".join(cell(rows) for cell in columns.values()) + " |")


def bounded(sample: np.ndarray, share: float, sign: float = 1.0) -> str:
    """A quantile of a sample, times a sign, and its bounds, as far as the flights are enough for them."""
    found = quantile(sample, share, flown=True)
    if found is None:
        return "too few"
    low, high = sorted((sign * found.low, sign * found.high))
    return f"{number(sign * found.value, 2)} ({number(low, 2)} to {number(high, 2)})"


def number(value: float, digits: int) -> str:
    """Text of a number; of an infinite one 'fails', of none '-'."""
    return f"{value:.{digits}f}" if isfinite(value) else "fails" if value == np.inf else "-"


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(Path(sys.argv[1]))
