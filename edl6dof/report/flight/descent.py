"""Parachute and powered descent."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from edl6dof.interface.roles import HOVER_IMAGING, begun
from edl6dof.report.figure import BLUE, GREEN, GREY, PURPLE, VERMILION, Axis, Figure, Panel, Trace
from edl6dof.report.flight.parts import Curve, has_signal, over_time, placed, stacked
from edl6dof.runs.run import Run


def parachute(run: Run) -> Iterator[Figure]:
    """From mortar fire to the release of the backshell."""
    if "mortar" not in run.when:
        return
    opening = (
        (run.t > run.when["mortar"] - 0.5)
        & (run.t < run.when["mortar"] + 8.0)
        & run.between(until="backshell")
    )
    panels = [
        over_time(run, "riser tension (kN)", [Curve("truth.riser_tension_n", "", 1e-3, VERMILION)], opening),
        over_time(run, "load (Earth g)", [Curve("truth.load_g0", "", 1.0, PURPLE)], opening),
        over_time(run, "Mach number", [Curve("truth.mach", "", 1.0, BLUE)], opening),
    ]
    yield stacked("inflation", "Parachute inflation", panels, "Mortar fire, line stretch and inflation.", 160)
    rows = run.between("mortar", "backshell")
    shown = (
        ("descent speed (m/s)", "truth.v_down_m_s", BLUE),
        ("total angle of\nattack (deg)", "truth.total_alpha_deg", VERMILION),
        ("tilt from the\nvertical (deg)", "truth.tilt_deg", GREEN),
    )
    panels = [
        over_time(run, title, [Curve(channel, "", 1.0, colour)], rows)
        for title, channel, colour in shown
        if has_signal(run, channel, rows)  # a point mass has no attitude
    ]
    yield stacked("parachute", "Under the parachute", panels, "", 160)


def powered(run: Run) -> Iterator[Figure]:
    """From the release of the backshell to the ground."""
    if "ignition" not in run.when:
        return
    rows = run.between("backshell", "touchdown")
    yield _descent_plane(run, rows)
    thrust = [
        Curve("guide.thrust_n", "commanded", 1e-3, VERMILION, "dash"),
        Curve("truth.engine_thrust_n", "delivered", 1e-3, BLUE),
    ]
    speed = [
        Curve("truth.v_down_m_s", "down", 1.0, BLUE),
        Curve("truth.v_north_m_s", "north", 1.0, VERMILION, "dash"),
        Curve("truth.v_east_m_s", "east", 1.0, GREEN, "dot"),
    ]
    panels = [
        over_time(run, "height above\nthe ground (m)", [Curve("truth.height_m", "", 1.0, GREY)], rows),
        over_time(run, "velocity (m/s)", speed, rows),
        over_time(run, "engine thrust (kN)", thrust, rows),
        over_time(run, "tilt from the\nvertical (deg)", [Curve("truth.tilt_deg", "", 1.0, PURPLE)], rows),
    ]
    yield stacked("powered", "Powered descent", panels, "", 160)


def _descent_plane(run: Run, rows: np.ndarray) -> Figure:
    """Height over descent speed: the plane in which powered descent is designed."""
    names = {"backshell": "backshell", "ignition": "", begun(HOVER_IMAGING): "hover"}
    curve = Trace(run["truth.v_down_m_s"][rows], run["truth.height_m"][rows], "flown", colour=BLUE, width=2.2)
    panel = Panel(
        Axis("descent speed (m/s)"),
        Axis("height above the ground (m)"),
        [curve, placed(run, "truth.v_down_m_s", "truth.height_m", names)],
    )
    return Figure("descent_plane", "Height above the ground over descent speed", [panel], height=320)
