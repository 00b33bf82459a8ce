"""The plots over time, and the thrusters' duty."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from edl6dof.replay.history import thin
from edl6dof.replay.recorder import SLOW_HZ, Recorder
from edl6dof.replay.views.curves import BOUND, drawn, given
from edl6dof.replay.views.panels import GROUPS, NAVIGATION, PAGES, PLOTS, RGB, SERIES, Plot
from edl6dof.telemetry.thinning import rows_to_draw

if TYPE_CHECKING:
    import rerun as rr

#: Telemetry columns that the plots show, of every flight and of one on instruments.
COLUMNS = tuple(
    dict.fromkeys(
        name for page, plots in PAGES.items() if page != NAVIGATION for plot in plots for name in plot.columns
    )
)
NAVIGATION_COLUMNS = tuple(name for plot in PAGES[NAVIGATION] for name in plot.columns)
#: Rows of a plot about at most: more than a screen has columns of pixels.
MOST = 6000
#: Colour of the bounds.
CLAIMED: RGB = (150, 150, 160)


class Charts(Recorder):
    """Writes ``/plots``."""

    def statics(self) -> None:
        """Names and colours of the series."""
        for plot in self._plots():
            self.static(self._entity(plot.entity), self._lines(list(plot.series.values()), bool(plot.sigma)))
        for group, names in self._groups():
            self.static(self._entity(f"thruster_duty/{group}"), self._lines(names))

    def motions(self) -> None:
        """The series, where they mean something."""
        for plot in self._plots():
            self._plot(plot)
        rows = thin(self.t, SLOW_HZ)
        for group, names in self._groups():
            self._scalars(f"thruster_duty/{group}", self.t[rows], self.flight.mean_duty(rows, names))

    def _plots(self) -> list[Plot]:
        """Those that the flight has the telemetry of."""
        series = self.flight.series
        return [given(plot, series) for plot in PLOTS if set(plot.columns) <= set(series)]

    def _entity(self, name: str) -> str:
        return f"plots/{name}/flight_{self.number}" if self.number else f"plots/{name}"

    def _groups(self) -> list[tuple[str, list[str]]]:
        by_group = {
            group: [jet.name for jet in self.vehicle.rcs.thrusters if jet.group == group] for group in GROUPS
        }
        return [
            (group, names)
            for group, names in by_group.items()
            if names and set(names) <= set(self.flight.jets)
        ]

    def _lines(self, names: list[str], bounds: bool = False) -> rr.SeriesLines:
        """Where there are several flights, lines carry the flight's label, and its colour, the darker the
        later in the plot; ``bounds``: two more lines are those that are claimed.
        """
        colours = np.array([SERIES[i % len(SERIES)] for i in range(len(names))])
        if self.label:
            colours = np.outer(1.0 - 0.55 * np.arange(len(names)) / len(names), self.own).astype(int)
        colours = np.concatenate([colours, [CLAIMED] * 2 * bounds]) if bounds else colours
        names = names + [f"{sign} {BOUND:.0f} sigma claimed" for sign in "+-"] * bounds
        shown = [f"{self.label}: {name}" if self.label else name for name in names]
        return self.rr.SeriesLines(
            names=shown,
            colors=colours.tolist(),
            widths=[1.0 if self.number else 1.5] * len(names),
            aggregation_policy=self.rr.components.AggregationPolicy.MinMax,  # a mean would lose the peaks
        )

    def _plot(self, plot: Plot) -> None:
        t, curves = drawn(plot, self.flight.series, self.when)
        if len(t):
            rows = rows_to_draw(t, curves, MOST)
            self._scalars(plot.entity, t[rows], curves[rows])

    def _scalars(self, entity: str, t: np.ndarray, values: np.ndarray) -> None:
        columns = self.rr.Scalars.columns(scalars=values.ravel())
        self.columns(self._entity(entity), t, columns.partition(np.full(len(t), values.shape[1])))
