"""What a fault does to an event when it is commanded: it happens later, or never."""

from __future__ import annotations

from edl6dof.jit import kernel

#: Time (s) of what never happens.
NEVER = 1e99


@kernel
def put_off(case, command, plant, action, thing, delay):
    """Let an ``action`` on a ``thing`` happen ``delay`` s later, if it is commanded in this cycle."""
    for k in range(case.events.n_events):
        event = case.events.events[k]
        if command.request[k] != 0 and event.action == action and event.thing == thing:
            plant.due[k] += delay


@kernel
def prevent(case, plant, action, thing):
    """Let an ``action`` on a ``thing`` that is due not happen."""
    for k in range(case.events.n_events):
        event = case.events.events[k]
        if event.action == action and event.thing == thing:
            plant.due[k] = NEVER
