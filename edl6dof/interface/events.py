"""Events: what the flight software requests and the vehicle then does, each at most once.

Their names belong to the scenario.  Both sides number them as the scenario first names them, and know of each
what is done, to which component, and how long it takes from the command.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal, get_args

import numpy as np

from edl6dof.interface.capacities import MAX_EVENTS
from edl6dof.kernels import kernel

#: What an event does; records carry the index.  Jettison a part; deploy or release a parachute; extend a
#: surface or the landing gear; ignite or cut off an engine.
Action = Literal["jettison", "deploy", "release", "extend", "ignite", "cut_off"]
ACTIONS: tuple[Action, ...] = get_args(Action)
JETTISON, DEPLOY, RELEASE, EXTEND, IGNITE, CUT_OFF = range(len(ACTIONS))

#: The component of an event that extends the landing gear; all others have their index in their list.
LANDING_GEAR = -1

EVENT = np.dtype(
    [
        ("action", "i8"),  # index in ACTIONS
        # index of the part, parachute, surface or engine in its list; LANDING_GEAR; of a group of engines
        # less than zero: its size is a bit for each
        ("component", "i8"),
        ("delay", "f8"),  # s, from the command to what is done
    ],
    align=True,
)
EVENT_TABLE = np.dtype(
    [
        ("events", EVENT, (MAX_EVENTS,)),  # in the order of their numbers
        ("n_events", "i8"),  # how many the mission has
    ],
    align=True,
)


def group_of(indices: Iterable[int]) -> int:
    """The component of an event that is done to several engines."""
    return -sum(1 << index for index in indices)


@kernel
def is_done_to(event, engine):
    """Test whether an event that ignites or cuts off concerns an ``engine``, alone or in a group."""
    if event.component >= 0:
        return event.component == engine
    return (-event.component >> engine) & 1 != 0
