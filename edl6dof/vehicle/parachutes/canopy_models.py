"""Models of how a canopy fills and of its drag over Mach number; each of ``vehicle.parachutes`` may name one
as its ``model``.

A member has two kernels.  ``inflation(params, chute, since_line_stretch)`` gives the share of the full drag
area at a time (s) after line stretch, finally 1; ``efficiency(params, chute, mach)`` gives the axial force
over its value at low Mach number.  ``params`` are the member's own, ``chute`` those of all parachutes.

Disk-gap-band: deployed by a mortar, fills as a power of time and overshoots.  The opening load factor was
fitted to measured loads, so it includes the effects of an elastic riser and of an oscillating area.  To count
these once, the drag area overshoots by the opening load factor over the dynamic load factor of the riser,
with ``area_oscillates: open``; the peak tension is then drag times opening load factor.
Reefed: a reefing line holds the skirt until a cutter frees it; cutters are pyrotechnic delays started by line
stretch.  In each stage the drag area grows as a power of time: linearly for ribbon and ringslot canopies,
about quadratically for solid cloth.  A canopy of diameter D that opens at speed v fills in n D/v, n about 8
for solid cloth and 14 for ribbons.  For Mach numbers below about 0.8: no drag is lost.
Source: disk-gap-band: Cruz, Way, Shidner et al., "Parachute Models Used in the Mars Science Laboratory Entry,
Descent, and Landing Simulation", AIAA 2013-1276 (numbers second hand, see the reference data).  Reefed:
Knacke, "Parachute Recovery Systems Design Manual", NWC TP 6575, 1991, chapter 5 (filling time, growth of the
drag area, reefing), from memory.
"""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import field_validator, model_validator

from edl6dof.config.base import REQUIRED, Capacity, Hardware, param
from edl6dof.kernels import kernel
from edl6dof.registry import Family, Member
from edl6dof.spatial.elementary import pow
from edl6dof.spatial.table_index import between, cell_among
from edl6dof.spatial.vector import clamp

MAX_MACH_POINTS = 16


class MachTable(Hardware):
    """Points of a factor over Mach number; without points the table is not used."""

    mach: Annotated[list[float], Capacity(MAX_MACH_POINTS)] = param(
        None, "Mach numbers, ascending; none: no table", factory=list, max_length=MAX_MACH_POINTS
    )
    factor: Annotated[list[float], Capacity(MAX_MACH_POINTS)] = param(
        None, "factor at each Mach number, 0 to 2", factory=list, max_length=MAX_MACH_POINTS
    )

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        problems = []
        points = len(self.mach)
        if points == 1 or any(b <= a for a, b in zip(self.mach, self.mach[1:], strict=False)):
            problems.append(f"mach must be two or more numbers that ascend, or none (got {self.mach})")
        elif any(mach < 0.0 for mach in self.mach):
            problems.append(f"mach must not be negative (got {self.mach})")
        if len(self.factor) != points:
            problems.append(f"factor must be as many as mach, {points} (got {len(self.factor)})")
        elif not all(0.0 < factor <= 2.0 for factor in self.factor):
            problems.append(f"factor must be above 0 and at most 2 (got {self.factor})")
        if problems:
            raise ValueError("; ".join(problems))
        return self


@kernel
def tabulated(table, mach):
    """Interpolate the factor of a ``table`` with points at a Mach number."""
    index, share = cell_among(table.mach, table.n_mach, mach)
    return between(table.factor, index, share)


class DiskGapBandParams(Hardware):
    """Parameters of a disk-gap-band parachute.

    The drag area grows with a power of the time after line stretch, overshoots, and decays to its steady
    value.
    """

    inflation_speed_m_s: float = param(
        27.2,
        "nominal diameter divided by the inflation time",
        status="published",
        source="MSL, Cruz et al. 2013",
        gt=0.0,
    )
    inflation_exponent: float = param(
        4.0,
        "exponent of the growth of the drag area with time",
        status="published",
        source="MSL, Cruz et al. 2013",
        gt=0.0,
    )
    opening_load_factor: float = param(
        1.344,
        "peak load divided by the drag of the open canopy at the same dynamic pressure",
        status="published",
        source="MSL, Cruz et al. 2013",
        ge=1.0,
    )
    dynamic_load_factor: float = param(
        1.0,
        "part of opening_load_factor that the elastic riser causes; the drag area overshoots by "
        "opening_load_factor divided by this part; 1: the riser causes none",
        ge=1.0,
        le=2.0,
    )
    overshoot_decay_s: float = param(0.25, "time in which the overshoot decays", status="estimate", gt=0.0)

    @model_validator(mode="after")
    def _overshoots(self) -> Self:
        if self.dynamic_load_factor > self.opening_load_factor:
            most, given = self.opening_load_factor, self.dynamic_load_factor
            raise ValueError(
                f"dynamic_load_factor must not be above opening_load_factor {most:g} (got {given:g})"
            )
        return self


