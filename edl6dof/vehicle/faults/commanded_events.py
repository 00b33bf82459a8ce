"""What a fault does to an event when it is commanded: it happens later, or never."""

from __future__ import annotations

from edl6dof.interface.events import IGNITE, is_done_to
from edl6dof.kernels import kernel

#: Time (s) of what never happens.
NEVER = 1e99


@kernel
def is_about(event, action, component):
    """Whether an event is an ``action`` on a ``component``, or on a group of engines with it."""
    if event.action != action:
        return False
    return is_done_to(event, component) if action >= IGNITE else event.component == component


@kernel
def put_off(case, command, plant, action, component, delay):
    """Delay an ``action`` on a ``component`` by ``delay`` s if it is commanded in this cycle; engines
    that are lit together wait for each other.
    """
    for k in range(case.events.n_events):
        event = case.events.events[k]
        if command.request[k] != 0 and is_about(event, action, component):
            plant.due[k] += delay


@kernel
def prevent(case, plant, action, component):
    """Let an ``action`` on a ``component`` that is due not happen."""
    for k in range(case.events.n_events):
        event = case.events.events[k]
        if is_about(event, action, component):
            plant.due[k] = NEVER
