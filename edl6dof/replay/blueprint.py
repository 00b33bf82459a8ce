"""The arrangement of the views: one page for each part of a flight, its phases and the events below."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from edl6dof.replay.charts import axis_range, drawn, ends, shown
from edl6dof.replay.history import History
from edl6dof.replay.lanes import Lanes
from edl6dof.replay.pages import (
    AROUND_NOW,
    ENGINE,
    GROUPS,
    HAZARDS,
    INSTRUMENTS,
    NAVIGATION,
    NEAR_S,
    PAGES,
    PHASE,
    POWERED,
    SPACE,
    THRUSTERS,
    TIMELINE,
    TOUR,
    VEHICLE,
    Views,
    lane_of,
    spans_of,
    window,
)
from edl6dof.replay.scene.arrows import scales
from edl6dof.replay.scene.poses import Motion
from edl6dof.report.catalogue import Plot

if TYPE_CHECKING:
    import rerun as rr
    import rerun.blueprint as rrb


class Layout:
    """Builds the blueprint of one recording, whose pages are those of the first flight.

    Attributes:
        span: first and last time (s) of the flights.
        spans: of the pages that do not show all of it.
        plots: keys of the plots that have data.
        ranges: first and last value on the axis of each plot, by page and key, such that the curves of all
            flights lie on it.
        lanes: labels of the states of each lane, by page.
    """

    def __init__(
        self,
        flights: Sequence[History],
        motion: Motion,
        recording: rr.RecordingStream,
        labels: Sequence[str],
        ensemble: bool,
    ) -> None:
        import rerun.blueprint as rrb

        self.rrb, self.flight, self.labels, self.ensemble = rrb, flights[0], labels, ensemble
        drawable = len(motion.t) > 0
        last = max((float(flight.t[-1]) for flight in flights if len(flight.t)), default=1.0)
        self.span = (float(motion.t[0]), last) if drawable else (0.0, 1.0)
        self.spans = spans_of(self.span, self.flight.when)
        self.plots = {plot.key for plot in shown(self.flight)}
        pages = {"Flight": self.span, **self.spans}
        self.ranges = _ranges(flights, pages)
        self.lanes = Lanes(self.flight, motion, recording).labels(pages) if drawable else {}
        arrows = scales(self.flight, motion) if len(motion.t) > 2 else ""
        self.views = Views(motion, labels or ("",), arrows)

    def blueprint(self, active: str = "Flight") -> rrb.Blueprint:
        """Return all pages with data, that named ``active`` in front; the tour alone, as in a film."""
        rrb, when = self.rrb, self.flight.when
        clock = rrb.TimePanel(timeline=TIMELINE, state="collapsed", playback_speed=4.0, play_state="playing")
        tour = self._tour()
        if active == TOUR:
            top = rrb.TopPanel(state="hidden")
            return rrb.Blueprint(tour, clock, top, auto_views=False, auto_layout=False, collapse_panels=True)
        possible = (
            (self._flight, True),
            (self._entry, True),
            (self._parachute, self.views.deploy is not None),
            (self._powered, "backshell" in when),
            (self._hazards, self.flight.landing_map is not None),
            (self._control, bool(self.flight.jets)),
            (self._navigation, bool(self.flight.instruments)),
            (self._thrusters, bool(self.flight.jets)),
        )
        pages = [*(self._with_lanes(page()) for page, there in possible if there), tour]
        names = [str(page.name) for page in pages]
        tabs = rrb.Tabs(*pages, active_tab=names.index(active) if active in names else 0)
        return rrb.Blueprint(tabs, clock, auto_views=False, auto_layout=False, collapse_panels=True)

    def _with_lanes(self, page: rrb.Container) -> rrb.Container:
        """A page with the phases of its own time and the events below."""
        rrb, name = self.rrb, str(page.name)
        texts = rrb.Tabs(self._text("Events"), self._text("Legend"), active_tab=0)
        below = rrb.Horizontal(self._lanes(name), texts, column_shares=[11, 8])
        return rrb.Vertical(page, below, row_shares=[7, 2], name=name)

    def _text(self, name: str) -> rrb.TextDocumentView:
        return self.rrb.TextDocumentView(origin=f"/{name.lower()}", name=name)

    def _flight(self) -> rrb.Container:
        rrb, views, readout = self.rrb, self.views, self._text("Readout")
        if self.ensemble:
            readout = rrb.Vertical(self._text("Campaign"), readout)
        afar = [] if views.deploy is None else [views.afar("Descent")]
        around = rrb.Tabs(*afar, views.whole(), views.globe(), active_tab=0)
        middle = rrb.Vertical(readout, around, row_shares=[5, 2])
        plots = self._grid("Flight", 1)
        return rrb.Horizontal(views.chase(), middle, plots, column_shares=[9, 5, 10], name="Flight")

    def _entry(self) -> rrb.Container:
        rrb, views = self.rrb, self.views
        below = rrb.Tabs(views.globe(), views.whole(), active_tab=0)
        left = rrb.Vertical(views.body(), below, row_shares=[1, 1])
        return rrb.Horizontal(left, self._grid("Entry"), column_shares=[5, 8], name="Entry")

    def _parachute(self) -> rrb.Container:
        rrb, views = self.rrb, self.views
        others = rrb.Vertical(views.away(), views.afar("Descent"), row_shares=[1, 1])
        left = rrb.Horizontal(views.chase(), others, column_shares=[1, 1])
        return rrb.Horizontal(left, self._grid("Parachute"), column_shares=[11, 8], name="Parachute")

    def _powered(self) -> rrb.Container:
        rrb, views = self.rrb, self.views
        below = rrb.Tabs(views.landing(), views.site(), views.away(), active_tab=0)
        left = rrb.Vertical(views.chase(), below, row_shares=[3, 2])
        return rrb.Horizontal(left, self._grid(POWERED), column_shares=[5, 8], name=POWERED)

    def _hazards(self) -> rrb.Container:
        """The ground below the place from which it was scanned; chase and site."""
        rrb, views, motion = self.rrb, self.views, self.views.motion
        row = int(np.searchsorted(motion.t, self.flight.when["scan"]).clip(0, max(len(motion.t) - 1, 0)))
        scanned = motion.centre[row] if len(motion.t) else np.zeros(3)
        right = rrb.Vertical(views.chase(), views.site(), row_shares=[1, 1])
        return rrb.Horizontal(views.above(scanned), right, column_shares=[1, 1], name=HAZARDS)

    def _tour(self) -> rrb.Container:
        """The director's picture and the readout, and nothing else."""
        return self.rrb.Horizontal(self.views.tour(), self._text("Readout"), column_shares=[4, 1], name=TOUR)

    def _control(self) -> rrb.Container:
        rrb = self.rrb
        planes = [
            rrb.Spatial2DView(
                origin=f"/phase_plane/{axis}",
                name=f"{axis.capitalize()}: error (deg), rate (deg/s)",
                background=rrb.Background(color=SPACE),
                visual_bounds=rrb.VisualBounds2D(x_range=[-1.25, 1.1], y_range=[-0.78, 0.92]),
                overrides={f"/phase_plane/{axis}/way": window(rrb, 12.0)},
            )
            for axis in ("roll", "pitch", "yaw")
        ]
        left = rrb.Tabs(*planes, active_tab=0)
        return rrb.Horizontal(left, self._grid("Control"), column_shares=[2, 5], name="Control")

    def _navigation(self) -> rrb.Container:
        rrb, lanes = self.rrb, dict[str, list[str]]()
        for one in self.flight.instruments:
            lanes.setdefault(INSTRUMENTS[one.kind], []).append(lane_of(one.kind, one.name))
        views = [self._states(title, names, NAVIGATION) for title, names in lanes.items()]
        below = rrb.Tabs(*reversed(views), active_tab=0)
        left = rrb.Vertical(self.views.chase(), below, row_shares=[3, 2])
        return rrb.Horizontal(left, self._grid(NAVIGATION), column_shares=[4, 9], name=NAVIGATION)

    def _thrusters(self) -> rrb.Container:
        rrb, names = self.rrb, sorted(self.flight.jets)
        half = (len(names) + 1) // 2
        lanes = rrb.Horizontal(*(self._jets(some) for some in (names[:half], names[half:])))
        groups = {jet.group for jet in self.flight.scenario.vehicle.rcs.thrusters if jet.name in names}
        plots = [
            self._plot(f"thruster_duty/{group}", f"{title} thrusters, duty (0 to 1)", THRUSTERS)
            for group, title in GROUPS.items()
            if group in groups
        ]
        shown = [plot for plot in PAGES[THRUSTERS] if plot.key in self.plots]
        plots += [self._plot(plot.key, _title(plot), THRUSTERS) for plot in shown]
        right = rrb.Vertical(self.views.body(), rrb.Grid(*plots, grid_columns=2), row_shares=[4, 5])
        return rrb.Horizontal(lanes, right, column_shares=[3, 5], name=THRUSTERS)

    def _jets(self, names: Sequence[str]) -> rrb.StateTimelineView:
        title = f"Thrusters {names[0]} to {names[-1]}" if names else "Thrusters"
        return self._states(title, [lane_of("thruster", name) for name in names], THRUSTERS)

    def _states(self, title: str, lanes: Sequence[str], page: str) -> rrb.StateTimelineView:
        """Some lanes in the time of a page."""
        return self.rrb.StateTimelineView(contents=lanes, name=title, time_view=self._axis(page))

    def _lanes(self, page: str) -> rrb.StateTimelineView:
        """The lanes of a page in the time of its plots, with the labels that have room."""
        import rerun as rr

        page = page if page in self.spans else "Flight"
        own = self.lanes.get(page, {}).items()
        return self.rrb.StateTimelineView(
            contents=[f"/{name}" for name in (PHASE, VEHICLE, ENGINE)],
            name="Phases",
            time_view=self._axis(page),
            overrides={f"/{name}": rr.StateConfiguration.from_fields(labels=labels) for name, labels in own},
        )

    def _axis(self, page: str) -> rrb.TimeAxis:
        rrb = self.rrb
        if page in AROUND_NOW:
            edge, (first, last) = rrb.TimeRangeBoundary.cursor_relative, (-NEAR_S, NEAR_S)
        else:
            edge, (first, last) = rrb.TimeRangeBoundary.absolute, self.spans.get(page, self.span)
            last += 0.02 * (last - first)  # or a label at the end would be cut off
        return rrb.TimeAxis(view_range=rrb.TimeRange(start=edge(seconds=first), end=edge(seconds=last)))

    def _plot(self, entity: str, title: str, page: str, legend: bool = True) -> rrb.TimeSeriesView:
        rrb = self.rrb
        ends = self.ranges.get((page if page in self.spans else "Flight", entity))
        return rrb.TimeSeriesView(
            origin="/plots",
            name=title,
            contents=[f"/plots/{entity}/**"],
            axis_x=self._axis(page),
            axis_y=None if ends is None else rrb.ScalarAxis(range=ends),
            plot_legend=rrb.PlotLegend(corner=rrb.Corner2D.RightTop, visible=legend or len(self.labels) > 1),
        )

    def _grid(self, page: str, columns: int = 2) -> rrb.Grid:
        views = [
            self._plot(plot.key, _title(plot), self._time_of(page, plot), len(plot.channels) > 1)
            for plot in PAGES[page]
            if plot.key in self.plots
        ]
        columns = 3 if len(views) > 8 else columns
        return self.rrb.Grid(*views, grid_columns=columns, name=f"{page} plots")

    def _time_of(self, page: str, plot: Plot) -> str:
        """The page whose time a plot shows: that of powered descent where it means nothing before, though its
        own page has no time of its own.
        """
        return POWERED if plot.since == "backshell" and page not in self.spans else page


def _title(plot: Plot) -> str:
    return plot.label[0].upper() + plot.label[1:]


def _ranges(
    flights: Sequence[History], spans: dict[str, tuple[float, float]]
) -> dict[tuple[str, str], tuple[float, float]]:
    """First and last value on the axis of each plot in the time of each page."""
    found = {}
    curves: dict[str, list[tuple[np.ndarray, np.ndarray]]] = {}
    for flight in flights:
        for plot in shown(flight):
            curves.setdefault(plot.key, []).append(drawn(plot, flight))
    for key, page in product(curves, spans):
        if values := [value for one in curves[key] for value in ends(*one, spans[page])]:
            found[page, key] = axis_range(min(values), max(values))
    return found
