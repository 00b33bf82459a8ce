"""The arrangement of the views: one page for each part of a flight, its phases and the events below."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from edl6dof.replay import pages
from edl6dof.replay.charts import frames, legend, legend_share, shown
from edl6dof.replay.history import History
from edl6dof.replay.lanes import Lanes
from edl6dof.replay.scene.arrows import scales
from edl6dof.replay.scene.ensemble import Ensemble
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
#: Legend of the hazard map, beams of the radar, and what a bare view leaves out: these, hazard map and lidar.
_KEY, _BEAMS = "hazards/legend", "vehicle/beams"
_AIDS = (_BEAMS, "hazards")
_NOT_CHASE = ("campaign", "path", "markers", "labels", "drop_line", "ground_track", _KEY, *_FRAMES)
#: Entities that belong to one camera alone.
_OWN = ("camera/scale_bar",)
_NOT_SITE = (*_FRAMES, "path", "markers", "labels", _BEAMS, *_OWN)
_NOT_AFAR = ("vehicle/failed", *_FRAMES, "sky", "labels", _KEY, _BEAMS, *_OWN)
#: Entities that are hidden where only places on the ground are shown.
_FLYING = (
    *("campaign/paths", "path", "trail", "drop_line", "ground_track", "ground/rings"),
    *("markers/vehicle", "camera"),
)


class Layout:
    """Builds the blueprint of one recording, whose pages are those of the first flight.

    Attributes:
        labels, roots: name of each flight (empty if there is only one), and root entity of what it alone has.
        plotted: names of the flights in legends of plots; empty for a single one among a campaign's.
        start, end, deploy: first and last place, and that of the parachute deployment if any, m in L.
        span, spans: first and last time (s) of the flights, and by page of each page that shows only a part.
        plots: the plots that have data, by key.
        frames: axis and legend of each plot, by page and key.
        lanes: labels of the states, by page and lane.
        scales: value that 1 m of each arrow stands for, as text.
    """

    def __init__(
        self,
        flights: Sequence[History],
        motion: Motion,
        recording: rr.RecordingStream,
        labels: Sequence[str] = (),
        ensemble: Ensemble | None = None,
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
        self.plots = {plot.key: plot for plot in shown(self.flight, len(self.labels) > 1)}
        every = {"Flight": self.span, **self.spans}
        self.plotted = self.labels if len(self.labels) > 1 else ("",)
        self.frames = frames(flights, every, self.plotted)
        self.lanes = Lanes(self.flight, motion, recording).labels(every) if drawable else {}
        self.scales = scales(self.flight, motion) if len(motion.t) > 2 else ""

    def blueprint(self, active: str = "Flight", bare: bool = False) -> rrb.Blueprint:
        """Return all pages that have data, page ``active`` in front; page Tour alone, and every page if
        ``bare``, which leaves out the viewer's own controls, as in a picture of the tour.
        """
        rrb, when = self.rrb, self.flight.when
        clock = rrb.TimePanel(
            timeline=pages.TIMELINE,
            state="hidden" if bare else "collapsed",
            playback_speed=4.0,
            play_state="playing",
        )
        tour = self._tour()
        possible = (
            (self._campaign, self.ensemble is not None),
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
        front = names.index(active) if active in names else 0
        alone = bare or active == pages.TOUR
        page = shown[front] if alone else rrb.Tabs(*shown, active_tab=front)
        top = rrb.TopPanel(state="hidden" if alone else "expanded")
        return rrb.Blueprint(page, clock, top, auto_views=False, auto_layout=False, collapse_panels=True)

    def _with_lanes(self, page: rrb.Container) -> rrb.Container:
        """Return a page with the lanes of its time span and the timeline of events below it."""
        rrb, name = self.rrb, str(page.name)
        texts = rrb.Tabs(self._text("Events"), self._text("Legend"), active_tab=0)
        below = rrb.Horizontal(self._lanes(name), texts, column_shares=[11, 8])
        return rrb.Vertical(page, below, row_shares=[7, 2], name=name)

    def _text(self, name: str, **more: Any) -> rrb.TextDocumentView:
        return self.rrb.TextDocumentView(origin=f"/{name.lower()}", name=name, **more)

    def _campaign(self) -> rrb.Container:
        """Page on a campaign: all trajectories, the landing footprint from above, and the legend."""
        paths = self.rrb.Vertical(self._whole(), self._descent(), row_shares=[1, 1])
        views = (paths, self._footprint(), self._text(pages.CAMPAIGN))
        return self.rrb.Horizontal(*views, column_shares=pages.SHARES[pages.CAMPAIGN], name=pages.CAMPAIGN)

    def _flight(self) -> rrb.Container:
        rrb, readout = self.rrb, self._text("Readout")
        afar = [] if self.deploy is None else [self._descent()]
        around = rrb.Tabs(*afar, self._whole(), self._globe(), active_tab=0)
        middle = rrb.Vertical(readout, around, row_shares=[5, 2])
        return self._beside("Flight", self._chase(), middle)

    def _entry(self) -> rrb.Container:
        rrb = self.rrb
        below = rrb.Tabs(self._globe(), self._whole(), active_tab=0)
        left = rrb.Vertical(self._body(), below, row_shares=[1, 1])
        return self._beside("Entry", left)

    def _parachute(self) -> rrb.Container:
        rrb = self.rrb
        others = rrb.Vertical(self._away(), self._descent(), row_shares=[1, 1])
        left = rrb.Horizontal(self._chase(), others, column_shares=[1, 1])
        return self._beside("Parachute", left)

    def _powered(self) -> rrb.Container:
        rrb = self.rrb
        below = rrb.Tabs(self._landing(), self._site(), self._away(), active_tab=0)
        left = rrb.Vertical(self._chase(), below, row_shares=[3, 2])
        return self._beside(pages.POWERED, left)

    def _hazards(self) -> rrb.Container:
        """Page on hazards: the scanned ground from above, the chase view, and the landed vehicle."""
        rrb, motion = self.rrb, self.motion
        row = int(np.searchsorted(motion.t, self.flight.when["scan"]).clip(0, max(len(motion.t) - 1, 0)))
        scanned = motion.centre[row] if len(motion.t) else np.zeros(3)
        right = rrb.Vertical(self._chase(), self._site(), row_shares=[1, 1])
        return rrb.Horizontal(self._above(scanned), right, column_shares=[1, 1], name=pages.HAZARDS)

    def _tour(self) -> rrb.Container:
        """The director's picture and the readout without title bars, and nothing else."""
        readout = self._text("Readout", titlebar=False)
        return self.rrb.Horizontal(self._director(), readout, column_shares=[4, 1], name=pages.TOUR)

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
        return self._beside("Control", rrb.Tabs(*planes, active_tab=0))

    def _navigation(self) -> rrb.Container:
        rrb, lanes = self.rrb, dict[str, list[str]]()
        for one in self.flight.instruments:
            lanes.setdefault(pages.INSTRUMENTS[one.kind], []).append(pages.lane_of(one.kind, one.name))
        views = [self._states(title, names, pages.NAVIGATION) for title, names in lanes.items()]
        below = rrb.Tabs(*reversed(views), active_tab=0)
        left = rrb.Vertical(self._chase(with_beams=True), below, row_shares=[3, 2])
        return self._beside(pages.NAVIGATION, left)

    def _thrusters(self) -> rrb.Container:
        rrb, names = self.rrb, sorted(self.flight.jets)
        half = (len(names) + 1) // 2
        lanes = rrb.Horizontal(*(self._jets(some) for some in (names[:half], names[half:])))
        views = [self._body(), *self._plots(pages.THRUSTERS)]
        right = rrb.Vertical(*views, row_shares=[2] + [1] * (len(views) - 1))
        return rrb.Horizontal(lanes, right, column_shares=pages.SHARES[pages.THRUSTERS], name=pages.THRUSTERS)

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
        if (near := pages.AROUND_NOW.get(page)) is not None:
            edge, first, last = rrb.TimeRangeBoundary.cursor_relative, -near, near
        else:
            edge, (first, last) = rrb.TimeRangeBoundary.absolute, self.spans.get(page, self.span)
            last += 0.02 * (last - first)  # or a label at the end would be cut off
        return rrb.TimeAxis(view_range=rrb.TimeRange(start=edge(seconds=first), end=edge(seconds=last)))

    def _plot(self, plot: Plot, page: str, count: int) -> rrb.TimeSeriesView:
        """One of the ``count`` plots of a page; if the page shows the time around the present, its curves end
        before its legend.
        """
        rrb, near, fitted = self.rrb, pages.AROUND_NOW.get(page), self.frames.get((page, plot.key))
        names = [name for label in self.plotted for name in legend(plot, label)]
        until = (1.0 - 2.0 * legend_share(page, count, names)[0] * (len(names) > 1)) * (near or 0.0)
        return rrb.TimeSeriesView(
            origin="/plots",
            name=plot.label[0].upper() + plot.label[1:],
            contents=[f"/plots/{plot.key}/**"],
            axis_x=self._axis(page),
            axis_y=rrb.ScalarAxis(range=fitted.axis) if fitted else None,
            plot_legend=rrb.PlotLegend(
                corner=rrb.Corner2D[fitted.corner if fitted else "RightTop"], visible=len(names) > 1
            ),
            time_ranges=None if near is None else self._window(near, until),
        )

    def _plots(self, page: str) -> list[rrb.TimeSeriesView]:
        """The plots of a page that have data."""
        found = [self.plots[plot.key] for plot in pages.PAGES[page] if plot.key in self.plots]
        return [self._plot(plot, page, len(found)) for plot in found]

    def _beside(self, page: str, *views: rrb.View | rrb.Container) -> rrb.Container:
        """A page: some views, and its plots at their right."""
        plots = self._plots(page)
        columns = pages.plot_columns(page, len(plots))
        grid = self.rrb.Grid(*plots, grid_columns=columns, name=f"{page} plots")
        return self.rrb.Horizontal(*views, grid, column_shares=pages.SHARES[page], name=page)

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
        **more: Any,
    ) -> rrb.Spatial3DView:
        """View of the site without the entities ``hidden``, and without ``not_of_others`` of the flights that
        ``origin`` does not belong to.
        """
        excluded = [f"- {root}/{part}/**" for root in self.roots for part in hidden]
        others = [root for root in self.roots if f"{root}/{origin.rpartition('/')[2]}" != origin]
        excluded += [f"- {root}/{part}/**" for root in others for part in not_of_others]
        excluded += [f"/site/labels/{name}" for name in labels]
        trails = {f"{root}/trail": self._window(TRAIL_S) for root in self.roots}
        return self._scene(name, origin, ["/site/**", *excluded], place, target, overrides=trails, **more)

    def _chase(self, with_beams: bool = False) -> rrb.Spatial3DView | rrb.Grid:
        """View that follows vehicle and parachute; several flights side by side."""
        hidden = _NOT_CHASE if with_beams else (*_NOT_CHASE, _BEAMS)
        return self._each("camera", "Chase", hidden, pages.EYE)

    def _director(self) -> rrb.Spatial3DView | rrb.Grid:
        """View of the director's camera; several flights side by side, under their names."""
        hidden, titled = (*_NOT_CHASE, "trail", *_AIDS, *_OWN), len(self.labels) > 1
        return self._each("tour", "Tour", hidden, pages.TOUR_EYE, titlebar=titled)

    def _away(self) -> rrb.Spatial3DView:
        """View that follows the part that was released last."""
        return self._view(
            "What falls away", "/site/camera_away", (*_NOT_CHASE, _BEAMS, *_OWN), pages.EYE, np.zeros(3)
        )

    def _each(
        self, camera: str, name: str, hidden: Sequence[str], eye: np.ndarray, **more: Any
    ) -> rrb.Spatial3DView | rrb.Grid:
        """View from the same camera of each flight, side by side."""
        titles, own = [f"{name}: {label}" if label else name for label in self.labels], (*_OWN, "camera/name")
        views = [
            self._view(title, f"{root}/{camera}", hidden, eye, np.zeros(3), not_of_others=own, **more)
            for root, title in zip(self.roots, titles, strict=True)
        ]
        return views[0] if len(views) == 1 else self.rrb.Grid(*views, name=name)

    def _body(self) -> rrb.Spatial3DView:
        """The vehicle with its frames and forces."""
        name = f"Body and forces: {self.scales}" if self.scales else "Body and frames"
        place = pages.body_eye(self.start, self.end, self.motion.shape.size)
        return self._scene(
            name,
            "/site/near",
            ["/site/vehicle/**", "/site/near/**", f"- /site/{_BEAMS}/**"],
            place,
            np.zeros(3),
        )

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

    def _footprint(self) -> rrb.Spatial3DView:
        """The landing points of a campaign and the site, from above, north up."""
        assert self.ensemble is not None
        points = np.append(self.ensemble.landings, np.zeros((1, 3)), axis=0)
        low, high = points.min(axis=0), points.max(axis=0)
        middle, height = 0.5 * (low + high), 1.5 * float((high - low)[:2].max()) + 1e3
        place = middle + [0.0, -0.02 * height, height]
        hidden = (*_NOT_AFAR, *_FLYING)
        return self._view("Landing footprint", "/site", hidden, place, middle, ["target", "worst/**"])

    def _landing(self) -> rrb.Spatial3DView:
        """The last kilometre, from the side."""
        place, target = self.end + [700.0, 500.0, 420.0], self.end + [0.0, 0.0, 330.0]
        return self._view("Landing", "/site", _NOT_AFAR, place, target, ["**"])

    def _site(self) -> rrb.Spatial3DView:
        """The vehicle where it comes to rest."""
        end, hidden = self.end, (*_NOT_SITE, _KEY)
        return self._view("Site", "/site", hidden, end + [16.0, -26.0, 9.0], end)

    def _above(self, scanned: np.ndarray) -> rrb.Spatial3DView:
        """The ground below the hover, north up."""
        place, target = scanned - [0.0, 20.0, 20.0], scanned - [0.0, 0.0, 100.0]
        hidden = (*_NOT_SITE, "drop_line", "trail", "sky")
        return self._view("Hazards from above", "/site", hidden, place, target)

    def _globe(self) -> rrb.Spatial3DView:
        """The planet, from above the middle of the path; km in F."""
        middle = self.motion.site.in_F(0.5 * (self.start + self.end)) / 1e3
        return self._scene("Globe", "/globe", ["$origin/**"], 2.3 * middle, 0.0 * middle)

    def _window(self, seconds: float, after: float = 0.0) -> rrb.VisibleTimeRanges:
        """The time (s) from before to after the cursor."""
        edge = self.rrb.TimeRangeBoundary.cursor_relative
        span = self.rrb.VisibleTimeRange(
            pages.TIMELINE, start=edge(seconds=-seconds), end=edge(seconds=after)
        )
        return self.rrb.VisibleTimeRanges(span)
