"""Plots of a flight that a notebook shows: each is drawn as in the report of the flight."""

from __future__ import annotations

import io
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from edl6dof.config.errors import UnknownName
from edl6dof.config.text_table import text_table
from edl6dof.report.catalogue import ALL_STACKS, CATALOGUE, Stack
from edl6dof.report.flight.common import figure_with_data
from edl6dof.runs.run import FlightColumns

if TYPE_CHECKING:
    from edl6dof.report.figure import Figure
    from edl6dof.report.matplotlib_figure import Canvas

#: Stacks of plots, and each plot alone, by name.
_ALONE = {key: Stack(key, plot.title, (plot,), height=320) for key, plot in CATALOGUE.items()}
_OFFERED = ALL_STACKS | {key: stack for key, stack in _ALONE.items() if key not in ALL_STACKS}


@dataclass(frozen=True)
class Plot:
    """A plot that a notebook can show.

    Attributes:
        figure: figure of matplotlib.
    """

    figure: Canvas

    @classmethod
    def of(cls, figure: Figure) -> Plot:
        """Draw the description of a figure."""
        from edl6dof.report.matplotlib_figure import matplotlib_figure

        return cls(matplotlib_figure(figure))

    def save(self, path: str | Path, dpi: int = 200) -> None:
        """Write the plot in the format of the suffix: ``.png``, ``.pdf`` or ``.svg``."""
        from edl6dof.report.matplotlib_figure import own_style

        with own_style():  # of which some settings act only now
            self.figure.savefig(path, dpi=dpi)

    def _repr_png_(self) -> bytes:
        buffer = io.BytesIO()
        self.figure.savefig(buffer, format="png", dpi=110)
        return buffer.getvalue()


class Plots(Mapping[str, Plot]):
    """Plots over time for which a flight has data, by name, as items and as attributes, printed as a table.

    They are figures of its report, such as ``rates``, and the plots that these consist of, such as ``mach``.

    Raises:
        UnknownName: on access to an item that the flight does not have.
        AttributeError: on access to an attribute that it does not have.
    """

    def __init__(self, columns: FlightColumns):
        self._columns = columns

    def __getitem__(self, name: str) -> Plot:
        figure = self._figure(name)
        if figure is None:
            raise UnknownName("plot", name, list(self))
        return Plot.of(figure)

    def __getattr__(self, name: str) -> Plot:
        if name.startswith("_"):
            raise AttributeError(name)
        try:
            return self[name]
        except UnknownName as error:
            raise AttributeError(str(error)) from None

    def __contains__(self, name: object) -> bool:
        return self._figure(name) is not None

    def __iter__(self) -> Iterator[str]:
        return (name for name in _OFFERED if name in self)

    def __len__(self) -> int:
        return sum(1 for _ in self)

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self]

    def __repr__(self) -> str:
        return text_table([("plot", "title"), *((name, _OFFERED[name].title) for name in self)])

    def _figure(self, name: object) -> Figure | None:
        return figure_with_data(self._columns, _OFFERED[name]) if name in _OFFERED else None


class ColumnsInMemory(FlightColumns):
    """Columns, events and figures of a flight that is in memory."""

    def __init__(
        self,
        telemetry: Mapping[str, np.ndarray],
        events: Sequence[Mapping[str, Any]],
        figures: Mapping[str, float | None],
    ):
        self._telemetry, self._events, self._figures = telemetry, events, figures

    @property
    def events(self) -> Sequence[Mapping[str, Any]]:
        """The timeline."""
        return self._events

    @property
    def figures(self) -> Mapping[str, float | None]:
        """Figures of merit by name."""
        return self._figures

    def __getitem__(self, name: str) -> np.ndarray:
        return self._telemetry[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._telemetry)

    def __len__(self) -> int:
        return len(self._telemetry)
