"""Effectors: modes of the engines; groups, failures and branches of the thrusters; events of a mission.

An event is an action that the flight software requests and the vehicle carries out, at most once.  Its name
belongs to the scenario.  Both sides number the events in the order in which the scenario first names them,
and know the action, the component and the delay of each.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal, get_args

from edl6dof.interface.capacities import MAX_BRANCHES, MAX_EVENTS, MAX_THRUSTERS
from edl6dof.kernels import kernel
from edl6dof.records import record

#: Off; within the throttle band; at the full level of the start, with its fast build-up.  Records carry the
#: number.
ENGINE_OFF, ENGINE_THROTTLE, ENGINE_FULL = range(3)

#: Horizontal: hazard avoidance and roll; axial: parallel to the engine; attitude: pitch and yaw; fine: fine
#: pointing.  Names in YAML; records carry the index, and masks the bit of that number.
ThrusterGroup = Literal["horizontal", "axial", "attitude", "fine"]
THRUSTER_GROUPS: tuple[ThrusterGroup, ...] = get_args(ThrusterGroup)
HORIZONTAL, AXIAL, ATTITUDE, FINE = range(len(THRUSTER_GROUPS))

#: How a thruster may fail.  Records and telemetry carry the number; 0 is a thruster that works.
ThrusterFailure = Literal["stuck_off", "stuck_on", "degraded"]
THRUSTER_FAILURES: tuple[ThrusterFailure, ...] = get_args(ThrusterFailure)
STUCK_OFF, STUCK_ON, DEGRADED = range(1, len(THRUSTER_FAILURES) + 1)

#: Propellant branches, each behind one latch valve.
BRANCHES = record(
    ("of", "i8", (MAX_THRUSTERS,)),  # branch of each thruster
    ("count", "i8"),  # branches that the vehicle has
    ("full_flow", "f8", (MAX_BRANCHES,)),  # kg/s, with all thrusters of the branch open
)

#: What an event does; records carry the index.  Jettison a part; deploy or release a parachute; extend a
#: surface or the landing gear; ignite or cut off an engine.
Action = Literal["jettison", "deploy", "release", "extend", "ignite", "cut_off"]
ACTIONS: tuple[Action, ...] = get_args(Action)
JETTISON, DEPLOY, RELEASE, EXTEND, IGNITE, CUT_OFF = range(len(ACTIONS))

#: The component of an event that extends the landing gear; all others have their index in their list.
LANDING_GEAR = -1

EVENT = record(
    ("action", "i8"),  # index in ACTIONS
    # index of the part, parachute, surface or engine in its list; LANDING_GEAR; or a group of engines:
    # negative, with a bit of its magnitude for each engine
    ("component", "i8"),
    ("delay", "f8"),  # s, from the command to the action
)
EVENT_TABLE = record(
    ("events", EVENT, (MAX_EVENTS,)),  # in the order of their numbers
    ("n_events", "i8"),  # how many the mission has
)


def group_of(indices: Iterable[int]) -> int:
    """Component number of an event that acts on several engines."""
    return -sum(1 << index for index in indices)


@kernel
def is_done_to(event, engine):
    """True if an event that ignites or cuts off acts on ``engine``, alone or in a group."""
    if event.component >= 0:
        return event.component == engine
    return (-event.component >> engine) & 1 != 0
