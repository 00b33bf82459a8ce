"""Plots of channels by name, of whatever has columns with units and meanings."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fnmatch import fnmatchcase
from typing import Protocol

import numpy as np

from edl6dof.config.errors import refusal
from edl6dof.config.wording import nearest
from edl6dof.report.figure import Axis, Figure, Panel, Trace
from edl6dof.report.panels import CATALOGUE


class Columns(Protocol):
    """Columns by name, each shape (rows,), in the unit of its name's suffix."""

    def __iter__(self) -> Iterator[str]: ...
    def __getitem__(self, name: str, /) -> np.ndarray: ...
    def unit(self, name: str) -> str:
        """Printed unit of a column."""

    def meaning(self, name: str) -> str:
        """What a column means."""


def chosen(columns: Columns, patterns: Sequence[str], place: object) -> list[str]:
    """Names of the columns that match, in the order of the patterns, or that a plot of the catalogue shows
    whose key is given; ``place``: whose they are, for messages.

    Raises:
        ConfigError: a pattern matches nothing.
    """
    found: dict[str, None] = {}
    for pattern in patterns:
        plotted = CATALOGUE[pattern].channels if pattern in CATALOGUE else ()
        names = [name for name in columns if name in plotted or fnmatchcase(name, pattern)]
        if not names:
            begun = [name for name in columns if name.startswith(pattern)]
            near = f"{pattern}*" if len(begun) > 1 else nearest(pattern, begun or list(columns))
            hint = f"; did you mean {near!r}?" if near else ""
            raise refusal(place, f"no channel {pattern!r}{hint} (edl6dof plot RUN lists all)")
        found.update(dict.fromkeys(names))
    return list(found)


def channel_plot(columns: Columns, channels: Sequence[str], x: str, rows: np.ndarray) -> Figure:
    """One panel for each unit; ``rows``: which to show, shape (rows,), bool."""
    by_unit: dict[str, list[str]] = {}
    for name in channels:
        by_unit.setdefault(columns.unit(name), []).append(name)
    across = Axis(f"{columns.meaning(x)} ({columns.unit(x) or '1'})")
    panels = []
    for unit, names in by_unit.items():
        title = columns.meaning(names[0]) if len(names) == 1 else "value"
        traces = [Trace(columns[x][rows], columns[name][rows], name) for name in names]
        panels.append(Panel(across, Axis(f"{title} ({unit or '1'})"), traces))
    return Figure(
        "plot",
        ", ".join(channels) if len(channels) < 4 else f"{len(channels)} channels",
        panels,
        share_x=True,
        height=320,
    )
