"""Reefed subsonic parachute: fills to a smaller area, keeps it until a cutter frees the skirt, then fills
whole.

The drag area grows as a power of time in each of the two fillings: linearly for ribbon and ringslot canopies,
about quadratically for solid cloth.  A canopy of diameter D that opens at speed v fills in n D/v, n about 8
for solid cloth and 14 for ribbons.  Pyrotechnic cutters are started by line stretch.  For Mach numbers below
about 0.8: no drag is lost.
Source: Knacke, "Parachute Recovery Systems Design Manual", NWC TP 6575, 1991, chapter 5 (filling time, growth
of the drag area, reefing), from memory.
"""

from __future__ import annotations

from edl6dof.config.base import Hardware, param
from edl6dof.jit import kernel
from edl6dof.registry import Member
from edl6dof.spatial.vector import clamp


class ReefedParams(Hardware):
    """Reefed subsonic parachute: two fillings, the second when the reefing line is cut."""

    reefing_ratio: float = param(
        0.1, "drag area while reefed over that of the open canopy", status="estimate", gt=0.0, le=1.0
    )
    filling_time_s: float = param(0.5, "time from line stretch to the reefed area", status="estimate", gt=0.0)
    cutter_delay_s: float = param(
        6.0, "time from line stretch to the cut of the reefing line", status="estimate", ge=0.0
    )
    disreefing_time_s: float = param(1.0, "time from the cut to the open canopy", status="estimate", gt=0.0)
    filling_exponent: float = param(
        1.0,
        "growth of the drag area with time: 1 ribbon, 2 solid cloth",
        status="recalled",
        source="Knacke 1991",
        ge=0.5,
        le=6.0,
    )


@kernel
def inflation(params, chute, since_line_stretch):
    """Drag-area fraction after line stretch: a rise to the reefing ratio, and one to 1 after the cut."""
    first = clamp(since_line_stretch / params.filling_time, 0.0, 1.0)
    second = clamp((since_line_stretch - params.cutter_delay) / params.disreefing_time, 0.0, 1.0)
    ratio, exponent = params.reefing_ratio, params.filling_exponent
    return ratio * first**exponent + (1.0 - ratio) * second**exponent


@kernel
def efficiency(params, chute, mach):
    """Drag over its value at low Mach number: 1, the canopy is subsonic."""
    return 1.0


MEMBER = Member(
    "reefed", ReefedParams, {"inflation": inflation, "efficiency": efficiency}, "Knacke, NWC TP 6575, 1991"
)
