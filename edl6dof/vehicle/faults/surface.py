"""Faults of one surface, such as a trim wing: stuck, or lost."""

from __future__ import annotations

from edl6dof.config.base import param
from edl6dof.kernels import kernel
from edl6dof.registry import Member
from edl6dof.vehicle.aerodynamics.surfaces import wing_opening
from edl6dof.vehicle.faults.component import SurfaceFault


class WingStuckParams(SurfaceFault):
    """The surface opens no further."""

    opening: float = param(
        0.0, "opening at which it stays, unless it is further open already", ge=0.0, lt=1.0
    )


class WingLostParams(SurfaceFault):
    """The surface is torn off."""


@kernel
def wing_stuck(fault, case, since, command, plant):
    """Limit the opening."""
    i = fault.component
    already = wing_opening(case.vehicle.surfaces[i], since - plant.wing_start[i])
    plant.wing_lost[i] = 1.0 - max(fault.params.wing_stuck.opening, already)


@kernel
def wing_lost(fault, case, since, command, plant):
    """Take the surface away."""
    plant.wing_lost[fault.component] = 1.0


MEMBERS = (
    Member("wing_stuck", WingStuckParams, {"inflict": wing_stuck}, "Hu et al. 2022, section 4.3"),
    Member("wing_lost", WingLostParams, {"inflict": wing_lost}, "structural failure"),
)
