"""The arrangement of the views: one page for each part of a flight, its phases and the events below."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from edl6dof.replay.views.scene_views import SPACE, TIMELINE, Shown, Views, window
from edl6dof.report import catalogue as p
from edl6dof.report.figure import BLACK, GREEN, GREY, ORANGE, PURPLE, SERIES, SKY, VERMILION, rgb

if TYPE_CHECKING:
    import rerun.blueprint as rrb

#: Colours of phases, in their order, and of several flights in a recording.
PHASES = tuple(rgb(colour) for colour in (*SERIES, GREY))
FLIGHTS = tuple(rgb(colour) for colour in (BLACK, VERMILION, SKY, GREEN, ORANGE, PURPLE))
#: Titles of the thruster plots by group.
GROUPS = {"horizontal": "Horizontal", "axial": "Axial", "attitude": "Attitude", "fine": "Fine"}
#: The pages of powered descent, of the choice of a spot, of flights that navigate with instruments, of the
#: thrusters, and of the scripted camera.
POWERED, HAZARDS, NAVIGATION, THRUSTERS, TOUR = (
    "Powered descent", "Hazards", "Navigation", "Thrusters", "Tour",
)  # fmt: skip
#: All pages, in their order.
TITLES = ("Flight", "Entry", "Parachute", POWERED, HAZARDS, "Control", NAVIGATION, THRUSTERS, TOUR)
#: Plots by page.
PAGES: dict[str, tuple[p.Plot, ...]] = {
    "Flight": (p.ALTITUDE, p.SPEED, p.LOAD, p.PROPELLANT),
    "Entry": (p.BANK, p.ALPHA, p.DRAG, p.BETA, p.RANGE, p.CROSSRANGE, p.MACH, p.HEAT, p.PRESSURE),
    "Parachute": (p.ALTITUDE, p.MACH, p.TENSION, p.PRESSURE, p.TOTAL_ALPHA, p.RATES),
    POWERED: (p.HEIGHT, p.VELOCITY, p.THRUST, p.TILT, p.OFFSET, p.PROPELLANT, p.TO_GO, p.MASS),
    "Control": (p.ERROR, p.RATES, *p.TORQUES, p.FORCE, *p.DEMAND),
    NAVIGATION: (
        *(p.POSITION_ERROR, p.VELOCITY_ERROR, p.ATTITUDE_ERROR, p.INNOVATION, p.HEIGHT_ERROR),
        *p.VELOCITY_ERROR.apart("backshell"),
    ),
    THRUSTERS: (p.DIAGNOSIS, p.PROPELLANT),
}
#: Pages of a vehicle with thrusters.
OF_JETS = ("Control", THRUSTERS)
#: Pages that show fast things: their plots end so long (s) before and after the present.
AROUND_NOW, NEAR_S = ("Control", NAVIGATION, THRUSTERS), 60.0
#: Lanes of every page.
PHASE, VEHICLE, ENGINE = "Phase", "Vehicle", "Engine"
#: Titles of the lanes of instruments by kind.
INSTRUMENTS = {"gyro": "Gyros", "accelerometer": "Accelerometers", "beam": "Radar beams"}


class Layout:
    """Builds the blueprint of one recording."""

    def __init__(self, flown: Shown) -> None:
        import rerun.blueprint as rrb

        self.rrb, self.flown, self.views = rrb, flown, Views(flown)
        self.spans = spans_of(flown.span, flown.when)

    def blueprint(self, active: str = "Flight") -> rrb.Blueprint:
        """All pages, that named ``active`` in front; the tour alone, as a film is."""
        rrb = self.rrb
        clock = rrb.TimePanel(timeline=TIMELINE, state="collapsed", playback_speed=4.0, play_state="playing")
        if active == TOUR:
            top = rrb.TopPanel(state="hidden")
            return rrb.Blueprint(
                self._tour(), clock, top, auto_views=False, auto_layout=False, collapse_panels=True
            )
        possible = (
            *(self._flight(), self._entry(), self._parachute(), self._powered()),
            *(self._hazards(), self._control(), self._navigation(), self._thrusters()),
        )
        pages = [self._with_lanes(page) for page in possible if page is not None]
        pages.append(self._tour())
        names = [str(page.name) for page in pages]
        return rrb.Blueprint(
            rrb.Tabs(*pages, active_tab=names.index(active) if active in names else 0),
            clock,
            auto_views=False,
            auto_layout=False,
            collapse_panels=True,
        )

    def _with_lanes(self, page: rrb.Container) -> rrb.Container:
        """A page with the phases of its own time and the events below."""
        rrb = self.rrb
        name = str(page.name)
        below = rrb.Horizontal(
            self._lanes(name),
            rrb.Tabs(
                rrb.TextDocumentView(origin="/events", name="Events"),
                rrb.TextDocumentView(origin="/legend", name="Legend"),
                active_tab=0,
            ),
            column_shares=[11, 8],
        )
        return rrb.Vertical(page, below, row_shares=[7, 2], name=name)

    def _flight(self) -> rrb.Container:
        rrb = self.rrb
        readout = rrb.TextDocumentView(origin="/readout", name="Readout")
        if self.flown.ensemble:
            readout = rrb.Vertical(rrb.TextDocumentView(origin="/campaign", name="Campaign"), readout)
        around = rrb.Tabs(
            *[view for view in (self.views.afar("Descent"), self.views.whole()) if view is not None],
            self.views.globe(),
            active_tab=0,
        )
        middle = rrb.Vertical(readout, around, row_shares=[5, 2])
        return rrb.Horizontal(
            self.views.chase(), middle, self._grid("Flight", 1), column_shares=[9, 5, 10], name="Flight"
        )

    def _entry(self) -> rrb.Container:
        rrb = self.rrb
        left = rrb.Vertical(
            self.views.body(),
            rrb.Tabs(self.views.globe(), self.views.whole(), active_tab=0),
            row_shares=[1, 1],
        )
        return rrb.Horizontal(left, self._grid("Entry"), column_shares=[5, 8], name="Entry")

    def _parachute(self) -> rrb.Container | None:
        if self.flown.deploy is None:
            return None
        rrb = self.rrb
        beside = rrb.Vertical(self.views.away(), self.views.afar("Descent"), row_shares=[1, 1])
        left = rrb.Horizontal(self.views.chase(), beside, column_shares=[1, 1])
        return rrb.Horizontal(left, self._grid("Parachute"), column_shares=[11, 8], name="Parachute")

    def _powered(self) -> rrb.Container | None:
        if "backshell" not in self.flown.when:
            return None
        rrb = self.rrb
        left = rrb.Vertical(
            self.views.chase(),
            rrb.Tabs(self.views.landing(), self.views.site(), self.views.away(), active_tab=0),
            row_shares=[3, 2],
        )
        return rrb.Horizontal(left, self._grid(POWERED), column_shares=[5, 8], name=POWERED)

    def _hazards(self) -> rrb.Container | None:
        if self.flown.scanned is None:
            return None
        rrb = self.rrb
        right = rrb.Vertical(self.views.chase(), self.views.site(), row_shares=[1, 1])
        return rrb.Horizontal(self.views.above(self.flown.scanned), right, column_shares=[1, 1], name=HAZARDS)

    def _tour(self) -> rrb.Container:
        """The director's picture and the readout, and nothing else."""
        rrb = self.rrb
        readout = rrb.TextDocumentView(origin="/readout", name="Readout")
        return rrb.Horizontal(self.views.tour(), readout, column_shares=[4, 1], name=TOUR)

    def _control(self) -> rrb.Container | None:
        if not self.flown.jets:
            return None
        rrb = self.rrb
        bounds = rrb.VisualBounds2D(x_range=[-1.25, 1.1], y_range=[-0.78, 0.92])
        recent = window(rrb, 12.0)
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
        return rrb.Horizontal(
            rrb.Tabs(*planes, active_tab=0), self._grid("Control"), column_shares=[2, 5], name="Control"
        )

    def _navigation(self) -> rrb.Container | None:
        if not self.flown.instruments:
            return None
        rrb = self.rrb
        lanes = [
            self._switched(INSTRUMENTS[kind], [lane_of(kind, name) for name in names], NAVIGATION)
            for kind, names in self.flown.instruments.items()
        ]
        left = rrb.Vertical(self.views.chase(), rrb.Tabs(*reversed(lanes), active_tab=0), row_shares=[3, 2])
        return rrb.Horizontal(left, self._grid(NAVIGATION), column_shares=[4, 9], name=NAVIGATION)

    def _thrusters(self) -> rrb.Container | None:
        if not self.flown.jets:
            return None
        rrb = self.rrb
        names, half = sorted(self.flown.jets), (len(self.flown.jets) + 1) // 2
        lanes = rrb.Horizontal(self._jets(names[:half]), self._jets(names[half:]))
        plots = [
            self._plot(f"thruster_duty/{g}", f"{GROUPS[g]} thrusters, duty (0 to 1)", THRUSTERS)
            for g in self.flown.groups
        ]
        plots += [
            self._plot(plot.key, _title(plot), THRUSTERS)
            for plot in PAGES[THRUSTERS]
            if plot.key in self.flown.plots
        ]
        right = rrb.Vertical(self.views.body(), rrb.Grid(*plots, grid_columns=2), row_shares=[4, 5])
        return rrb.Horizontal(lanes, right, column_shares=[3, 5], name=THRUSTERS)

    def _jets(self, names: Sequence[str]) -> rrb.StateTimelineView:
        title = f"Thrusters {names[0]} to {names[-1]}" if names else "Thrusters"
        return self._switched(title, [lane_of("thruster", name) for name in names], THRUSTERS)

    def _switched(self, title: str, lanes: Sequence[str], page: str) -> rrb.StateTimelineView:
        """Some lanes in the time of a page."""
        return self.rrb.StateTimelineView(contents=lanes, name=title, time_view=self._axis(page))

    def _axis(self, page: str) -> rrb.TimeAxis:
        rrb = self.rrb
        if page in AROUND_NOW:
            edge = rrb.TimeRangeBoundary.cursor_relative
            return rrb.TimeAxis(
                view_range=rrb.TimeRange(start=edge(seconds=-NEAR_S), end=edge(seconds=NEAR_S))
            )
        first, last = self.spans.get(page, self.flown.span)
        last += 0.02 * (last - first)  # or a label at the end would be cut off
        edge = rrb.TimeRangeBoundary.absolute
        return rrb.TimeAxis(view_range=rrb.TimeRange(start=edge(seconds=first), end=edge(seconds=last)))

    def _plot(self, entity: str, title: str, page: str, legend: bool = True) -> rrb.TimeSeriesView:
        rrb = self.rrb
        corner = rrb.PlotLegend(corner=rrb.Corner2D.RightTop, visible=legend or len(self.flown.labels) > 1)
        return rrb.TimeSeriesView(
            origin="/plots",
            name=title,
            contents=[f"/plots/{entity}/**"],
            axis_x=self._axis(page),
            axis_y=self._values(page, entity),
            plot_legend=corner,
        )

    def _values(self, page: str, entity: str) -> rrb.ScalarAxis | None:
        """Axis of what a plot shows in the time of a page."""
        ends = self.flown.ranges.get((page if page in self.spans else "Flight", entity))
        return None if ends is None else self.rrb.ScalarAxis(range=ends)

    def _grid(self, page: str, columns: int = 2) -> rrb.Grid:
        views = [
            self._plot(plot.key, _title(plot), self._time_of(page, plot), len(plot.channels) > 1)
            for plot in PAGES[page]
            if plot.key in self.flown.plots
        ]
        columns = 3 if len(views) > 8 else columns
        return self.rrb.Grid(*views, grid_columns=columns, name=f"{page} plots")

    def _time_of(self, page: str, plot: p.Plot) -> str:
        """The page whose time a plot shows: that of powered descent where it means nothing before, though its
        own page has no time of its own.
        """
        return POWERED if plot.since == "backshell" and page not in self.spans else page

    def _lanes(self, page: str) -> rrb.StateTimelineView:
        """Lanes of the time that the page's plots show, in which each name has the room it needs."""
        import rerun as rr

        page = page if page in self.spans else "Flight"
        own = self.flown.lanes.get(page, {})
        return self.rrb.StateTimelineView(
            contents=[f"/{name}" for name in (PHASE, VEHICLE, ENGINE)],
            name="Phases",
            time_view=self._axis(page),
            overrides={
                f"/{name}": rr.StateConfiguration.from_fields(labels=labels) for name, labels in own.items()
            },
        )


def _title(plot: p.Plot) -> str:
    return plot.label[0].upper() + plot.label[1:]


def lane_of(kind: str, name: str) -> str:
    """Entity of the lane of a thruster or an instrument."""
    return f"/{kind.capitalize()}-{name}"


def spans_of(flown_s: tuple[float, float], when: Mapping[str, float]) -> dict[str, tuple[float, float]]:
    """First and last time (s) of the pages that do not show the whole flight: of those parts that it has."""
    first, last = flown_s
    mortar, shell = when.get("mortar", last), when.get("backshell", last)
    spans = {
        "Entry": (first, min(mortar + 3.0, last)),
        "Parachute": (min(mortar, last - 1.0) - 3.0, min(shell + 3.0, last)),
        POWERED: (min(shell - 5.0, last - 1.0), last),
    }
    begun = {"Entry": True, "Parachute": "mortar" in when, POWERED: "backshell" in when}
    return {page: span for page, span in spans.items() if begun[page]}
