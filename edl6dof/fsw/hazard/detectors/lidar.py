"""Safe ground by limits of the measured slope and roughness of the footprint.

Source: Johnson, Klumpp, Collier and Wolf, "Lidar-based hazard avoidance for safe landing on Mars", J.
Guidance 25(6) (2002) 1091-1099.
"""

from __future__ import annotations

from edl6dof.config.base import Params, param
from edl6dof.fsw.hazard.elevation_map import MAP_CELLS, SAFE, TOO_ROUGH, TOO_STEEP, UNKNOWN, UNSEEN
from edl6dof.kernels import kernel
from edl6dof.registry import Member
from edl6dof.spatial.elementary import tan


class LidarDetectionParams(Params):
    """Slope and roughness within limits."""

    slope_limit_deg: float = param(
        8.0, "largest slope under the footprint", status="recalled", source="Chang'e-3", gt=0.0, lt=45.0
    )
    roughness_limit_m: float = param(
        0.16,
        "largest measured distance of a cell of the footprint from its plane; a rock of half "
"a metre exceeds it even if its top lies between two rays",
        status="estimate", gt=0.0, le=5.0,
    )  # fmt: skip


@kernel
def classify_by_limits(footprint, steepest, roughest, out):
    """Classify a cell as safe where slope and roughness of ``footprint`` are at most ``steepest`` (tangent)
    and ``roughest`` (m); writes classes and probabilities of ``out`` (``SAFETY_MAP``).
    """
    for i in range(MAP_CELLS):
        for j in range(MAP_CELLS):
            cell_class = SAFE
            if footprint.slope[i, j] >= UNKNOWN:
                cell_class = UNSEEN
            elif footprint.slope[i, j] > steepest:
                cell_class = TOO_STEEP
            elif footprint.roughness[i, j] > roughest:
                cell_class = TOO_ROUGH
            out.cell_class[i, j] = cell_class
            out.probability[i, j] = 1.0 if cell_class == SAFE else 0.0


@kernel
def classify(params, elevation_map, footprint, radius, deviation, out):
    """Classify every cell of ``elevation_map``; arguments: :mod:`edl6dof.fsw.hazard.registry`."""
    classify_by_limits(footprint, tan(params.slope_limit), params.roughness_limit, out)


MEMBER = Member(
    "lidar", LidarDetectionParams, {"classify": classify}, "Johnson et al., J. Guidance 25(6), 2002"
)
