"""Where it flew and landed: ground track, descent, and the landing site from above."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from edl6dof.report.figure import GREEN, GREY, ORANGE, PURPLE, VERMILION, Axis, Figure, Panel, Trace
from edl6dof.report.flight.parts import flown, placed
from edl6dof.runs.run import Run
from edl6dof.scenario.terrain_preview import planned_ellipse

EAST, NORTH = "truth.site_east_m", "truth.site_north_m"


def figures(run: Run) -> Iterator[Figure]:
    """Figures of the section."""
    yield ground_track(run)
    if "mortar" in run.when and "backshell" in run.when:
        yield landing_site(run)


def ground_track(run: Run) -> Figure:
    """The whole way over ground, east and north of the landing site; the two axes have different scales."""
    curve = flown(run[EAST] / 1e3, run[NORTH] / 1e3, "vehicle")
    panel = Panel(
        _axis("east", "km"),
        _axis("north", "km"),
        [curve, _target(run), _events(run, 1e3, {"mortar": "parachute"})],
    )
    caption = "Axes have different scales."
    if run.summary["figures"].get("bank_reversals"):
        caption += " Bank reversals keep the track inside the corridor of crossrange."
    return Figure("ground_track", "Ground track", [panel], caption, height=420)


def landing_site(run: Run) -> Figure:
    """The planned ellipse where the scenario has one, the descent from the parachute on, and the last leg,
    each to scale.
    """
    descent = run.between("mortar")
    parts = [
        _part(run, "canopy", "canopy", GREY, 1e3),
        _part(run, "heat_shield", "heat shield", ORANGE, 1e3),
        _part(run, "backshell", "backshell", PURPLE, 1e3),
    ]
    below = flown(run[EAST][descent] / 1e3, run[NORTH][descent] / 1e3, "vehicle")
    limit = run.scenario["limits"]["landing_distance_m"]
    allowed = [] if limit is None else [_circle(float(limit) / 1e3, "allowed distance")]
    parachute = _events(run, 1e3, {"mortar": "parachute"})
    if planned := list(_planned(run, 1e3)):
        around = Panel(
            _axis("east", "km"),
            _axis("north", "km"),
            [*planned, *allowed, below, _target(run)],
            equal=True,
            title="planned ellipse",
        )
    left = Panel(
        _axis("east", "km"),
        _axis("north", "km"),
        [*([] if planned else allowed), *parts, below, _target(run), parachute],
        equal=True,
        title="from the parachute on",
    )
    last = run.between("backshell")
    marks = {"touchdown": "touchdown"}
    track = flown(run[EAST][last], run[NORTH][last], "vehicle")
    reach = float(np.hypot(np.ptp(run[EAST][last]), np.ptp(run[NORTH][last])))
    away = float(np.hypot(run[EAST][last], run[NORTH][last]).min())
    near = [_target(run)] if away < 2.0 * reach else []  # else there were nothing else to be seen
    right = Panel(
        _axis("east", "m"),
        _axis("north", "m"),
        [_part(run, "backshell", "backshell", PURPLE, 1.0), track, *near, _events(run, 1.0, marks)],
        equal=True,
        title="powered descent",
    )
    landed = run.summary["figures"]
    caption = ""
    if landed.get("landing_distance_m") is not None:
        offset = f"{landed['landing_east_m']:+,.0f} m east, {landed['landing_north_m']:+,.0f} m north"
        caption = f"Landed {landed['landing_distance_m']:,.0f} m from the target: {offset}."
    panels = [around, left, right] if planned else [left, right]
    return Figure("landing_site", "Landing site", panels, caption, columns=len(panels), height=460)


def _axis(way: str, unit: str) -> Axis:
    return Axis(f"{way} of the landing site ({unit})")


def _target(run: Run) -> Trace:
    """The landing site, which is no target of what flies until its time is up."""
    name = "landing site" if run.scenario["mission"]["goal"] == "time" else "target"
    return Trace(np.zeros(1), np.zeros(1), name, "points", VERMILION, symbol="cross", width=3.0, border=True)


def _circle(radius: float, name: str) -> Trace:
    turn = np.linspace(0.0, 2.0 * np.pi, 181)
    return Trace(
        radius * np.cos(turn), radius * np.sin(turn), name, colour=GREEN, dash="dash", width=1.2, border=True
    )


def _planned(run: Run, scale: float) -> Iterator[Trace]:
    """The planned landing ellipse, if the scenario has one."""
    terrain = run.scenario["terrain"]
    length, width = (float(terrain[f"ellipse_{side}_m"]) for side in ("length", "width"))
    if length > 0.0:
        east, north = planned_ellipse(
            length / scale, width / scale, np.radians(terrain["ellipse_azimuth_deg"])
        )
        name = f"planned ellipse, {length / 1e3:g} x {width / 1e3:g} km"
        yield Trace(east, north, name, colour=GREY, width=1.0, border=True)


def _part(run: Run, part: str, name: str, colour: str, scale: float) -> Trace:
    """The way of a discarded part to the ground."""
    east, north = (run[f"truth.{part}_{way}_m"] / scale for way in ("east", "north"))
    there = np.isfinite(east)
    return Trace(east[there], north[there], name, colour=colour, dash="dash")


def _events(run: Run, scale: float, names: dict[str, str]) -> Trace:
    return placed(run, EAST, NORTH, names, (1.0 / scale, 1.0 / scale))
