"""The family of hazard detectors.

A member has one kernel, ``classify(params, elevation_map, footprint, radius, deviation, out)``: from a map of
elevations (``ELEVATION_MAP``), and slope and roughness of the footprint of ``radius`` m around each cell
(``FOOTPRINT``), it writes the class and safety probability of each cell into ``out`` (``SAFETY_MAP``);
``deviation`` is the standard deviation of the elevation of one point (m). ``params`` belong to the member.
"""

from __future__ import annotations

from typing import Any

from edl6dof.config.base import Params, group, param
from edl6dof.fsw.hazard.coarse_avoidance import CoarseParams
from edl6dof.fsw.hazard.detectors import given, lidar, lidar_probabilistic
from edl6dof.fsw.hazard.map_sites import MapSitesParams
from edl6dof.fsw.hazard.site_selection import ChoiceParams
from edl6dof.registry import Family

HAZARD_DETECTION = Family("hazard detection", (given.MEMBER, lidar.MEMBER, lidar_probabilistic.MEMBER))
#: Index of the member that detects nothing.
GIVEN = HAZARD_DETECTION.names.index("given")

_Detectors: Any = HAZARD_DETECTION.params_model("HazardDetectors", "detection", "given", "Hazard detection.")


class ScanParams(Params):
    """Condition for the start of the scan, in hover."""

    speed_m_s: float = param(0.4, "speed below which the hover has settled", status="estimate", gt=0.0)
    rate_deg_s: float = param(1.5, "body rate below which the hover has settled", status="estimate", gt=0.0)
    latest_s: float = param(
        8.0, "time in hover after which the scan begins anyway", status="estimate", ge=0.0, le=600.0
    )


class HazardParams(_Detectors):
    """Hazard detection and the choice of a spot."""

    cell_m: float = param(0.2, "side of a cell of the map", status="derived", gt=0.01, le=5.0)
    footprint_radius_m: float = param(
        2.25, "radius of the assessed disc: 2 m under the lander, and half a rock next to it",
        status="derived", source="four footpads 1.77 m from the axis", gt=0.1, le=10.0,
    )  # fmt: skip
    filled_weight: float = param(
        0.25, "weight of a cell without points that is filled from its neighbours", gt=0.0, lt=1.0
    )
    scan: ScanParams = group(ScanParams, "beginning of the scan")
    coarse: CoarseParams = group(CoarseParams, "coarse avoidance, at the start of powered descent")
    sites: MapSitesParams = group(MapSitesParams, "safe sites of the map")
    choice: ChoiceParams = group(ChoiceParams, "choice among the safe spots")


classify = HAZARD_DETECTION.role(
    "classify", "params", "elevation_map", "footprint", "radius", "deviation", "out", own=("params",)
)
