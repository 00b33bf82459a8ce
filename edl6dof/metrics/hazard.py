"""Choice of hazard detection compared with the true ground, and least distance of backshell and canopy from
the lander once they have parted, between rows as well.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from edl6dof.environment.landing_area.population import within
from edl6dof.environment.landing_area.relief import GENERATED
from edl6dof.environment.terrain import place_of
from edl6dof.fsw.hazard.elevation_map import SAFE
from edl6dof.interface.roles import HOVER_IMAGING, begun
from edl6dof.kernels import kernel
from edl6dof.metrics.touchdown import COUNTED, FOOTPRINT
from edl6dof.spatial.arrays import lengths
from edl6dof.spatial.elementary import atan2, hypot
from edl6dof.spatial.frames import geodetic, ned_to_fixed
from edl6dof.spatial.vector import add, take3
from edl6dof.telemetry.columns import Telemetry

_AXES = ("east", "north", "up")
#: Seconds after ignition from which backshell and lander count as parted.
PARTED_S = 5.0


class TrueSpot(NamedTuple):
    """True place of the chosen spot, east and north of the site (m): as chosen less navigation error."""

    east: float
    north: float


def true_spot(fsw: np.void, telemetry: Telemetry) -> TrueSpot | None:
    """The chosen spot on the ground; ``None`` where none was chosen from a scan of this telemetry."""
    hazard, point = fsw["hazard"], fsw["landing_point"]
    # a flight continued from a saved state has no telemetry of what was before
    if not (np.isfinite(hazard["spot_t"]) and hazard["scan_t"] >= telemetry["t_s"][0]):
        return None
    east, north = telemetry.at(float(hazard["scan_t"]), "nav.error_east_m", "nav.error_north_m")
    return TrueSpot(float(point["fine_L"][0]) - east, float(point["fine_L"][1]) - north)


def hazard_figures(
    case: np.ndarray, fsw: np.void, telemetry: Telemetry, landing: dict[str, float]
) -> dict[str, float]:
    """Figures of the coarse and of the fine choice; of what was not chosen there is none.

    Args:
        case: truth of the flight, shape (1,).
        fsw: final memory of the flight software.
        telemetry: its rows.
        landing: figures of the touchdown.
    """
    figures: dict[str, float] = {}
    hazard = fsw["hazard"]
    if np.isfinite(hazard["image_t"]):
        coarse = hazard["coarse"]
        figures["coarse_parts"] = float(coarse["parts"])
        figures["coarse_obstacles"] = float(coarse["obstacles"][coarse["part"]])
        figures["coarse_clear_m"] = float(coarse["clear"][coarse["part"]])
    spot = true_spot(fsw, telemetry)
    if spot is None:
        return figures
    choice, cell_class = hazard["choice"], hazard["safety_map"]["cell_class"]
    figures["spot_found"] = float(choice["found"])
    figures["spot_clearance_m"] = float(choice["clearance"])
    figures["spots_rejected"] = float(choice["n_rejected"])
    figures["map_safe_share"] = float(np.mean(cell_class == SAFE))
    if case["terrain"]["landing_area"]["model"][0] == GENERATED:
        up = float(telemetry["truth.site_up_m"][-1])
        largest = _largest_rock(case, spot.east, spot.north, up)
        figures["spot_largest_rock_m"] = largest
        figures["spot_false_safe"] = float(bool(choice["found"]) and largest >= COUNTED)
    if "landing_east_m" in landing:
        figures["spot_miss_m"] = hypot(
            landing["landing_east_m"] - spot.east, landing["landing_north_m"] - spot.north
        )
    return figures


@kernel
def _largest_rock(cases, east, north, up):
    """Diameter (m) of the largest rock centred under the footprint about a place (m); 0 for none."""
    site, planet, terrain = cases[0].site, cases[0].planet, cases[0].terrain
    off = ned_to_fixed(site.sin_lat, site.cos_lat, site.sin_lon, site.cos_lon, (north, east, -up))
    r_F = add(take3(site.origin_F, 0), off)
    sl, cl, so, co, _ = geodetic(planet.equatorial_radius, planet.flattening, r_F)
    y, x = place_of(terrain, atan2(sl, cl), atan2(so, co))
    _, largest = within(terrain.landing_area.rocks, y, x, FOOTPRINT, 0.0)
    return largest


def drift_figures(
    telemetry: Mapping[str, np.ndarray], when: Mapping[str, float], line_m: float
) -> dict[str, float]:
    """Least distance of the lander from backshell and canopy after they have parted; and from hover on, how
    far aside of the lander what is above it passes.

    The canopy is the point ``line_m`` above the backshell that hangs from it.  Between two rows both move on
    straight lines.

    Args:
        telemetry: channels of a flight.
        when: time (s) of its events by key.
        line_m: from the backshell to the canopy, m.
    """
    if "ignition" not in when or "backshell" not in when:
        return {}
    t = telemetry["t_s"]
    last = t <= when.get("touchdown", np.inf)
    off = np.column_stack(
        [telemetry[f"truth.backshell_{axis}_m"] - telemetry[f"truth.site_{axis}_m"] for axis in _AXES]
    )
    parted = last & (t >= when["ignition"] + PARTED_S)
    figures = {}
    if np.count_nonzero(parted) > 1:
        figures["min_drift_distance_m"] = min(
            least_length(off[parted] + (0.0, 0.0, h)) for h in (0.0, line_m)
        )
    hovering = last & (t >= when.get(begun(HOVER_IMAGING), np.inf)) & (off[:, 2] + line_m > 0.0)
    if np.count_nonzero(hovering) > 1:
        figures["min_overhead_m"] = least_length(off[hovering, :2])
    return figures


def least_length(way: np.ndarray) -> float:
    """Least length of a vector, rows of ``way``, that moves on straight lines from row to row."""
    start, step = way[:-1], np.diff(way, axis=0)
    share = -np.sum(start * step, axis=1) / np.maximum(np.sum(step * step, axis=1), 1e-30)
    return float(np.min(lengths(start + np.clip(share, 0.0, 1.0)[:, None] * step)))
