"""Kernels that are given functions, called with those of the members that the records choose."""

from edl6dof.fsw.allocation.registry import allocate as shared_out
from edl6dof.fsw.functions import PLACES as SOFTWARE
from edl6dof.fsw.functions import chosen
from edl6dof.fsw.guidance.entry import registry as entry
from edl6dof.fsw.guidance.entry.reversal import registry as steering
from edl6dof.fsw.hazard import detection as hazard
from edl6dof.fsw.hazard.registry import GIVEN
from edl6dof.kernels import kernel
from edl6dof.sensors import registry as sensing
from edl6dof.sim.functions import PLACES
from edl6dof.vehicle import actuate as actuation


def breaking(case):
    """The function of the kinds of fault that a ``CASE`` record names."""
    faults = case["faults"]
    kinds = {int(kind) for kind in faults["slots"]["params"]["kind"][: int(faults["count"])]}
    return PLACES["inflict"].function(kinds)


def actuate(case, command, plant):
    """:func:`edl6dof.vehicle.actuate.actuate`."""
    actuation.actuate(breaking(case), case, command, plant)


def inflict(case, command, plant):
    """:func:`edl6dof.vehicle.actuate.inflict`."""
    actuation.inflict(breaking(case), case, command, plant)


def sense(case, *given):
    """:func:`edl6dof.sensors.registry.sense` by the sensors that a ``CASE`` record carries."""
    params = case["sensors"]["params"]
    carried = {int(one) for one in params["carried"][: int(params["n_carried"])]}
    sensing.sense(PLACES["measure"].function(carried), case, *given)


@kernel
def _allocate(share_out, params, vehicle, health, effectiveness, demand, out):
    shared_out(share_out, params, vehicle, health.thruster, effectiveness, demand, out)


def allocate(params, vehicle, health, effectiveness, demand, out):
    """:func:`edl6dof.fsw.allocation.registry.allocate` by the method of the parameters, with a ``HEALTH``
    record.
    """
    share_out = SOFTWARE["share_out"].function({int(params["method"])})
    _allocate(share_out, params, vehicle, health, effectiveness, demand, out)


def steer_bank(onboard, *given):
    """:func:`edl6dof.fsw.guidance.entry.reversal.registry.steer_bank`."""
    steering.steer_bank(chosen("bank_side", onboard), onboard, *given)


def detect_hazards(onboard, *given):
    """:func:`edl6dof.fsw.hazard.detection.detect_hazards`."""
    if int(onboard["hazard"]["detection"]) != GIVEN:
        hazard.detect_hazards(chosen("classify", onboard), onboard, *given)


def entry_guidance(law, onboard, *given):
    """:func:`edl6dof.fsw.guidance.entry.registry.entry_guidance` by law number ``law``."""
    entry_law = SOFTWARE["entry_law"].function({law})
    entry.entry_guidance(entry_law, chosen("bank_side", onboard), onboard, *given)
