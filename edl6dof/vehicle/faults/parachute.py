"""Faults of one parachute: a late mortar."""

from __future__ import annotations

from edl6dof.config.base import param
from edl6dof.interface.events import DEPLOY
from edl6dof.jit import kernel
from edl6dof.registry import Member
from edl6dof.vehicle.faults.component import ParachuteFault


class ParachuteDelayParams(ParachuteFault):
    """The mortar fires late."""

    delay_s: float = param(3.0, "time lost", gt=0.0, le=600.0)


@kernel
def parachute_delay(fault, case, since, command, plant):
    """Put the deployment off when it is commanded."""
    for k in range(case.events.n_events):
        event = case.events.events[k]
        if command.request[k] != 0 and event.action == DEPLOY and event.thing == fault.component:
            plant.due[k] += fault.params.parachute_delay.delay


MEMBERS = (Member("parachute_delay", ParachuteDelayParams, {"inflict": parachute_delay}, "late mortar"),)
