"""Where episodes begin: dispersed flights, flown by the flight software up to the task, and kept."""

from __future__ import annotations

from threading import Lock

import numpy as np

from edl6dof.api.fleet import DispersedFlights, Fleet, Start
from edl6dof.config.errors import refusal
from edl6dof.gym.task import Task

#: Flights in a row that may end before the task begins.
_PATIENCE = 20
#: Cases that an episode can ask for.  One that ends before the task begins is replaced by the case this many
#: further on, so that it is in no pool.
_CASES = 2**26


class StartPool:
    """The beginnings of the episodes of a task, each of a dispersed flight of its own, by case number; one is
    flown when it is first asked for.

    Attributes:
        drawn: case numbers that an episode draws from.
        known: the beginnings that were flown, by case number.
    """

    def __init__(self, task: type[Task], size: int, first: int):
        """``size``: cases to draw from; ``first``: the first of them.

        Raises:
            ValueError: there are no such cases.
        """
        whole = all(isinstance(one, int | np.integer) and not isinstance(one, bool) for one in (size, first))
        if not whole or size < 1 or first < 0 or first + size > _CASES:
            raise ValueError(
                f"pool must be at least 1 and first_case at least 0, whole and together at most {_CASES} "
                f"(got pool={size}, first_case={first})"
            )
        self.drawn = range(first, first + size)
        self._task, self._lock = task, Lock()
        self._flights = DispersedFlights(task.scenario, task.overrides, task.faults)
        self.known: dict[int, Start] = {}
        self.loaded = self._flights.loaded

    def __getitem__(self, case: int) -> Start:
        """The beginning of a case, in the pool or not.

        Raises:
            ValueError: there is no such case.
        """
        if isinstance(case, bool) or not isinstance(case, int | np.integer) or not 0 <= case < _CASES:
            raise ValueError(f"a case must be a whole number from 0 to {_CASES - 1} (got {case!r})")
        with self._lock:
            if case not in self.known:
                self.known[case] = self._flown(case)
            return self.known[case]

    def fleet(self, count: int, workers: int) -> Fleet:
        """As many flights of the scenario."""
        return self._flights.fleet(count, workers)

    def _flown(self, case: int) -> Start:
        """The flight of a case; of one that does not come so far another that does.

        Raises:
            ConfigError: no flight comes so far, or they are of several worlds.
        """
        task = self._task
        for seed in range(case, _PATIENCE * _CASES, _CASES):
            if (start := self._flights.at_phase(seed, task.role, task.later_s)) is not None:
                return start
        raise refusal(task.scenario, f"none of {_PATIENCE} flights came to the phase {task.role}")
