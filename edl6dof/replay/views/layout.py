"""The arrangement of the views: one page for each part of a flight, phases and events below all of them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from edl6dof.replay.views.panels import GROUPS, NAVIGATION, PAGES, RGB, Plot

if TYPE_CHECKING:
    import rerun.blueprint as rrb

TIMELINE = "sim_time"
PHASES: tuple[RGB, ...] = (
    (90, 140, 250), (250, 120, 60), (240, 215, 80), (90, 210, 140),
    (70, 200, 220), (190, 130, 245), (250, 130, 180), (200, 200, 200),
)  # fmt: skip
#: One colour for each of several flights in a recording.
FLIGHTS: tuple[RGB, ...] = (
    (255, 255, 255),
    (255, 92, 92),
    (92, 190, 255),
    (140, 230, 120),
    (240, 200, 70),
    (210, 140, 255),
)
SPACE: RGB = (10, 9, 12)
#: The page of powered descent, and the titles of the lanes of instruments by kind.
POWERED = "Powered descent"
INSTRUMENTS = {"gyro": "Gyros", "accelerometer": "Accelerometers", "beam": "Radar beams"}
#: What only other views show.
_NOT_CHASE = (
    "campaign",
    "path",
    "markers",
    "labels",
    "drop_line",
    "ground_track",
    "arrows",
    "velocity_frame",
    "vehicle/attitude_frame",
)
_NOT_AFAR = ("vehicle/failed", "arrows", "velocity_frame", "vehicle/attitude_frame", "sky", "labels")


class Shown(NamedTuple):
    """What the arrangement depends on.

    Attributes:
        span: first and last time, s, of the whole flight.
        when: time, s, of the events.
        start, end: first and last place, m in L.
        deploy: place of the parachute deployment, m in L, if any.
        plots: entities of the plots that have data.
        groups: thruster groups.
        jets: names of the thrusters.
        instruments: kinds of instruments that navigation has, by which their lanes are sorted.
        flights: number of flights in the recording.
        ensemble: whether a campaign's trajectories are in it.
        globe_eye, globe_target: whence and whither the globe is seen, km in F.
    """

    span: tuple[float, float]
    when: dict[str, float]
    start: np.ndarray
    end: np.ndarray
    deploy: np.ndarray | None
    plots: frozenset[str]
    groups: tuple[str, ...]
    jets: tuple[str, ...]
    instruments: tuple[str, ...]
    flights: int
    ensemble: bool
    globe_eye: np.ndarray
    globe_target: np.ndarray


class Layout:
    """Builds the blueprint of one recording."""

    def __init__(self, flown: Shown) -> None:
        import rerun.blueprint as rrb

        self.rrb, self.flown = rrb, flown
        first, last = flown.span
        mortar = flown.when.get("mortar", last)
        shell = flown.when.get("backshell", last)
        self._spans = {
            "Entry": (first, min(mortar + 3.0, last)),
            "Parachute": (min(mortar, last - 1.0) - 3.0, min(shell + 3.0, last)),
        }
        self._spans[POWERED] = (min(shell - 5.0, last - 1.0), last)

    def blueprint(self, active: str = "Flight") -> rrb.Blueprint:
        """All pages, that named ``active`` in front."""
        rrb = self.rrb
        possible = (
            self._flight(),
            self._entry(),
            self._parachute(),
            self._powered(),
            self._control(),
            self._navigation(),
            self._thrusters(),
        )
        pages = [page for page in possible if page is not None]
        names = [str(page.name) for page in pages]
        below = rrb.Horizontal(self._lanes(), self._events(), column_shares=[11, 8])
        return rrb.Blueprint(
            rrb.Vertical(
                rrb.Tabs(*pages, active_tab=names.index(active) if active in names else 0),
                below,
                row_shares=[9, 2],
            ),
            rrb.TimePanel(timeline=TIMELINE, state="collapsed", playback_speed=4.0, play_state="playing"),
            auto_views=False,
            auto_layout=False,
            collapse_panels=True,
        )

    def _flight(self) -> rrb.Container:
        rrb = self.rrb
        readout = rrb.TextDocumentView(origin="/readout", name="Readout")
        if self.flown.ensemble:
            readout = rrb.Vertical(rrb.TextDocumentView(origin="/campaign", name="Campaign"), readout)
        left = rrb.Horizontal(self._chase(), readout, column_shares=[7, 2])
        views = rrb.Tabs(self._afar("Descent") or self._whole(), self._whole(), self._globe(), active_tab=0)
        right = rrb.Vertical(views, self._grid("Flight"), row_shares=[2, 3])
        return rrb.Horizontal(left, right, column_shares=[11, 8], name="Flight")

    def _entry(self) -> rrb.Container:
        rrb = self.rrb
        left = rrb.Vertical(
            self._body(), rrb.Tabs(self._globe(), self._whole(), active_tab=0), row_shares=[1, 1]
        )
        return rrb.Horizontal(left, self._grid("Entry"), column_shares=[5, 8], name="Entry")

    def _parachute(self) -> rrb.Container | None:
        if self.flown.deploy is None:
            return None
        rrb = self.rrb
        left = rrb.Horizontal(self._chase(), self._afar("Descent"), column_shares=[1, 1])
        return rrb.Horizontal(left, self._grid("Parachute"), column_shares=[11, 8], name="Parachute")

    def _powered(self) -> rrb.Container | None:
        if "backshell" not in self.flown.when:
            return None
        rrb = self.rrb
        left = rrb.Vertical(
            self._chase(), rrb.Tabs(self._landing(), self._site(), active_tab=0), row_shares=[3, 2]
        )
        return rrb.Horizontal(left, self._grid(POWERED), column_shares=[5, 8], name=POWERED)

    def _control(self) -> rrb.Container:
        rrb = self.rrb
        bounds = rrb.VisualBounds2D(x_range=[-1.25, 1.1], y_range=[-0.78, 0.92])
        recent = self._window(12.0)
        planes = [
            rrb.Spatial2DView(
                origin=f"/phase_plane/{axis}",
                name=f"{axis.capitalize()}: error (deg), rate (deg/s)",
                background=rrb.Background(color=SPACE),
                visual_bounds=bounds,
                overrides={f"/phase_plane/{axis}/way": recent},
            )
            for axis in ("roll", "pitch", "yaw")
        ]
        return rrb.Vertical(
            rrb.Horizontal(*planes), self._grid("Control", 4), row_shares=[1, 1], name="Control"
        )

    def _navigation(self) -> rrb.Container | None:
        if not self.flown.instruments:
            return None
        rrb = self.rrb
        lanes = [
            rrb.StateTimelineView(
                origin=f"/instruments/{kind}", name=INSTRUMENTS[kind], time_view=self._axis("Flight")
            )
            for kind in self.flown.instruments
        ]
        left = rrb.Vertical(self._chase(), rrb.Tabs(*reversed(lanes), active_tab=0), row_shares=[3, 2])
        return rrb.Horizontal(left, self._grid(NAVIGATION), column_shares=[5, 8], name=NAVIGATION)

    def _thrusters(self) -> rrb.Container | None:
        if not self.flown.jets:
            return None
        rrb = self.rrb
        names, half = sorted(self.flown.jets), (len(self.flown.jets) + 1) // 2
        lanes = rrb.Horizontal(self._jets(names[:half]), self._jets(names[half:]))
        plots = [
            self._plot(f"thruster_duty/{g}", f"{GROUPS[g]} thrusters, duty (0 to 1)", "Flight")
            for g in self.flown.groups
        ]
        plots += [
            self._plot(plot.entity, plot.title, "Flight")
            for plot in PAGES["Thrusters"]
            if plot.entity in self.flown.plots
        ]
        right = rrb.Vertical(self._body(), rrb.Grid(*plots, grid_columns=2), row_shares=[2, 3])
        return rrb.Horizontal(lanes, right, column_shares=[1, 1], name="Thrusters")

    def _jets(self, names: Sequence[str]) -> rrb.StateTimelineView:
        contents, title = (
            [f"/rcs/{name}" for name in names],
            f"Thrusters {names[0]} to {names[-1]}" if names else "Thrusters",
        )
        return self.rrb.StateTimelineView(
            origin="/rcs", contents=contents, name=title, time_view=self._axis("Flight")
        )

    def _axis(self, page: str) -> rrb.TimeAxis:
        rrb = self.rrb
        first, last = self._spans.get(page, self.flown.span)
        edge = rrb.TimeRangeBoundary.absolute
        return rrb.TimeAxis(view_range=rrb.TimeRange(start=edge(seconds=first), end=edge(seconds=last)))

    def _window(self, seconds: float) -> rrb.VisibleTimeRanges:
        """Rows of the last seconds before the cursor."""
        rrb = self.rrb
        edge = rrb.TimeRangeBoundary.cursor_relative
        return rrb.VisibleTimeRanges(rrb.VisibleTimeRange(TIMELINE, start=edge(seconds=-seconds), end=edge()))

    def _plot(self, entity: str, title: str, page: str, legend: bool = True) -> rrb.TimeSeriesView:
        rrb = self.rrb
        corner = rrb.PlotLegend(corner=rrb.Corner2D.RightTop, visible=legend or self.flown.flights > 1)
        contents = [f"/plots/{entity}/**"]
        return rrb.TimeSeriesView(
            origin="/plots", name=title, contents=contents, axis_x=self._axis(page), plot_legend=corner
        )

    def _grid(self, page: str, columns: int = 2) -> rrb.Grid:
        plots: Sequence[Plot] = [plot for plot in PAGES[page] if plot.entity in self.flown.plots]
        views = [
            self._plot(plot.entity, plot.title, self._time_of(page, plot), len(plot.columns) > 1)
            for plot in plots
        ]
        return self.rrb.Grid(*views, grid_columns=columns, name=f"{page} plots")

    def _time_of(self, page: str, plot: Plot) -> str:
        """The page whose time a plot shows: that of powered descent where it means nothing before, though its
        own page is of the whole flight.
        """
        return POWERED if plot.since == "backshell" and page not in self._spans else page

    def _lanes(self) -> rrb.StateTimelineView:
        contents = ["/phase", "/configuration", "/engine"]
        return self.rrb.StateTimelineView(
            origin="/", contents=contents, name="Phases", time_view=self._axis("Flight")
        )

    def _events(self) -> rrb.TextLogView:
        columns = self.rrb.TextLogColumns(text_log_columns=["body"])
        return self.rrb.TextLogView(origin="/events", name="Events", columns=columns)

    def _roots(self) -> list[str]:
        """Entities below which each flight's own things lie."""
        return ["/site", *(f"/site/flight_{k}" for k in range(1, self.flown.flights))]

    def _view(
        self,
        name: str,
        origin: str,
        hidden: Sequence[str],
        place: np.ndarray,
        target: np.ndarray,
        labels: Sequence[str] = (),
    ) -> rrb.Spatial3DView:
        rrb = self.rrb
        excluded = [f"- {root}/{part}/**" for root in self._roots() for part in hidden] + [
            f"/site/labels/{name}" for name in labels
        ]
        return rrb.Spatial3DView(
            origin=origin,
            contents=["/site/**", *excluded],
            name=name,
            background=rrb.Background(color=SPACE),
            line_grid=False,
            overrides={f"{root}/trail": self._window(60.0) for root in self._roots()},
            eye_controls=rrb.EyeControls3D(position=place, look_target=target, eye_up=(0.0, 0.0, 1.0)),
        )

    def _chase(self) -> rrb.Spatial3DView:
        return self._view(
            "Chase", "/site/camera", _NOT_CHASE, np.array([2.6, 9.2, 2.6]), np.array([0.0, 0.0, -0.2])
        )

    def _body(self) -> rrb.Spatial3DView:
        rrb = self.rrb
        shown = ["/site/vehicle/**", "/site/arrows/**", "/site/velocity_frame/**"]
        along, length, side = _beside(self.flown.start, self.flown.end)
        place = 1.6 * along / length - 4.6 * side + [0.0, 0.0, 1.5]
        eye = rrb.EyeControls3D(position=place, look_target=(0.0, 0.0, 0.0), eye_up=(0.0, 0.0, 1.0))
        background = rrb.Background(color=SPACE)
        return rrb.Spatial3DView(
            origin="/site/near",
            contents=shown,
            name="Body, frames, forces",
            background=background,
            line_grid=False,
            eye_controls=eye,
        )

    def _whole(self) -> rrb.Spatial3DView:
        """The whole flight from the side, a little from above."""
        start, end = self.flown.start, self.flown.end
        along, length, side = _beside(start, end)
        middle = start + 0.5 * along
        place, target = (
            middle - 0.62 * length * side + [0.0, 0.0, 0.20 * length],
            middle - [0.0, 0.0, 0.02 * length],
        )
        return self._view("Whole flight", "/site", _NOT_AFAR, place, target, ["target"])

    def _afar(self, name: str) -> rrb.Spatial3DView | None:
        """From parachute to ground, from the side."""
        if self.flown.deploy is None:
            return None
        along, size, side = _beside(self.flown.deploy, self.flown.end)
        middle = self.flown.deploy + 0.5 * along
        place, target = (
            middle - 1.25 * size * side + [0.0, 0.0, 0.12 * size],
            middle - [0.0, 0.0, 0.03 * size],
        )
        return self._view(name, "/site", _NOT_AFAR, place, target, ["target"])

    def _landing(self) -> rrb.Spatial3DView:
        place, target = self.flown.end + [700.0, 500.0, 420.0], self.flown.end + [0.0, 0.0, 330.0]
        return self._view("Landing", "/site", _NOT_AFAR, place, target, ["**"])

    def _site(self) -> rrb.Spatial3DView:
        place = self.flown.end + [16.0, -26.0, 9.0]
        return self._view(
            "Site",
            "/site",
            ("arrows", "velocity_frame", "vehicle/attitude_frame", "path", "markers", "labels"),
            place,
            self.flown.end,
        )

    def _globe(self) -> rrb.Spatial3DView:
        rrb = self.rrb
        eye = rrb.EyeControls3D(
            position=self.flown.globe_eye, look_target=self.flown.globe_target, eye_up=(0.0, 0.0, 1.0)
        )
        return rrb.Spatial3DView(
            origin="/globe",
            name="Globe",
            background=rrb.Background(color=SPACE),
            line_grid=False,
            eye_controls=eye,
        )


def _beside(start: np.ndarray, end: np.ndarray) -> tuple[np.ndarray, float, np.ndarray]:
    """From start to end, its length, and a level unit vector to its right."""
    along = end - start
    length = float(np.linalg.norm(along)) or 1.0
    side = np.array([along[1], -along[0], 0.0])
    return along, length, side / (np.linalg.norm(side) or 1.0)
