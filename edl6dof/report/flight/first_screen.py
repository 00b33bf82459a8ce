"""The picture at the head of a report: the flight from the side, and its track on the relief below."""

from __future__ import annotations

import numpy as np

from edl6dof.config.errors import ConfigError
from edl6dof.replay.scene.poses import Site
from edl6dof.report.figure import Axis, Figure, Heat, Panel, Trace
from edl6dof.report.flight.common import EVENTS, flown, has_signal, site_panel
from edl6dof.report.flight.landing import EAST, NORTH, events_on_map, target, track
from edl6dof.report.palette import BLACK, GREY, RELIEF
from edl6dof.runs.run import Run
from edl6dof.scenario.loading import viewed_scenario

#: Cells along a side of the map, its width over its height, its least half height (km), and the room around
#: the track as a share of it.
CELLS, WIDE, LEAST_KM, ROOM = 81, 1.5, 12.0, 0.12
#: Channels whose peaks are marked on the path, and the words for them.
PEAKS = {"truth.heat_flux_w_cm2": "peak heating", "truth.load_g0": "peak load"}
#: Events that are marked on the path and on the map.
MARKED, ON_MAP = ("mortar", "touchdown"), {"mortar": EVENTS["mortar"]}


def first_screen(run: Run) -> Figure:
    """Draw the flight from the side above the ground below it, and its track from above."""
    panels = [profile(run), _map(run)]
    relief = " on the relief of the simulated ground" if panels[1].heat is not None else ""
    caption = f"Left: height over the distance to the landing site on the ground. Right: the track{relief}."
    return Figure("first_screen", "The flight", panels, caption, columns=2, height=300)


def profile(run: Run) -> Panel:
    """Draw height above the areoid over the distance to the landing site, with peaks and events."""
    up = float(run.scenario["planet"]["equatorial_radius_m"]) + run["truth.site_up_m"]
    distance = up * np.arctan2(np.hypot(run[EAST], run[NORTH]), up) / 1e3
    height = run["truth.height_above_areoid_m"] / 1e3
    entry = run.between(until="mortar")
    at = {
        words: int(np.argmax(np.where(entry, np.nan_to_num(run[channel]), -1.0)))
        for channel, words in PEAKS.items()
        if has_signal(run, channel)
    }
    for key in (key for key in MARKED if key in run.when):
        at[EVENTS[key]] = int(run.t.searchsorted(run.when[key]).clip(max=len(run.t) - 1))
    rows, farthest = list(at.values()), float(np.nanmax(distance))
    ground, few = height - run["truth.height_m"] / 1e3, np.linspace(0, len(run.t) - 1, 400).astype(int)
    low = np.full(2, np.nanmin(ground) - 0.06 * np.nanmax(height))
    around = np.append(distance[few], distance[[-1, 0]])
    traces = [
        Trace(around, np.append(ground[few], low), "ground below", "region", GREY),
        flown(distance, height, "vehicle"),
        Trace(distance[rows], height[rows], "", "points", BLACK, labels=list(at), border=True),
    ]
    across = Axis("distance to the landing site (km)", (1.03 * farthest, -0.16 * farthest))
    return Panel(across, Axis("height above the areoid (km)"), traces)


def _map(run: Run) -> Panel:
    """The track on the relief around it, which is left out of ground without relief or of a plugin."""
    traces = [track(run, slice(None), 1e3), target(run), events_on_map(run, ON_MAP)]
    low, high = (np.array([of(run[way]) for way in (EAST, NORTH)]) / 1e3 for of in (np.nanmin, np.nanmax))
    half = max((0.5 + ROOM) * float((high - low).max()), LEAST_KM) * np.array([[WIDE], [1.0]])
    east, north = 0.5 * (low + high)[:, None] + half * np.linspace(-1.0, 1.0, CELLS)
    try:
        scenario = viewed_scenario(run.scenario_text, str(run.folder / "scenario.yaml")).scenario
    except ConfigError:
        return site_panel(traces, unit="km")
    relief = Site(scenario).ground(*np.meshgrid(1e3 * east, 1e3 * north))[0] / 1e3
    least, most = float(relief.min()), float(relief.max())
    heat = Heat(east, north, relief, "height of the ground (km)", least, most, RELIEF)
    return site_panel(traces, unit="km", heat=heat if most > least else None)
