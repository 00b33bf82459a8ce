"""The tasks by name."""

from __future__ import annotations

from edl6dof.config.wording import unknown
from edl6dof.gym.entry_bank import EntryBank
from edl6dof.gym.hazard_divert import HazardDivert
from edl6dof.gym.powered_descent import PoweredDescent
from edl6dof.gym.task import Task
from edl6dof.gym.thruster_fault import DeadThruster, FaultDiagnosis

TASKS: dict[str, type[Task]] = {
    task.__name__: task for task in (EntryBank, PoweredDescent, HazardDivert, DeadThruster, FaultDiagnosis)
}


def task_called(name: str) -> type[Task]:
    """A task by its name.

    Raises:
        ValueError: there is none of this name.
    """
    if name not in TASKS:
        raise ValueError(unknown("task", name, TASKS))
    return TASKS[name]
