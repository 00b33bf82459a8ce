"""Kernels that are given functions, called with those of the members that the records choose."""

from functools import cache, reduce
from operator import getitem

from edl6dof.fsw.allocation import update as allocation
from edl6dof.fsw.functions import PLACES
from edl6dof.fsw.guidance.entry import registry as entry
from edl6dof.fsw.guidance.entry import steering
from edl6dof.fsw.hazard import update as hazard
from edl6dof.fsw.hazard.registry import GIVEN
from edl6dof.kernels.functions import Bundle
from edl6dof.sim.functions import PLACES as OF_PLANT
from edl6dof.vehicle import actuate as actuation
from edl6dof.vehicle.faults import fault


@cache
def _bundle(*names):
    return Bundle(__file__, {name: (PLACES | OF_PLANT)[name].type for name in names})


def chosen(onboard, *names):
    """The functions of these names that an ``ONBOARD`` record chooses."""
    places = {name: PLACES[name] for name in names}
    return _bundle(*names)(
        **{name: one.functions({int(reduce(getitem, one.path, onboard))}) for name, one in places.items()}
    )


def breaking(case):
    """The functions of the kinds of fault that a ``CASE`` record names."""
    faults = case["faults"]
    kinds = {int(kind) for kind in faults["slots"]["params"]["kind"][: int(faults["count"])]}
    return _bundle("inflict")(inflict=OF_PLANT["inflict"].functions(kinds))


def actuate(case, command, plant):
    """:func:`edl6dof.vehicle.actuate.actuate`."""
    actuation.actuate(breaking(case), case, command, plant)


def inflict(case, command, plant):
    """:func:`edl6dof.vehicle.faults.fault.inflict`."""
    fault.inflict(breaking(case), case, command, plant)


def allocate(onboard, *given):
    """:func:`edl6dof.fsw.allocation.update.allocate` by the method of an ``ONBOARD`` record."""
    allocation.allocate(chosen(onboard, "share_out"), onboard["allocation"], *given)


def steer_bank(onboard, *given):
    """:func:`edl6dof.fsw.guidance.entry.steering.steer_bank`."""
    steering.steer_bank(chosen(onboard, "bank_side"), onboard, *given)


def detect_hazards(onboard, *given):
    """:func:`edl6dof.fsw.hazard.update.detect_hazards`."""
    if int(onboard["hazard"]["detection"]) != GIVEN:
        hazard.detect_hazards(chosen(onboard, "classify"), onboard, *given)


def entry_guidance(law, onboard, *given):
    """:func:`edl6dof.fsw.guidance.entry.registry.entry_guidance` by law number ``law``."""
    places = {name: PLACES[name] for name in ("entry_law", "bank_side")}
    logic = int(onboard["guidance"]["entry"]["reversal"]["logic"])
    functions = _bundle(*places)(
        entry_law=places["entry_law"].functions({law}), bank_side=places["bank_side"].functions({logic})
    )
    entry.entry_guidance(functions, onboard, *given)
