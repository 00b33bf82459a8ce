"""Supersonic disk-gap-band parachute, deployed by a mortar: fills as a power of time and overshoots.

The opening load factor was fitted to measured loads: what an elastic riser and an oscillating area add to the
drag of the filling canopy is in it.  So that they do not add it once more, the drag area overshoots by the
factor over the dynamic load factor of the riser, and ``area_oscillates: open``; the peak tension is then drag
times opening load factor.
Source: Cruz, Way, Shidner et al., "Parachute Models Used in the Mars Science Laboratory Entry, Descent, and
Landing Simulation", AIAA 2013-1276 (numbers second hand, see the reference data).
"""

from __future__ import annotations

from typing import Self

from pydantic import model_validator

from edl6dof.config.base import Hardware, param
from edl6dof.kernels import kernel
from edl6dof.registry import Member
from edl6dof.spatial.elementary import pow


class DiskGapBandParams(Hardware):
    """Disk-gap-band parachute: power law of time with overshoot, supersonic loss of drag."""

    inflation_speed_m_s: float = param(
        27.2, "diameter over inflation time", status="published", source="MSL, Cruz et al. 2013", gt=0.0
    )
    inflation_exponent: float = param(
        4.0, "growth of the drag area with time", status="published", source="MSL, Cruz et al. 2013", gt=0.0
    )
    opening_load_factor: float = param(
        1.344,
        "peak load over the drag of the open canopy at the same dynamic pressure",
        status="published",
        source="MSL, Cruz et al. 2013",
        ge=1.0,
    )
    dynamic_load_factor: float = param(
        1.0,
        "part (a factor) of the opening load factor that the elastic riser makes by itself: the drag area "
        "overshoots by the rest; 1 where the whole is the canopy's",
        ge=1.0,
        le=2.0,
    )
    overshoot_decay_s: float = param(0.25, "time in which the overshoot is gone", status="estimate", gt=0.0)

    @model_validator(mode="after")
    def _overshoots(self) -> Self:
        if self.dynamic_load_factor > self.opening_load_factor:
            most, given = self.opening_load_factor, self.dynamic_load_factor
            raise ValueError(
                f"dynamic_load_factor must not be above opening_load_factor {most:g} (got {given:g})"
            )
        return self


@kernel
def inflation(params, chute, since_line_stretch):
    """Drag-area fraction after line stretch: a power law up to its overshoot, then a decay to one."""
    overshoot = params.opening_load_factor / params.dynamic_load_factor
    x = since_line_stretch * params.inflation_speed / chute.diameter
    if x < 1.0:
        return overshoot * pow(x, params.inflation_exponent)
    fade = (since_line_stretch - chute.diameter / params.inflation_speed) / params.overshoot_decay
    return 1.0 + (overshoot - 1.0) * max(1.0 - fade, 0.0)


@kernel
def efficiency(params, chute, mach):
    """Drag over its subsonic value (Cruz et al. 2013, as implemented for MSL); continuous, 0.61 beyond Mach
    2.6.
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


MEMBER = Member(
    "disk_gap_band",
    DiskGapBandParams,
    {"inflation": inflation, "efficiency": efficiency},
    "Cruz, Way, Shidner et al., AIAA 2013-1276",
)
