"""Reefed subsonic parachute: fills in stages, in each to a larger share of its drag area, the last one whole.

A reefing line holds the skirt until a cutter frees it; cutters are pyrotechnic delays started by line
stretch.  In each stage the drag area grows as a power of time: linearly for ribbon and ringslot canopies,
about quadratically for solid cloth.  A canopy of diameter D that opens at speed v fills in n D/v, n about 8
for solid cloth and 14 for ribbons.  For Mach numbers below about 0.8: no drag is lost.
Source: Knacke, "Parachute Recovery Systems Design Manual", NWC TP 6575, 1991, chapter 5 (filling time, growth
of the drag area, reefing), from memory.
"""

from __future__ import annotations

from typing import Annotated

from pydantic import field_validator

from edl6dof.config.base import REQUIRED, Capacity, Hardware, param
from edl6dof.kernels import kernel
from edl6dof.registry import Member
from edl6dof.spatial.elementary import pow
from edl6dof.spatial.vector import clamp

MAX_STAGES = 4


class ReefingStage(Hardware):
    """One filling of a reefed canopy."""

    drag_area_ratio: float = param(
        REQUIRED,
        "drag area at the end of the stage over that of the open canopy",
        gt=0.0,
        le=1.0,
        usual=(0.01, 1, "reefed canopies"),
    )
    delay_s: float = param(
        0.0,
        "time from line stretch to the cut that begins the stage",
        ge=0.0,
        usual=(0, 60, "reefing cutters"),
    )
    filling_time_s: float = param(
        REQUIRED,
        "time from the cut to the drag area of the stage",
        gt=0.0,
        usual=(0.05, 20, "supersonic to low subsonic"),
    )


def _stages() -> list[ReefingStage]:
    return [
        ReefingStage(drag_area_ratio=0.1, filling_time_s=0.5),
        ReefingStage(drag_area_ratio=1.0, delay_s=6.0, filling_time_s=1.0),
    ]


class ReefedParams(Hardware):
    """Reefed subsonic parachute: fillings one after the other, each when a reefing line is cut."""

    stages: Annotated[list[ReefingStage], Capacity(MAX_STAGES)] = param(
        None, "the fillings, the first from line stretch, the last to the whole drag area",
        status="estimate", factory=_stages, min_length=1, max_length=MAX_STAGES,
    )  # fmt: skip
    filling_exponent: float = param(
        1.0,
        "growth of the drag area with time: 1 ribbon, 2 solid cloth",
        status="recalled",
        source="Knacke 1991",
        ge=0.5,
        le=6.0,
    )

    @field_validator("stages")
    @classmethod
    def _one_after_the_other(cls, value: list[ReefingStage]) -> list[ReefingStage]:
        if value[0].delay_s != 0.0:
            raise ValueError(f"the first must begin at line stretch, delay_s 0 (got {value[0].delay_s:g})")
        for before, after in zip(value, value[1:], strict=False):
            filled = before.delay_s + before.filling_time_s
            if after.delay_s < filled or after.drag_area_ratio <= before.drag_area_ratio:
                raise ValueError(
                    f"each must begin after the one before has filled ({filled:g} s) and end larger "
                    f"than its {before.drag_area_ratio:g} (got delay_s {after.delay_s:g}, "
                    f"drag_area_ratio {after.drag_area_ratio:g})"
                )
        if value[-1].drag_area_ratio != 1.0:
            raise ValueError(f"the last must end at drag_area_ratio 1 (got {value[-1].drag_area_ratio:g})")
        return value


@kernel
def inflation(params, chute, since_line_stretch):
    """Drag-area fraction after line stretch: a rise in each stage that has begun, from the ratio of the one
    before to its own.
    """
    fraction = before = 0.0
    for k in range(params.n_stages):
        stage = params.stages[k]
        passed = clamp((since_line_stretch - stage.delay) / stage.filling_time, 0.0, 1.0)
        fraction += (stage.drag_area_ratio - before) * pow(passed, params.filling_exponent)
        before = stage.drag_area_ratio
    return fraction


@kernel
def efficiency(params, chute, mach):
    """Drag over its value at low Mach number: 1, the canopy is subsonic; ``mach_efficiency`` of the parachute
    can say otherwise.
    """
    return 1.0


MEMBER = Member(
    "reefed", ReefedParams, {"inflation": inflation, "efficiency": efficiency}, "Knacke, NWC TP 6575, 1991"
)
