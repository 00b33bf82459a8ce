"""Faults of one tank: a leak, or a blocked feed."""

from __future__ import annotations

from edl6dof.config.base import param
from edl6dof.kernels import kernel
from edl6dof.registry import Member
from edl6dof.vehicle.faults.component import TankFault


class TankLeakParams(TankFault):
    """Propellant leaks out of the tank; left out: the force of its jet."""

    flow_kg_s: float = param(0.5, "what leaks", gt=0.0, le=100.0)


class TankBlockedParams(TankFault):
    """The feed of the tank is shut: the others give all; what has no other gives no thrust."""


@kernel
def tank_leak(fault, case, since, command, plant):
    """Let propellant out."""
    plant.leak[fault.component] = fault.params.tank_leak.flow


@kernel
def tank_blocked(fault, case, since, command, plant):
    """Shut the feed."""
    plant.blocked[fault.component] = 1


MEMBERS = (
    Member("tank_leak", TankLeakParams, {"inflict": tank_leak}, "leaking tank, line or seal"),
    Member(
        "tank_blocked", TankBlockedParams, {"inflict": tank_blocked}, "seized latch valve, clogged filter"
    ),
)
