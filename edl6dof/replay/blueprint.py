"""The arrangement of the views: one page for each part of a flight, its phases and the events below."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from edl6dof.replay import pages
from edl6dof.replay.charts import ranges, shown
from edl6dof.replay.history import History
from edl6dof.replay.lanes import Lanes
from edl6dof.replay.scene.arrows import scales
from edl6dof.replay.scene.poses import Motion
from edl6dof.report.catalogue import Plot

if TYPE_CHECKING:
    import rerun as rr
    import rerun.blueprint as rrb

#: Time (s) of flight that a trail shows.
TRAIL_S = 60.0
SPACE = (10, 9, 12)
#: Entities that only other views show.
_FRAMES = ("near", "vehicle/attitude_frame")
_NOT_CHASE = ("campaign", "path", "markers", "labels", "drop_line", "ground_track", *_FRAMES)
#: Entities that belong to one camera alone.
_OWN = ("camera/scale_bar",)
_NOT_SITE = (*_FRAMES, "path", "markers", "labels", *_OWN)
_NOT_AFAR = ("vehicle/failed", *_FRAMES, "sky", "labels", *_OWN)


class Layout:
    """Builds the blueprint of one recording, whose pages are those of the first flight.

    Attributes:
        labels, roots: name of each flight (empty if there is only one), and root entity of what it alone has.
        start, end, deploy: first and last place, and that of the parachute deployment if any, m in L.
        span, spans: first and last time (s) of the flights, and by page of each page that shows only a part.
        plots: keys of the plots that have data.
        ranges: first and last value on the axis of each plot, by page and key.
        lanes: labels of the states, by page and lane.
        scales: value that 1 m of each arrow stands for, as text.
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

        self.rrb, self.flight, self.motion, self.ensemble = rrb, flights[0], motion, ensemble
        self.labels = labels or ("",)
        self.roots = [pages.root_of(k) for k in range(len(self.labels))]
        drawable = len(motion.t) > 0
        places, deploy = motion.centre if drawable else np.zeros((1, 3)), motion.released(motion.canopy)
        self.start, self.end = places[0], places[-1]
        self.deploy = None if deploy is None else places[deploy]
        last = max((float(flight.t[-1]) for flight in flights if len(flight.t)), default=1.0)
        self.span = (float(motion.t[0]), last) if drawable else (0.0, 1.0)
        self.spans = pages.spans_of(self.span, self.flight.when)
        self.plots = {plot.key for plot in shown(self.flight)}
        every = {"Flight": self.span, **self.spans}
        self.ranges = ranges(flights, every)
        self.lanes = Lanes(self.flight, motion, recording).labels(every) if drawable else {}
        self.scales = scales(self.flight, motion) if len(motion.t) > 2 else ""

    def blueprint(self, active: str = "Flight") -> rrb.Blueprint:
        """Return all pages that have data, page ``active`` in front; page Tour alone, as for a film."""
        rrb, when = self.rrb, self.flight.when
        clock = rrb.TimePanel(
            timeline=pages.TIMELINE, state="collapsed", playback_speed=4.0, play_state="playing"
        )
        tour = self._tour()
        if active == pages.TOUR:
            top = rrb.TopPanel(state="hidden")
            return rrb.Blueprint(tour, clock, top, auto_views=False, auto_layout=False, collapse_panels=True)
        possible = (
            (self._flight, True),
            (self._entry, True),
            (self._parachute, self.deploy is not None),
            (self._powered, "backshell" in when),
            (self._hazards, self.flight.landing_map is not None),
            (self._control, bool(self.flight.jets)),
            (self._navigation, bool(self.flight.instruments)),
            (self._thrusters, bool(self.flight.jets)),
        )
        shown = [*(self._with_lanes(page()) for page, there in possible if there), tour]
        names = [str(page.name) for page in shown]
        tabs = rrb.Tabs(*shown, active_tab=names.index(active) if active in names else 0)
        return rrb.Blueprint(tabs, clock, auto_views=False, auto_layout=False, collapse_panels=True)

    def _with_lanes(self, page: rrb.Container) -> rrb.Container:
        """Return a page with the lanes of its time span and the timeline of events below it."""
        rrb, name = self.rrb, str(page.name)
        texts = rrb.Tabs(self._text("Events"), self._text("Legend"), active_tab=0)
        below = rrb.Horizontal(self._lanes(name), texts, column_shares=[11, 8])
        return rrb.Vertical(page, below, row_shares=[7, 2], name=name)

    def _text(self, name: str) -> rrb.TextDocumentView:
        return self.rrb.TextDocumentView(origin=f"/{name.lower()}", name=name)

    def _flight(self) -> rrb.Container:
        rrb, readout = self.rrb, self._text("Readout")
        if self.ensemble:
            readout = rrb.Vertical(self._text("Campaign"), readout)
        afar = [] if self.deploy is None else [self._descent()]
        around = rrb.Tabs(*afar, self._whole(), self._globe(), active_tab=0)
        middle = rrb.Vertical(readout, around, row_shares=[5, 2])
        plots = self._grid("Flight", 1)
        return rrb.Horizontal(self._chase(), middle, plots, column_shares=[9, 5, 10], name="Flight")

    def _entry(self) -> rrb.Container:
        rrb = self.rrb
        below = rrb.Tabs(self._globe(), self._whole(), active_tab=0)
        left = rrb.Vertical(self._body(), below, row_shares=[1, 1])
        return rrb.Horizontal(left, self._grid("Entry"), column_shares=[5, 8], name="Entry")

    def _parachute(self) -> rrb.Container:
        rrb = self.rrb
        others = rrb.Vertical(self._away(), self._descent(), row_shares=[1, 1])
        left = rrb.Horizontal(self._chase(), others, column_shares=[1, 1])
        return rrb.Horizontal(left, self._grid("Parachute"), column_shares=[11, 8], name="Parachute")

    def _powered(self) -> rrb.Container:
        rrb = self.rrb
        below = rrb.Tabs(self._landing(), self._site(), self._away(), active_tab=0)
        left = rrb.Vertical(self._chase(), below, row_shares=[3, 2])
        return rrb.Horizontal(left, self._grid(pages.POWERED), column_shares=[5, 8], name=pages.POWERED)

    def _hazards(self) -> rrb.Container:
        """Page on hazards: the scanned ground from above, the chase view, and the landed vehicle."""
        rrb, motion = self.rrb, self.motion
        row = int(np.searchsorted(motion.t, self.flight.when["scan"]).clip(0, max(len(motion.t) - 1, 0)))
        scanned = motion.centre[row] if len(motion.t) else np.zeros(3)
        right = rrb.Vertical(self._chase(), self._site(), row_shares=[1, 1])
        return rrb.Horizontal(self._above(scanned), right, column_shares=[1, 1], name=pages.HAZARDS)

    def _tour(self) -> rrb.Container:
        """The director's picture and the readout, and nothing else."""
        return self.rrb.Horizontal(
            self._director(), self._text("Readout"), column_shares=[4, 1], name=pages.TOUR
        )

    def _control(self) -> rrb.Container:
        rrb = self.rrb
        planes = [
            rrb.Spatial2DView(
                origin=f"/phase_plane/{axis}",
                name=f"{axis.capitalize()}: error (deg), rate (deg/s)",
                background=rrb.Background(color=SPACE),
                visual_bounds=rrb.VisualBounds2D(x_range=[-1.25, 1.1], y_range=[-0.78, 0.92]),
                overrides={f"/phase_plane/{axis}/way": self._window(12.0)},
            )
            for axis in ("roll", "pitch", "yaw")
        ]
        left = rrb.Tabs(*planes, active_tab=0)
        return rrb.Horizontal(left, self._grid("Control"), column_shares=[2, 5], name="Control")

    def _navigation(self) -> rrb.Container:
        rrb, lanes = self.rrb, dict[str, list[str]]()
        for one in self.flight.instruments:
            lanes.setdefault(pages.INSTRUMENTS[one.kind], []).append(pages.lane_of(one.kind, one.name))
        views = [self._states(title, names, pages.NAVIGATION) for title, names in lanes.items()]
        below = rrb.Tabs(*reversed(views), active_tab=0)
        left = rrb.Vertical(self._chase(), below, row_shares=[3, 2])
        return rrb.Horizontal(left, self._grid(pages.NAVIGATION), column_shares=[4, 9], name=pages.NAVIGATION)

    def _thrusters(self) -> rrb.Container:
        rrb, names = self.rrb, sorted(self.flight.jets)
        half = (len(names) + 1) // 2
        lanes = rrb.Horizontal(*(self._jets(some) for some in (names[:half], names[half:])))
        groups = {jet.group for jet in self.flight.scenario.vehicle.rcs.thrusters if jet.name in names}
        duties = [(group, title) for group, title in pages.GROUPS.items() if group in groups]
        shown = [(f"thruster_duty/{group}", f"{title} thrusters, duty (0 to 1)") for group, title in duties]
        shown += [(plot.key, _title(plot)) for plot in pages.PAGES[pages.THRUSTERS] if plot.key in self.plots]
        plots = rrb.Grid(*(self._plot(*one, pages.THRUSTERS) for one in shown), grid_columns=2)
        right = rrb.Vertical(self._body(), plots, row_shares=[4, 5])
        return rrb.Horizontal(lanes, right, column_shares=[3, 5], name=pages.THRUSTERS)

    def _jets(self, names: Sequence[str]) -> rrb.StateTimelineView:
        title = f"Thrusters {names[0]} to {names[-1]}" if names else "Thrusters"
        return self._states(title, [pages.lane_of("thruster", name) for name in names], pages.THRUSTERS)

    def _states(self, title: str, lanes: Sequence[str], page: str) -> rrb.StateTimelineView:
        """View of some lanes over the time span of a page."""
        return self.rrb.StateTimelineView(contents=lanes, name=title, time_view=self._axis(page))

    def _lanes(self, page: str) -> rrb.StateTimelineView:
        """View of the lanes of a page over the time span of its plots, with the labels that have room."""
        import rerun as rr

        page = page if page in self.spans else "Flight"
        own = self.lanes.get(page, {}).items()
        return self.rrb.StateTimelineView(
            contents=[f"/{name}" for name in (pages.PHASE, pages.VEHICLE, pages.ENGINE)],
            name="Phases",
            time_view=self._axis(page),
            overrides={f"/{name}": rr.StateConfiguration.from_fields(labels=labels) for name, labels in own},
        )

    def _axis(self, page: str) -> rrb.TimeAxis:
        rrb = self.rrb
        if page in pages.AROUND_NOW:
            edge, (first, last) = rrb.TimeRangeBoundary.cursor_relative, (-pages.NEAR_S, pages.NEAR_S)
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
        views = []
        for plot in (plot for plot in pages.PAGES[page] if plot.key in self.plots):
            # on a page without its own time span, a plot that begins with powered descent shows that span
            time = pages.POWERED if plot.since == "backshell" and page not in self.spans else page
            views.append(self._plot(plot.key, _title(plot), time, len(plot.channels) > 1))
        columns = 3 if len(views) > 8 else columns
        return self.rrb.Grid(*views, grid_columns=columns, name=f"{page} plots")

    def _scene(
        self, name: str, origin: str, contents: Sequence[str], place: Any, target: Any, **more: Any
    ) -> rrb.Spatial3DView:
        """View of some entities, from an eye at ``place`` towards ``target``."""
        rrb = self.rrb
        return rrb.Spatial3DView(
            origin=origin,
            contents=contents,
            name=name,
            background=rrb.Background(color=SPACE),
            line_grid=False,
            eye_controls=rrb.EyeControls3D(position=place, look_target=target, eye_up=(0.0, 0.0, 1.0)),
            **more,
        )

    def _view(
        self,
        name: str,
        origin: str,
        hidden: Sequence[str],
        place: np.ndarray,
        target: np.ndarray,
        labels: Sequence[str] = (),
        not_of_others: Sequence[str] = (),
    ) -> rrb.Spatial3DView:
        """View of the site without the entities ``hidden``, and without ``not_of_others`` of the flights that
        ``origin`` does not belong to.
        """
        excluded = [f"- {root}/{part}/**" for root in self.roots for part in hidden]
        others = [root for root in self.roots if f"{root}/{origin.rpartition('/')[2]}" != origin]
        excluded += [f"- {root}/{part}/**" for root in others for part in not_of_others]
        excluded += [f"/site/labels/{name}" for name in labels]
        trails = {f"{root}/trail": self._window(TRAIL_S) for root in self.roots}
        return self._scene(name, origin, ["/site/**", *excluded], place, target, overrides=trails)

    def _chase(self) -> rrb.Spatial3DView | rrb.Grid:
        """View that follows vehicle and parachute; several flights side by side."""
        return self._each("camera", "Chase", _NOT_CHASE, pages.EYE)

    def _director(self) -> rrb.Spatial3DView | rrb.Grid:
        """View of the director's camera; several flights side by side."""
        return self._each("tour", "Tour", (*_NOT_CHASE, "trail", *_OWN), pages.TOUR_EYE)

    def _away(self) -> rrb.Spatial3DView:
        """View that follows the part that was released last."""
        return self._view(
            "What falls away", "/site/camera_away", (*_NOT_CHASE, *_OWN), pages.EYE, np.zeros(3)
        )

    def _each(
        self, camera: str, name: str, hidden: Sequence[str], eye: np.ndarray
    ) -> rrb.Spatial3DView | rrb.Grid:
        """View from the same camera of each flight, side by side."""
        titles, own = [f"{name}: {label}" if label else name for label in self.labels], (*_OWN, "camera/name")
        views = [
            self._view(title, f"{root}/{camera}", hidden, eye, np.zeros(3), not_of_others=own)
            for root, title in zip(self.roots, titles, strict=True)
        ]
        return views[0] if len(views) == 1 else self.rrb.Grid(*views, name=name)

    def _body(self) -> rrb.Spatial3DView:
        """The vehicle with its frames and forces."""
        name = f"Body and forces: {self.scales}" if self.scales else "Body and frames"
        place = pages.body_eye(self.start, self.end, self.motion.shape.size)
        return self._scene(name, "/site/near", ["/site/vehicle/**", "/site/near/**"], place, np.zeros(3))

    def _whole(self) -> rrb.Spatial3DView:
        """The whole flight from the side, a little from above."""
        return self._aside("Whole flight", self.start, 0.62, 0.20, 0.02)

    def _descent(self) -> rrb.Spatial3DView:
        """The flight from the parachute, if there is one, to the ground, from the side."""
        start = self.start if self.deploy is None else self.deploy
        return self._aside("Descent", start, 1.25, 0.12, 0.03)

    def _aside(
        self, name: str, start: np.ndarray, off: float, above: float, below: float
    ) -> rrb.Spatial3DView:
        """View of the path from ``start`` to the end from its side: the eye is ``off`` aside and ``above``
        the middle of the path, the target ``below`` it, in lengths of the path.
        """
        along, length, side = pages.course(start, self.end)
        middle, up = start + 0.5 * along, np.array([0.0, 0.0, length])
        place, target = middle - off * length * side + above * up, middle - below * up
        return self._view(name, "/site", _NOT_AFAR, place, target, ["target"])

    def _landing(self) -> rrb.Spatial3DView:
        """The last kilometre, from the side."""
        place, target = self.end + [700.0, 500.0, 420.0], self.end + [0.0, 0.0, 330.0]
        return self._view("Landing", "/site", _NOT_AFAR, place, target, ["**"])

    def _site(self) -> rrb.Spatial3DView:
        """The vehicle where it comes to rest."""
        end = self.end
        return self._view("Site", "/site", _NOT_SITE, end + [16.0, -26.0, 9.0], end)

    def _above(self, scanned: np.ndarray) -> rrb.Spatial3DView:
        """The ground below the hover, north up."""
        place, target = scanned - [0.0, 20.0, 20.0], scanned - [0.0, 0.0, 100.0]
        hidden = (*_NOT_SITE, "drop_line", "trail", "sky")
        return self._view("Hazards from above", "/site", hidden, place, target)

    def _globe(self) -> rrb.Spatial3DView:
        """The planet, from above the middle of the path; km in F."""
        middle = self.motion.site.in_F(0.5 * (self.start + self.end)) / 1e3
        return self._scene("Globe", "/globe", ["$origin/**"], 2.3 * middle, 0.0 * middle)

    def _window(self, seconds: float) -> rrb.VisibleTimeRanges:
        """The last seconds before the cursor."""
        edge = self.rrb.TimeRangeBoundary.cursor_relative
        span = self.rrb.VisibleTimeRange(pages.TIMELINE, start=edge(seconds=-seconds), end=edge())
        return self.rrb.VisibleTimeRanges(span)


def _title(plot: Plot) -> str:
    return plot.label[0].upper() + plot.label[1:]
