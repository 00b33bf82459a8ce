"""Faults of one thruster: dead, open, or weak."""

from __future__ import annotations

from edl6dof.config.base import param
from edl6dof.jit import kernel
from edl6dof.registry import Member
from edl6dof.vehicle.faults.component import ThrusterFault

#: Longer than any base cycle, s: a valve held open is open all through it.
LONG = 1.0

#: Numbers of ``THRUSTER_KINDS``.
STUCK_OFF, STUCK_ON, DEGRADED = 1, 2, 3


class StuckOffParams(ThrusterFault):
    """The thruster does not fire any more."""


class StuckOnParams(ThrusterFault):
    """The thruster's valve does not close any more; only isolating the thruster stops it."""


class DegradedParams(ThrusterFault):
    """The thruster gives less thrust."""

    thrust_factor: float = param(0.5, "thrust left", ge=0.0, lt=1.0)


@kernel
def stuck_off(fault, case, since, command, plant):
    """Keep the valve shut."""
    i = fault.component
    plant.valves.fault[i] = STUCK_OFF
    plant.valves.opens[i] = plant.valves.closes[i] = plant.t


@kernel
def stuck_on(fault, case, since, command, plant):
    """Keep the valve open."""
    i = fault.component
    plant.valves.fault[i] = STUCK_ON
    plant.valves.opens[i], plant.valves.closes[i] = plant.t, plant.t + LONG


@kernel
def degraded(fault, case, since, command, plant):
    """Take away part of the thrust."""
    i = fault.component
    plant.valves.fault[i] = DEGRADED
    plant.valves.lost[i] = 1.0 - fault.params.degraded.thrust_factor


MEMBERS = (
    Member("stuck_off", StuckOffParams, {"inflict": stuck_off}, "Hu et al. 2022, section 6.3"),
    Member("stuck_on", StuckOnParams, {"inflict": stuck_on}, "valve failed open"),
    Member("degraded", DegradedParams, {"inflict": degraded}, "partly blocked feed or catalyst"),
)