@kernel
def disk_gap_band_inflation(params, chute, since_line_stretch):
    """Return the inflated fraction of the drag area, ``since_line_stretch`` s after line stretch."""
    overshoot = params.opening_load_factor / params.dynamic_load_factor
    x = since_line_stretch * params.inflation_speed / chute.diameter
    if x < 1.0:
        return overshoot * pow(x, params.inflation_exponent)
    fade = (since_line_stretch - chute.diameter / params.inflation_speed) / params.overshoot_decay
    return 1.0 + (overshoot - 1.0) * max(1.0 - fade, 0.0)


@kernel
def disk_gap_band_efficiency(params, chute, mach):
    """Return the drag divided by its subsonic value (Cruz et al. 2013, as implemented for MSL); 0.61 beyond
    Mach 2.6.
    """
    if mach <= 0.7:
        return 1.0
    if mach <= 0.94:
        return 1.0 - 0.33 * (mach - 0.7) / 0.24
    if mach <= 1.4:
        s = (1.4 - mach) / 0.46
        return 1.0 - 0.33 * s * s
    if mach <= 1.85:
        s = (mach - 1.4) / 0.45
        return 1.0 - 0.16 * s * s
    return 0.84 - 0.23 * min((mach - 1.85) / 0.75, 1.0)


DISK_GAP_BAND = Member(
    "disk_gap_band",
    DiskGapBandParams,
    {"inflation": disk_gap_band_inflation, "efficiency": disk_gap_band_efficiency},
    "Cruz, Way, Shidner et al., AIAA 2013-1276",
)


MAX_STAGES = 4


class ReefingStage(Hardware):
    """One stage of the filling of a reefed canopy."""

    drag_area_ratio: float = param(
        REQUIRED,
        "drag area at the end of the stage, divided by that of the open canopy",
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
    """Reefed subsonic parachute: it fills in stages, each begun by the cut of a reefing line."""

    stages: Annotated[list[ReefingStage], Capacity(MAX_STAGES)] = param(
        None, "the stages: the first begins at line stretch, the last ends at the full drag area",
        status="estimate", factory=_stages, min_length=1, max_length=MAX_STAGES,
    )  # fmt: skip
    filling_exponent: float = param(
        1.0,
        "exponent of the growth of the drag area with time: 1 ribbon, 2 solid cloth",
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
def reefed_inflation(params, chute, since_line_stretch):
    """Drag-area fraction after line stretch: each stage rises from the ratio of the one before."""
    fraction = before = 0.0
    for k in range(params.n_stages):
        stage = params.stages[k]
        passed = clamp((since_line_stretch - stage.delay) / stage.filling_time, 0.0, 1.0)
        fraction += (stage.drag_area_ratio - before) * pow(passed, params.filling_exponent)
        before = stage.drag_area_ratio
    return fraction


@kernel
def reefed_efficiency(params, chute, mach):
    """Drag over its value at low Mach number: constant 1, as the canopy is subsonic."""
    return 1.0


REEFED = Member(
    "reefed",
    ReefedParams,
    {"inflation": reefed_inflation, "efficiency": reefed_efficiency},
    "Knacke, NWC TP 6575, 1991",
)


PARACHUTE_MODELS = Family("parachute model", (DISK_GAP_BAND, REEFED))

ParachuteChoice = PARACHUTE_MODELS.params_model(
    "ParachuteChoice", "model", "disk_gap_band", "How a canopy fills and drags.", bare=True
)

inflation_of_model = PARACHUTE_MODELS.switch(
    "inflation", "params", "chute", "since_line_stretch", own=("params",)
)
efficiency_of_model = PARACHUTE_MODELS.switch("efficiency", "params", "chute", "mach", own=("params",))
