"""No hazard detection: the safe spot is given, as an offset from the point where avoidance begins
(:mod:`edl6dof.fsw.guidance.powered.terminal_descent`).  No source: it is the null member.
"""

from __future__ import annotations

from edl6dof.config.base import Params
from edl6dof.kernels import kernel
from edl6dof.registry import Member


class GivenParams(Params):
    """No detection: the safe spot is given."""


@kernel
def classify(params, elevation_map, footprint, radius, deviation, out):
    """Classify nothing."""


MEMBER = Member("given", GivenParams, {"classify": classify}, "null member")
