"""A vehicle of Tianwen-1 with faults, for its actuators."""

import numpy as np

import edl6dof
from edl6dof.interface.command import COMMAND
from edl6dof.scenario.records import build_case, initial_plant

CYCLE = 0.02
D7, D8 = 6, 7
PARACHUTE_PHASE = edl6dof.load("tianwen1").scenario.phase_names.index("parachute")

#: Numbers of two events of the mission.
MORTAR, IGNITION = (
    list(edl6dof.load("tianwen1").scenario.mission.events).index(name) for name in ("mortar", "ignition")
)


def broken(tables, *faults, others=()):
    """Case, plant and an idle command of a vehicle with these faults."""
    scenario = edl6dof.load("tianwen1", [*others, f"faults=[{', '.join(faults)}]"]).scenario
    case = build_case(scenario, tables)
    return case[0], initial_plant(scenario, case)[0], np.zeros(1, COMMAND)[0]
