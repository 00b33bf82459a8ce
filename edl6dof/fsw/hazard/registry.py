"""The ways of hazard detection.

A member has one kernel, ``classify(params, elevation_map, footprint, radius, deviation, out)``: from a map of
elevations (``ELEVATION_MAP``) and slope and roughness of the footprint at its cells (``FOOTPRINT``, of
``radius`` m) it writes into ``out`` (``SAFETY_MAP``) which cells are safe; ``deviation`` is the standard
deviation of the elevation of one point (m).  ``params`` are its own.
"""

from __future__ import annotations

from typing import Any

from edl6dof.config.base import Params, group, param
from edl6dof.fsw.hazard.coarse_avoidance import CoarseParams
from edl6dof.fsw.hazard.detectors import given, lidar, lidar_probabilistic
from edl6dof.fsw.hazard.site_selection import ChoiceParams
from edl6dof.registry import Family

HAZARD_DETECTION = Family("hazard detection", (given.MEMBER, lidar.MEMBER, lidar_probabilistic.MEMBER))
#: Number of the one that detects nothing.
GIVEN = HAZARD_DETECTION.names.index("given")

_Detectors: Any = HAZARD_DETECTION.params_model("HazardDetectors", "detection", "given", "Hazard detection.")


class ScanParams(Params):
    """When the scan begins, in hover."""

    speed_m_s: float = param(0.4, "speed below which the hover has settled", status="estimate", gt=0.0)
    rate_deg_s: float = param(1.5, "body rate below which it has", status="estimate", gt=0.0)
    latest_s: float = param(
        8.0, "time in hover after which the scan begins anyway", status="estimate", ge=0.0, le=600.0
    )


class HazardParams(_Detectors):
    """Hazard detection and the choice of a spot."""

    cell_m: float = param(0.2, "side of a cell of the map", status="derived", gt=0.01, le=5.0)
    footprint_radius_m: float = param(
        2.25, "radius of the disc that is assessed: that under the lander, 2 m, and half a rock next to it",
        status="derived", source="four footpads 1.77 m from the axis", gt=0.1, le=10.0,
    )  # fmt: skip
    filled_weight: float = param(
        0.25, "points that a cell without one, filled from around it, counts for", gt=0.0, lt=1.0
    )
    scan: ScanParams = group(ScanParams, "beginning of the scan")
    coarse: CoarseParams = group(CoarseParams, "coarse avoidance, at the start of powered descent")
    choice: ChoiceParams = group(ChoiceParams, "choice among the safe spots")


classify = HAZARD_DETECTION.role(
    "classify", "params", "elevation_map", "footprint", "radius", "deviation", "out", own=("params",)
)
