"""The picture at the head of a report: the flight from the side, and its track on the relief below."""

from __future__ import annotations

import numpy as np

from edl6dof.config.errors import ConfigError
from edl6dof.replay.scene.poses import Site
from edl6dof.report.figure import Axis, Figure, Heat, Panel, Trace
from edl6dof.report.flight.common import flown, has_signal, site_panel
from edl6dof.report.flight.landing import EAST, NORTH, events_on_map, target, track
from edl6dof.report.palette import BLACK, GREY, RELIEF
from edl6dof.runs.run import Run
from edl6dof.scenario.loading import viewed_scenario

#: Cells along a side of the map, its width over its height, its least half height (km), and the room around
#: the track as a share of it.
CELLS, WIDE, LEAST_KM, ROOM = 81, 1.5, 12.0, 0.12
#: Channels whose peaks are marked on the path, and the words for them.
PEAKS = {"truth.heat_flux_w_cm2": "peak heating", "truth.load_g0": "peak load"}
#: Events that are marked on the path, with the words for them.
MARKED = {"mortar": "parachute", "touchdown": "touchdown"}


def first_screen(run: Run) -> Figure:
    """Draw the flight from the side above the ground below it, and its track from above."""
    try:
        site = Site(viewed_scenario(run.scenario_text, str(run.folder / "scenario.yaml")).scenario)
    except ConfigError:  # parameters of a plugin, which a report does not load
        site = None
    panels = [profile(run), _map(run, site)]
    relief = " on the relief of the simulated ground" if panels[1].heat is not None else ""
    caption = f"Left: height over the distance to the landing site on the ground. Right: the track{relief}."
    return Figure("first_screen", "The flight", panels, caption, columns=2, height=300)


def profile(run: Run) -> Panel:
    """Draw height above the areoid over the distance to the landing site, with peaks and events."""
    up = float(run.scenario["planet"]["equatorial_radius_m"]) + run["truth.site_up_m"]
    distance = up * np.arctan2(np.hypot(run[EAST], run[NORTH]), up) / 1e3
    height = run["truth.height_above_areoid_m"] / 1e3
    entry, rows = np.flatnonzero(run.between(until="mortar")), dict[str, int]()
    for channel, words in PEAKS.items():
        if has_signal(run, channel) and len(entry):
            rows[words] = int(entry[np.argmax(np.nan_to_num(run[channel][entry]))])
    for key, words in MARKED.items():
        if key in run.when:
            rows[words] = int(np.searchsorted(run.t, run.when[key]).clip(max=len(run.t) - 1))
    farthest, at = float(np.nanmax(distance)), list(rows.values())
    ground, few = height - run["truth.height_m"] / 1e3, np.linspace(0, len(run.t) - 1, 400).astype(int)
    low = float(np.nanmin(ground)) - 0.06 * float(np.nanmax(height))
    outline = np.append(ground[few], [low, low]), np.append(distance[few], distance[[-1, 0]])
    traces = [
        Trace(outline[1], outline[0], "ground below", "region", GREY),
        flown(distance, height, "vehicle"),
        Trace(distance[at], height[at], "", "points", BLACK, labels=list(rows), border=True),
    ]
    across = Axis("distance to the landing site (km)", (1.03 * farthest, -0.16 * farthest))
    return Panel(across, Axis("height above the areoid (km)"), traces)


def _map(run: Run, site: Site | None) -> Panel:
    """The track on the relief around it, which is left out of ground without relief."""
    traces, heat = (
        [track(run, slice(None), 1e3), target(run), events_on_map(run, {"mortar": "parachute"})],
        None,
    )
    low, high = (np.array([of(run[way]) for way in (EAST, NORTH)]) / 1e3 for of in (np.nanmin, np.nanmax))
    middle, half = 0.5 * (low + high), max((0.5 + ROOM) * float((high - low).max()), LEAST_KM)
    east, north = middle[:, None] + half * np.array([[WIDE], [1.0]]) * np.linspace(-1.0, 1.0, CELLS)
    if site is not None:
        elevation = site.ground(*np.meshgrid(1e3 * east, 1e3 * north))[0] / 1e3
        low_km, high_km = float(elevation.min()), float(elevation.max())
        if high_km > low_km:
            heat = Heat(east, north, elevation, "height of the ground (km)", low_km, high_km, RELIEF)
    return site_panel(traces, unit="km", heat=heat)
