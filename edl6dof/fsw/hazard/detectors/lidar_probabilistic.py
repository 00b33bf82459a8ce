"""Safe ground by the probability that slope and roughness keep their limits, given the errors of range.

Source: Tomita and Ho, "Real-time stochastic terrain mapping and processing for autonomous safe landing",
arXiv 2409.09309 (2024), for a Gaussian map; the product of :mod:`edl6dof.fsw.hazard.safety` in place of
their bounds.
"""

from __future__ import annotations

from edl6dof.config.base import Params, param
from edl6dof.fsw.hazard.safety import classify_by_probability
from edl6dof.kernels import kernel
from edl6dof.registry import Member
from edl6dof.spatial.elementary import tan


class ProbabilisticParams(Params):
    """Slope and roughness within limits, with a probability."""

    slope_limit_deg: float = param(
        8.0, "largest slope under the footprint", status="recalled", source="Chang'e-3", gt=0.0, lt=45.0
    )
    roughness_limit_m: float = param(
        0.22,
        "largest distance of a cell of the footprint from its plane: less than a rock of half a metre has",
        status="estimate", gt=0.0, le=5.0,
    )  # fmt: skip
    relief_between_m: float = param(
        0.02, "relief between the points of a cell, standard deviation", status="estimate", ge=0.0, le=1.0
    )
    least_probability: float = param(
        0.95, "probability from which on a spot counts as safe", status="estimate", gt=0.0, lt=1.0
    )


@kernel
def classify(params, elevation_map, footprint, radius, deviation, out):
    """Classify every cell of ``footprint`` (see the registry)."""
    classify_by_probability(
        elevation_map, footprint, radius_m=radius, steepest=tan(params.slope_limit),
        roughest=params.roughness_limit, deviation=deviation, between=params.relief_between,
        least=params.least_probability, out=out,
    )  # fmt: skip


MEMBER = Member(
    "lidar_probabilistic",
    ProbabilisticParams,
    {"classify": classify},
    "Tomita and Ho, arXiv 2409.09309, 2024",
)
