"""Faults of thrusters: one dead, open, or weak; all behind one latch valve dead; all weak at once."""

from __future__ import annotations

from typing import ClassVar

from edl6dof.config.base import param
from edl6dof.interface.effectors import DEGRADED, STUCK_OFF, STUCK_ON, ThrusterFailure
from edl6dof.kernels import kernel
from edl6dof.registry import Member
from edl6dof.vehicle.faults.component import BranchFault, RcsFault, ThrusterFault

#: Longer than any base cycle, s: a valve held open is open all through it.
LONG = 1.0


class StuckOffParams(ThrusterFault):
    """The thruster does not fire any more."""

    failure: ClassVar[ThrusterFailure] = "stuck_off"


class StuckOnParams(ThrusterFault):
    """The thruster's valve does not close any more; only the latch valve of its branch stops it."""

    failure: ClassVar[ThrusterFailure] = "stuck_on"


class DegradedParams(ThrusterFault):
    """The thruster gives less thrust."""

    failure: ClassVar[ThrusterFailure] = "degraded"

    thrust_factor: float = param(0.5, "thrust left", ge=0.0, lt=1.0)
    flow_factor: float = param(
        0.0, "propellant flow left: 1 with a bad catalyst; 0: as much as of the thrust", ge=0.0, le=1.0
    )


class BranchDeadParams(BranchFault):
    """The latch valve of the branch fails shut: none of its thrusters fires any more."""

    failure: ClassVar[ThrusterFailure] = "stuck_off"


class WeakThrustersParams(RcsFault):
    """All thrusters give less thrust, from less flow: low feed pressure, or cold propellant."""

    failure: ClassVar[ThrusterFailure] = "degraded"

    thrust_factor: float = param(0.8, "thrust and flow left", ge=0.0, lt=1.0)


@kernel
def stuck_off(fault, case, since, command, plant):
    """Keep the valve shut."""
    i = fault.component
    plant.valves.fault[i] = STUCK_OFF
    plant.valves.open_time[i] = plant.valves.close_time[i] = plant.t


@kernel
def stuck_on(fault, case, since, command, plant):
    """Keep the valve open."""
    i = fault.component
    plant.valves.fault[i] = STUCK_ON
    plant.valves.open_time[i], plant.valves.close_time[i] = plant.t, plant.t + LONG


@kernel
def degraded(fault, case, since, command, plant):
    """Take away part of the thrust."""
    i = fault.component
    plant.valves.fault[i] = DEGRADED
    p = fault.params.degraded
    plant.valves.lost[i] = 1.0 - p.thrust_factor
    plant.valves.flow_lost[i] = 1.0 - (p.flow_factor if p.flow_factor > 0.0 else p.thrust_factor)


@kernel
def branch_dead(fault, case, since, command, plant):
    """Keep all valves of the branch shut."""
    for i in range(case.vehicle.rcs.n_thrusters):
        if case.branches.of[i] == fault.component:
            plant.valves.fault[i] = STUCK_OFF
            plant.valves.open_time[i] = plant.valves.close_time[i] = plant.t


@kernel
def weak_thrusters(fault, case, since, command, plant):
    """Take away part of the thrust and flow of all."""
    plant.valves.feed_lost = 1.0 - fault.params.weak_thrusters.thrust_factor
    for i in range(case.vehicle.rcs.n_thrusters):
        if plant.valves.fault[i] == 0:
            plant.valves.fault[i] = DEGRADED


MEMBERS = (
    Member("stuck_off", StuckOffParams, {"inflict": stuck_off}, "Hu et al. 2022, section 6.3"),
    Member("stuck_on", StuckOnParams, {"inflict": stuck_on}, "valve failed open"),
    Member("degraded", DegradedParams, {"inflict": degraded}, "partly blocked feed or catalyst"),
    Member("branch_dead", BranchDeadParams, {"inflict": branch_dead}, "latch valve failed shut"),
    Member("weak_thrusters", WeakThrustersParams, {"inflict": weak_thrusters}, "low feed pressure"),
)
