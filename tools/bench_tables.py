"""What bench.py found, as tables."""

from __future__ import annotations

import statistics
from typing import Any

from bench_boxes import Box
from bench_precision import LEVELS_M, WHOLE_STEP_S, Precision, speed_at
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
        f"  {peer} has {result['has']}\n  and lacks {result['lacks']}\n  state at its end: "
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


def show_boxes(console: Console, boxes: list[Box]) -> None:
    """Nanoseconds a cycle of flights with and without parts of the loop."""
    table = Table(title="Where the time of a cycle goes", title_justify="left")
    for name in ("", "ns/cycle, CPU: median (min .. max)", "telemetry"):
        table.add_column(name, justify="right" if name else "left")
    for box in boxes:
        table.add_row(box.name, spread(box.logged, 0), f"{box.medians[1]:,.0f}")
    console.print(table)


def _numbers(values: dict[str, float]) -> str:
    return ", ".join(f"{name} {value:.1f}" for name, value in values.items())


def show_precision(console: Console, precision: Precision) -> None:
    """Points of the work-precision diagram, and the programs at equal errors."""
    programs = precision.programs
    table = Table(title="Free entry of 250 s: speed and error", title_justify="left")
    for name in ("", "step ms", "simulated s per CPU s", "error of position m", "of attitude deg"):
        table.add_column(name, justify="left" if not name else "right")
    for name, points in programs.items():
        for point in points:
            table.add_row(
                name,
                f"{1e3 * point.step_s:g}",
                f"{point.speed:,.0f}",
                f"{point.position_m:.2g}",
                f"{point.attitude_deg:.2g}",
            )
        table.add_section()
    console.print(table)
    table = Table(title="The same at equal error of position", title_justify="left")
    for name in ("", *(f"{level:g} m" for level in LEVELS_M)):
        table.add_column(name, justify="left" if not name else "right")
    speeds = {name: [speed_at(points, level) for level in LEVELS_M] for name, points in programs.items()}
    for name, row in speeds.items():
        table.add_row(f"{name}, simulated s per CPU s", *(f"{x:,.0f}" if x else "not reached" for x in row))
    for name, row in speeds.items():
        if name != "edl6dof":
            ratios = [a / b if a and b else None for a, b in zip(speeds["edl6dof"], row, strict=True)]
            table.add_row(f"edl6dof / {name}", *(f"{x:.1f}" if x else "" for x in ratios))
    console.print(table)
    (error,) = (point.position_m for point in programs["edl6dof"] if point.step_s == WHOLE_STEP_S)
    console.print(
        f"Whole flight with instruments, step {1e3 * WHOLE_STEP_S:g} ms: "
        f"{precision.whole_flight:,.0f} simulated s per CPU s\n"
        f"  error of the free entry with the same step: {error:.2g} m"
    )
    for name, points in programs.items():
        if name != "edl6dof":
            least = max(error, points[0].position_m)  # the finest step that is shown may not reach it
            if theirs := speed_at(points, least):
                ratio = precision.whole_flight / theirs
                smallest = ", its smallest" if least > error else ""
                console.print(
                    f"  {ratio:.1f} times as fast as the entry of {name} with an error of {least:.2g} m"
                    f"{smallest}"
                )
