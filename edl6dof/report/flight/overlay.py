"""Two flights in one report: their figures, the differences of their scenarios, and the plots of one over
those of the other.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import cycle
from typing import Any, get_args

from edl6dof.config.document.yamltree import write_flow
from edl6dof.metrics.figures import figure_of_merit
from edl6dof.report.document import Cell, Report, Row, Section, Table, Text, decimals
from edl6dof.report.figure import Axis, Dash, Figure, Panel, Trace
from edl6dof.report.flight.flight_report import flight_report, headline, mood
from edl6dof.runs.files import distinct_names
from edl6dof.runs.run import Run
from edl6dof.vehicle.faults.fault import FAULT_KINDS

#: Brightness of the second flight's dashed curves, which lie over the first's full ones.
DARKER = 0.45


def comparison_report(first: Run, second: Run) -> Report:
    """Return the report of two runs."""
    names = labels(first, second)
    one, two = flight_report(first), flight_report(second)
    of_second = {figure.key: figure for figure in two.figures()}
    sections = [
        Section("outcomes", "Outcomes", [outcomes(first, second)]),
        Section("figures", "Figures", [figures_table(first, second)]),
        Section("events", "Events", [events_table(first, second)]),
        Section("differences", "Differences of the scenarios", [differences_table(first, second)]),
    ]
    for section in one.sections:
        figures = (block for block in section.blocks if isinstance(block, Figure) and block.key in of_second)
        if both := [overlaid(figure, of_second[figure.key], names) for figure in figures]:
            sections.append(Section(f"plots_{section.key}", section.title, both))
    origins = (f"{run.folder}, scenario {run.summary['scenario_sha256']}" for run in (first, second))
    footer = "1: {}; 2: {}".format(*origins)
    worst = max((mood(run.summary) for run in (first, second)), key=("good", "warn", "bad").index)
    words = f"1: {headline(first)}; 2: {headline(second)}"
    return Report(f"{names[0]} and {names[1]}", words, worst, "Two flights compared", (), sections, footer)


def labels(*runs: Run) -> list[str]:
    """Return distinct names of the runs, those of their folders."""
    return distinct_names([run.folder for run in runs])


def outcomes(first: Run, second: Run) -> Table:
    """Tabulate outcome, time and version of each flight."""
    rows: list[Row] = []
    for name, run in zip(labels(first, second), (first, second), strict=True):
        summary = run.summary
        outcome = Cell(str(summary["outcome"]), mood(summary))
        rows.append([name, outcome, f"{summary['time_s']:.2f}", summary["edl6dof_version"]])
    return Table(["flight", "outcome", "end (s)>", "edl6dof"], rows)


def figures_table(first: Run, second: Run, names: Iterable[str] | None = None) -> Table:
    """Tabulate figures of both flights, all of them if ``names`` is ``None``, and the differences."""
    one, two = first.summary["figures"], second.summary["figures"]
    rows: list[Row] = []
    for name in dict.fromkeys([*one, *two]) if names is None else names:
        figure = figure_of_merit(name)
        rows.append([figure.meaning, figure.unit.label, *_numbers(one.get(name), two.get(name))])
    return Table(["figure", "unit", *(f"{label}>" for label in labels(first, second)), "difference>"], rows)


def events_table(first: Run, second: Run) -> Table:
    """Tabulate when the same events happened; the nth of repeated events are compared."""
    one, two = _numbered(first.events), _numbered(second.events)
    rows: list[Row] = []
    for key in sorted(one | two, key=lambda key: min(of[key][0] for of in (one, two) if key in of)):
        t1, t2 = (events[key][0] if key in events else None for events in (one, two))
        rows.append([(one.get(key) or two[key])[1], *_numbers(t1, t2)])
    return Table(["event", *(f"{label} (s)>" for label in labels(first, second)), "difference (s)>"], rows)


def differences_table(first: Run, second: Run) -> Table | Text:
    """Tabulate the dotted paths whose values differ; absent and unset are the same."""
    one, two = dict(_leaves(first.scenario)), dict(_leaves(second.scenario))
    rows: list[Row] = [
        [path, *(_shown(values[path]) if path in values else "-" for values in (one, two))]
        for path in dict.fromkeys([*one, *two])
        if one.get(path) != two.get(path)
    ]
    return Table(["parameter", *labels(first, second)], rows) if rows else Text("The scenarios are the same.")


def together(figures: Sequence[Figure], names: Sequence[str]) -> Figure:
    """Draw the curves of several flights in the panels of one figure, each of which has one channel.

    Each flight has its own colour and dashes.
    """
    panels = []
    for index, panel in enumerate(figures[0].panels):
        curves = (figure.panels[index].traces[0] for figure in figures)
        named = zip(curves, names, cycle(get_args(Dash)), strict=False)
        traces = [replace(own, name=name, dash=dash) for own, name, dash in named]
        panels.append(replace(panel, traces=traces))
    return replace(figures[0], panels=panels, title=f"{figures[0].title} of {len(figures)} flights")


def overlaid(first: Figure, second: Figure, names: Sequence[str]) -> Figure:
    """Overlay figures of one key: the second flight dashed and darker, limits and marks of the first."""
    panels = [_both(panel, _partner(panel, k, second.panels), names) for k, panel in enumerate(first.panels)]
    return replace(first, panels=panels)


def _partner(panel: Panel, index: int, others: Sequence[Panel]) -> Panel | None:
    """Panel of the other figure with the same title of the y axis, that at ``index`` first; or ``None``."""
    there = others[index : index + 1]
    return next((other for other in (*there, *others) if other.y.title == panel.y.title), None)


def _both(one: Panel, two: Panel | None, names: Sequence[str]) -> Panel:
    if one.heat is not None:
        return replace(one, title=f"{names[0]} only")
    if two is None:
        return one
    traces = [_named(trace, names[0]) for trace in one.coloured()]
    for trace in (trace for trace in two.coloured() if not trace.border):
        dash: Dash = "dash" if trace.dash == "solid" else "dot"
        other = replace(_named(trace, names[1]), dash=dash, colour=darker(trace.colour))
        traces.append(replace(other, labels=(), width=1.3))
    return replace(one, x=_widened(one.x, two.x), y=_widened(one.y, two.y), traces=traces)


def _widened(axis: Axis, other: Axis) -> Axis:
    """The first axis, its range (if it has one) widened to include that of the other, direction unchanged."""
    if axis.range is None or axis.names:
        return axis
    every = (*axis.range, *(other.range or ()))
    low, high = min(every), max(every)
    return replace(axis, range=(low, high) if axis.range[0] <= axis.range[1] else (high, low))


def darker(colour: str) -> str:
    """Return a colour (``#rrggbb``) mixed with black."""
    parts = [int(colour[i : i + 2], 16) for i in (1, 3, 5)]
    return "#" + "".join(f"{round(part * DARKER):02x}" for part in parts)


def _named(trace: Trace, flight: str) -> Trace:
    if trace.border or trace.kind == "points":
        return trace
    return replace(trace, name=f"{trace.name}, {flight}" if trace.name else flight)


def _numbers(one: float | None, two: float | None) -> list[str]:
    """Both values and their difference: whole, or with five digits, three of the difference."""
    given = [math.nan if value is None else float(value) for value in (one, two)]
    size = max((abs(value) for value in given if math.isfinite(value)), default=0.0)
    whole = all(value.is_integer() for value in given if math.isfinite(value))
    change = given[1] - given[0]
    places = 0 if whole else min(max(decimals(size, 5), decimals(abs(change), 3)), 6)
    shown = [f"{value:,.{places}f}" if math.isfinite(value) else "-" for value in given]
    return [*shown, f"{change:+,.{places}f}" if math.isfinite(change) else "-"]


def _numbered(events: Sequence[Mapping[str, Any]]) -> dict[tuple[str, int], tuple[float, str]]:
    found: dict[tuple[str, int], tuple[float, str]] = {}
    for event in events:
        count = sum(key == event["key"] for key, _ in found)
        name = {"bank_reversal": "bank reversal", "end": "end"}.get(event["key"], event["name"])
        found[event["key"], count] = (float(event["t_s"]), name + (f" {count + 1}" if count else ""))
    return found


def _leaves(value: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """Dotted paths and values of nested data; a list of numbers is one value, and of a fault only the
    parameters of its own kind are kept.
    """
    if isinstance(value, dict):
        others = FAULT_KINDS.names if value.get("kind") in FAULT_KINDS.names else ()
        for key, item in value.items():
            if key not in others or key == value["kind"]:
                yield from _leaves(item, f"{path}.{key}" if path else str(key))
    elif isinstance(value, list) and any(isinstance(item, dict) for item in value):
        for index, item in enumerate(value):
            yield from _leaves(item, f"{path}.{index}")
    else:
        yield path, value


def _shown(value: Any) -> str:
    text = write_flow(value)
    return text if len(text) <= 60 else text[:57] + "..."
