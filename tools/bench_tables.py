"""What bench.py found, as tables."""

from __future__ import annotations

import statistics
from typing import Any

from bench_processes import Lap
from rich.console import Console
from rich.table import Table

#: Budgets of the design: seconds, MiB.
BUDGETS = {
    "first flight ever": 60.0,
    "fly, all files": 4.0,
    "--help": 0.3,
    "peak memory": 400e6 / 2**20,
    "compiled loop": 0.25,
}


def spread(values: list[float], digits: int = 3, scale: float = 1.0) -> str:
    """``median (min .. max)``."""
    low, middle, high = (
        f"{x * scale:,.{digits}f}" for x in (min(values), statistics.median(values), max(values))
    )
    return f"{middle} ({low} .. {high})"


def show_laps(console: Console, title: str, laps: dict[str, list[Lap]]) -> None:
    """Table of laps; seconds are wall seconds for processes, and CPU seconds stand beside them."""
    table = Table(title=title, title_justify="left")
    for name in ("", "n", "wall s: median (min .. max)", "CPU s", "steps/CPU s", "peak MiB", "budget"):
        table.add_column(name, justify="left" if not name else "right")
    for name, runs in laps.items():
        rates = f"{statistics.median(r.rate for r in runs):,.0f}" if runs[0].steps else ""
        peak = f"{max(r.peak_mib for r in runs):.0f}" if runs[0].peak_mib else ""
        limits = [f"{BUDGETS[name]:g} s"] if name in BUDGETS else []
        limits += [f"{BUDGETS['peak memory']:.0f} MiB"] if name == "fly, all files" else []
        cpu = f"{statistics.median(r.cpu_s for r in runs):.3f}"
        table.add_row(
            name, str(len(runs)), spread([r.wall_s for r in runs]), cpu, rates, peak, ", ".join(limits)
        )
    console.print(table)


def show_comparison(console: Console, peer: str, result: dict[str, Any]) -> None:
    """Rates of the peer and of ours, and the ratio ours / theirs of each round."""
    laps = result["laps"]
    table = Table(title=f"{peer} {result['version']}: {result['case']}", title_justify="left")
    for name in (
        "",
        "n",
        "steps",
        "thousand steps/CPU s",
        "ours/theirs, CPU",
        "ours/theirs, wall",
        "force evaluations, CPU",
    ):
        table.add_column(name, justify="left" if not name else "right")
    for name, runs in laps.items():
        row = [name, str(len(runs)), f"{runs[0].steps:,}", spread([r.rate for r in runs], 0, 1e-3)]
        if name != peer:
            pairs = list(zip(runs, laps[peer], strict=True))
            ratios = [ours.rate / theirs.rate for ours, theirs in pairs]
            walls = [(ours.steps / ours.wall_s) / (theirs.steps / theirs.wall_s) for ours, theirs in pairs]
            row += [
                spread(ratios, 2),
                spread(walls, 2),
                f"{statistics.median(ratios) * result['evaluations_ratio']:.2f}",
            ]
        table.add_row(*row)
    console.print(table)
    console.print(
        f"  {peer} has {result['has']}\n  and lacks {result['lacks']}; ended finite at "
        f"{_numbers(result['ended'])}"
    )


def show_phases(console: Console, phases: list[dict[str, Any]]) -> None:
    """Nanoseconds a step by mission phase."""
    table = Table(title="Compiled loop by mission phase", title_justify="left")
    for name in ("phase", "flown s", "ns/step, CPU: median (min .. max)", "share"):
        table.add_column(name, justify="left" if name == "phase" else "right")
    for row in phases:
        table.add_row(
            row["phase"], f"{row['flown_s']:.1f}", spread(row["ns_per_step"], 0), f"{row['share']:.0%}"
        )
    console.print(table)


def _numbers(values: dict[str, float]) -> str:
    return ", ".join(f"{name} {value:.1f}" for name, value in values.items())
