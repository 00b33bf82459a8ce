"""What the replay shows and where: the plots, the colours, the arrangement of the views."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    import rerun.blueprint as rrb

    Overview = Callable[..., rrb.Spatial3DView]

RGB = tuple[int, int, int]

TIMELINE = "sim_time"
#: Colours that stay apart on a dark ground.
SERIES: tuple[RGB, ...] = ((86, 180, 233), (240, 160, 60), (120, 220, 140), (230, 110, 170), (240, 228, 90), (160, 140, 240))
PHASES: tuple[RGB, ...] = (
    (90, 140, 250), (250, 120, 60), (240, 215, 80), (90, 210, 140),
    (70, 200, 220), (190, 130, 245), (250, 130, 180), (200, 200, 200),
)  # fmt: skip
SKY: RGB = (74, 52, 42)
SPACE: RGB = (22, 17, 18)


class Plot(NamedTuple):
    """One plot: its entity, title with unit, telemetry columns with their names, and the event after which it means nothing."""

    entity: str
    title: str
    series: dict[str, str]
    scale: float = 1.0
    until: str = ""
    since: str = ""


#: Plots by tab.
PLOTS: dict[str, tuple[Plot, ...]] = {
    "Flight": (
        Plot("altitude_km", "Altitude (km)", {"truth.altitude_m": "above ellipsoid", "truth.height_m": "above ground"}, 1e-3),
        Plot("speed_km_s", "Speed over ground (km/s)", {"truth.speed_m_s": "speed"}, 1e-3),
        Plot("mach", "Mach number (1)", {"truth.mach": "Mach"}),
        Plot("dynamic_pressure_kpa", "Dynamic pressure (kPa)", {"truth.dynamic_pressure_pa": "dynamic pressure"}, 1e-3),
        Plot("load_g0", "Load (Earth g)", {"truth.load_g0": "sensed acceleration"}),
        Plot("heat_flux_w_cm2", "Heat flux (W/cm²)", {"truth.heat_flux_w_cm2": "stagnation point"}, until="mortar"),
    ),
    "Guidance": (
        Plot("bank_deg", "Bank (deg)", {"guide.bank_deg": "commanded", "truth.bank_deg": "flown"}, until="mortar"),
        Plot("drag_m_s2", "Drag (m/s²)", {"guide.reference_drag_m_s2": "reference", "nav.drag_m_s2": "measured"}, until="mortar"),
        Plot("range_to_go_km", "Range to go (km)", {"guide.range_to_go_km": "range to go"}, until="mortar"),
        Plot("crossrange_km", "Crossrange (km)", {"guide.crossrange_km": "crossrange, right +"}, until="mortar"),
    ),
    "Attitude": (
        Plot("angle_of_attack_deg", "Air angles (deg)", {"truth.alpha_deg": "α", "truth.beta_deg": "β"}, until="backshell"),
        Plot(
            "body_rate_deg_s",
            "Body rate (deg/s)",
            {"truth.rate_p_deg_s": "p", "truth.rate_q_deg_s": "q", "truth.rate_r_deg_s": "r"},
        ),
        Plot(
            "attitude_error_deg",
            "Attitude error (deg)",
            {"control.error_roll_deg": "roll", "control.error_pitch_deg": "pitch", "control.error_yaw_deg": "yaw"},
        ),
        Plot("tilt_deg", "Tilt of the thrust axis (deg)", {"truth.tilt_deg": "from the vertical"}, since="mortar"),
    ),
    "Parachute": (
        Plot("riser_tension_kn", "Riser tension (kN)", {"truth.riser_tension_n": "tension"}, 1e-3, "backshell", "mortar"),
        Plot(
            "total_alpha_deg",
            "Total angle of attack (deg)",
            {"truth.total_alpha_deg": "total"},
            until="backshell",
            since="mortar",
        ),
    ),
    "Powered descent": (
        Plot("height_m", "Height above ground (m)", {"truth.height_m": "height"}, since="backshell"),
        Plot(
            "velocity_m_s",
            "Velocity (m/s)",
            {"truth.v_north_m_s": "north", "truth.v_east_m_s": "east", "truth.v_down_m_s": "down"},
            since="backshell",
        ),
        Plot(
            "engine_thrust_kn",
            "Engine thrust (kN)",
            {"guide.thrust_n": "commanded", "truth.engine_thrust_n": "delivered"},
            1e-3,
            since="backshell",
        ),
        Plot("propellant_kg", "Propellant (kg)", {"truth.propellant_kg": "left"}),
        Plot("time_to_go_s", "Time to go (s)", {"guide.time_to_go_s": "powered guidance"}, since="backshell"),
        Plot("mass_kg", "Mass (kg)", {"truth.mass_kg": "true", "nav.mass_kg": "believed"}, since="backshell"),
    ),
}

#: Titles of the thruster plots by group.
GROUPS = {"horizontal": "Horizontal", "axial": "Axial", "attitude": "Attitude", "fine": "Fine"}


def blueprint(
    groups: Sequence[str],
    span: dict[str, tuple[float, float]],
    touchdown: np.ndarray,
    start: np.ndarray,
    deploy: np.ndarray | None,
) -> rrb.Blueprint:
    """The arrangement of the views.

    Args:
        groups: thruster groups that the vehicle has.
        span: first and last time, s, of the axis of each tab ("" for the whole flight).
        touchdown: end of the flight, m in L.
        start: its beginning, m in L.
        deploy: place of the parachute deployment, m in L, if any.
    """
    import rerun.blueprint as rrb

    def axis(tab: str) -> rrb.TimeAxis:
        first, last = span.get(tab, span[""])
        edge = rrb.TimeRangeBoundary.absolute
        return rrb.TimeAxis(view_range=rrb.TimeRange(start=edge(seconds=first), end=edge(seconds=last)))

    def plot(entity: str, title: str, tab: str, legend: bool = True) -> rrb.TimeSeriesView:
        corner = rrb.PlotLegend(corner=rrb.Corner2D.RightTop, visible=legend)
        return rrb.TimeSeriesView(origin="/plots", name=title, contents=[f"/plots/{entity}"], axis_x=axis(tab), plot_legend=corner)

    trail = rrb.VisibleTimeRanges(
        rrb.VisibleTimeRange(
            TIMELINE, start=rrb.TimeRangeBoundary.cursor_relative(seconds=-60.0), end=rrb.TimeRangeBoundary.cursor_relative()
        )
    )
    chase = rrb.Spatial3DView(
        origin="/site/camera",
        contents=["/site/**", "- /site/path/**", "- /site/markers/**", "- /site/labels/**", "- /site/drop_line"],
        name="Chase",
        background=rrb.Background(color=SKY),
        line_grid=False,
        overrides={"/site/trail": trail},
        eye_controls=rrb.EyeControls3D(position=(2.6, 9.2, 3.0), look_target=(0.0, 0.0, -0.2), eye_up=(0.0, 0.0, 1.0)),
    )

    def overview(name: str, place: np.ndarray, target: np.ndarray, labels: str = "target") -> rrb.Spatial3DView:
        return rrb.Spatial3DView(
            origin="/site",
            contents=["/site/**", "- /site/camera/**", "- /site/velocity", "- /site/labels/**", f"/site/labels/{labels}"],
            name=name,
            background=rrb.Background(color=SPACE),
            line_grid=False,
            overrides={"/site/trail": trail},
            eye_controls=rrb.EyeControls3D(position=place, look_target=target, eye_up=(0.0, 0.0, 1.0)),
        )

    views = [_entry_view(overview, start, touchdown)]
    if deploy is not None:
        views.insert(0, _descent_view(overview, deploy, touchdown))
        views.append(overview("Landing", touchdown + [700.0, 500.0, 420.0], touchdown + [0.0, 0.0, 330.0], "**"))
    tabs = [
        rrb.Grid(
            *[plot(p.entity, p.title, name, len(p.series) > 1) for p in plots],
            grid_columns=1 if len(plots) < 3 else 2,
            name=name,
        )
        for name, plots in PLOTS.items()
    ]
    if groups:
        jets = [plot(f"thruster_duty/{group}", f"{GROUPS.get(group, group)} thrusters, duty (0 to 1)", "") for group in groups]
        tabs.append(rrb.Grid(*jets, grid_columns=2, name="Thrusters"))
    lanes = rrb.StateTimelineView(origin="/states", name="Phases", time_view=axis(""))
    columns = rrb.TextLogColumns(text_log_columns=["body"])
    events = rrb.TextLogView(origin="/events", name="Events", columns=columns)
    right = rrb.Vertical(rrb.Tabs(*views, active_tab=0), rrb.Tabs(*tabs, active_tab=0), row_shares=[2, 3])
    readout = rrb.TextDocumentView(origin="/readout", name="Readout")
    body = rrb.Spatial3DView(
        origin="/site/vehicle",
        contents=["/site/vehicle/**"],
        name="Body",
        background=rrb.Background(color=SPACE),
        line_grid=False,
        eye_controls=rrb.EyeControls3D(position=(2.6, 3.2, -2.6), look_target=(-1.0, 0.0, 0.0), eye_up=(-1.0, 0.0, 0.0)),
    )
    left = rrb.Horizontal(chase, rrb.Vertical(readout, body, row_shares=[5, 3]), column_shares=[7, 2])
    return rrb.Blueprint(
        rrb.Vertical(
            rrb.Horizontal(left, right, column_shares=[11, 8]),
            rrb.Horizontal(lanes, events, column_shares=[11, 8]),
            row_shares=[9, 2],
        ),
        rrb.TimePanel(timeline=TIMELINE, state="collapsed", playback_speed=4.0, play_state="playing"),
        auto_views=False,
        auto_layout=False,
        collapse_panels=True,
    )


def _entry_view(overview: Overview, start: np.ndarray, end: np.ndarray) -> rrb.Spatial3DView:
    """The whole flight from the side, a little from above."""
    along = end - start
    length = float(np.linalg.norm(along)) or 1.0
    side = np.array([along[1], -along[0], 0.0])
    side /= np.linalg.norm(side) or 1.0
    middle = start + 0.5 * along
    return overview("Whole flight", middle - 0.62 * length * side + [0.0, 0.0, 0.20 * length], middle - [0.0, 0.0, 0.02 * length])


def _descent_view(overview: Overview, deploy: np.ndarray, end: np.ndarray) -> rrb.Spatial3DView:
    """From parachute to ground, from the side."""
    along = end - deploy
    size = float(np.linalg.norm(along)) or 1.0
    side = np.array([along[1], -along[0], 0.0])
    side /= np.linalg.norm(side) or 1.0
    middle = deploy + 0.5 * along
    return overview("Descent", middle - 1.25 * size * side + [0.0, 0.0, 0.12 * size], middle - [0.0, 0.0, 0.03 * size])
