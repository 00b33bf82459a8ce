"""What hazard detection chose, beside the ground as it is."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from edl6dof.environment.landing_area.census import within
from edl6dof.environment.landing_area.params import GENERATED
from edl6dof.environment.landing_area.plane import place_of
from edl6dof.fsw.hazard.safety import SAFE
from edl6dof.kernels import kernel
from edl6dof.metrics.footing import COUNTED, FOOTPRINT
from edl6dof.spatial.elementary import atan2, hypot
from edl6dof.spatial.frames import geodetic, ned_to_fixed
from edl6dof.spatial.vector import add, take3
from edl6dof.telemetry.columns import Telemetry


class TrueSpot(NamedTuple):
    """Where the chosen spot truly is, east and north of the landing site (m): as chosen, less the error of
    navigation when the scan began.
    """

    east: float
    north: float


def true_spot(fsw: np.void, telemetry: Telemetry) -> TrueSpot | None:
    """The chosen spot on the ground; ``None`` where none was chosen from a scan of this
    telemetry."""
    hazard, point = fsw["hazard"], fsw["landing_point"]
    # a flight that goes on from a saved state has no telemetry of what was before
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
    """Diameter (m) of the largest rock whose middle lies under the footprint around a place (east, north, up
    of the landing site, m); 0 for none.
    """
    site, planet, terrain = cases[0].site, cases[0].planet, cases[0].terrain
    off = ned_to_fixed(site.sin_lat, site.cos_lat, site.sin_lon, site.cos_lon, (north, east, -up))
    r_F = add(take3(site.origin_F, 0), off)
    sl, cl, so, co, _ = geodetic(planet.equatorial_radius, planet.flattening, r_F)
    y, x = place_of(terrain, atan2(sl, cl), atan2(so, co))
    _, largest = within(terrain.landing_area.rocks, y, x, FOOTPRINT, 0.0)
    return largest
