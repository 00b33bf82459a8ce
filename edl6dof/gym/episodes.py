"""Episodes of a task, flown together, and the dispersed flights in which they begin."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from copy import deepcopy
from threading import Lock
from typing import Any, NamedTuple

import numpy as np

from edl6dof.api.simulation import DispersedFlights, Start
from edl6dof.config.errors import refusal
from edl6dof.config.wording import unknown
from edl6dof.gym.task import Task

#: Flights in a row that may end before the task begins.
_PATIENCE = 20
#: Number of cases that an episode can ask for.  One whose flight ends before the task begins is replaced by
#: the case this many further on, which is in no pool.
_CASES = 2**26


class StartPool:
    """Starts of the episodes of a task by case number, each flown when it is first needed.

    Args:
        task: the task.
        size: number of cases to draw from.
        first: number of the first case.

    Attributes:
        drawn: case numbers that an episode draws from.
        known: starts that were flown, by case number.

    Raises:
        ValueError: there are no such cases.
    """

    def __init__(self, task: type[Task], size: int, first: int):
        whole = all(isinstance(one, int | np.integer) and not isinstance(one, bool) for one in (size, first))
        if not whole or size < 1 or first < 0 or first + size > _CASES:
            raise ValueError(
                f"pool must be at least 1 and first_case at least 0, whole and together at most {_CASES} "
                f"(got pool={size}, first_case={first})"
            )
        self.drawn = range(first, first + size)
        self._task, self._lock = task, Lock()
        self.flights = DispersedFlights(task.scenario, task.overrides, task.faults)
        self.known: dict[int, Start] = {}

    def __getitem__(self, case: int) -> Start:
        """Return the start of a case, in the pool or not.

        Raises:
            ValueError: there is no such case.
        """
        if isinstance(case, bool) or not isinstance(case, int | np.integer) or not 0 <= case < _CASES:
            raise ValueError(f"a case must be a whole number from 0 to {_CASES - 1} (got {case!r})")
        with self._lock:
            if case not in self.known:
                self.known[case] = self._flown(case)
            return self.known[case]

    def _flown(self, case: int) -> Start:
        """Fly a case up to the task; if the flight ends before, replace it by another case."""
        task = self._task
        for seed in range(case, _PATIENCE * _CASES, _CASES):
            if (start := self.flights.at_phase(seed, task.role, task.later_s)) is not None:
                return start
        raise refusal(task.scenario, f"none of {_PATIENCE} flights came to the phase {task.role}")


class Outcome(NamedTuple):
    """Result of a step, arrays of shape (flights,) or (flights, size)."""

    observation: np.ndarray
    reward: np.ndarray
    terminated: np.ndarray
    truncated: np.ndarray
    success: np.ndarray


def known_options(options: Mapping[str, Any] | None, known: Sequence[str]) -> Mapping[str, Any]:
    """Return the options of a reset; raise ValueError for an unknown one."""
    for name in options or {}:
        if name not in known:
            raise ValueError(unknown("option", name, known))
    return options or {}


class Episodes:
    """Episodes of a task that are stepped together.

    Args:
        task: the task.
        count: number of episodes.
        workers: number of threads.
        pool: number of dispersed flights that episodes draw from.
        first_case: case number of the first flight of the pool.
    """

    def __init__(self, task: type[Task], count: int, workers: int, pool: int, first_case: int = 0):
        self._made_with = task, count, workers, pool, first_case
        self._starts = StartPool(task, pool, first_case)
        flights = self._starts.flights
        self.fleet = flights.fleet(count, workers)
        self.task = task(flights.loaded, self.fleet)
        base = flights.loaded.scenario.flight_software.rates.base_hz
        self._cycles, self._longest = round(task.interval_s * base), round(task.longest_s / task.interval_s)
        self._steps = np.zeros(count, np.int64)

    def __getstate__(self) -> dict[str, Any]:
        own = {name: value for name, value in vars(self.task).items() if name not in ("loaded", "fleet")}
        return {
            "made_with": self._made_with,
            "known": self._starts.known,
            "flights": self.fleet.flights,
            "steps": self._steps,
            "task": own,
        }

    def __setstate__(self, state: dict[str, Any]) -> None:
        """Restore from a pickle: build all objects again and put the flights into their saved states."""
        self.__init__(*state["made_with"])  # type: ignore[misc]
        self._starts.known.update(state["known"])
        self.fleet.restore(state["flights"])
        self._steps[:] = state["steps"]
        vars(self.task).update(deepcopy(state["task"]))

    def begin(self, which: Iterable[int], generators: list[np.random.Generator]) -> None:
        """Begin the next episode in some flights, each with a case of the pool drawn by its own generator."""
        drawn = self._starts.drawn
        for index in which:
            self.begin_with(index, drawn[int(generators[index].integers(len(drawn)))])

    def begin_with(self, index: int, case: int) -> None:
        """Begin the next episode in a flight, with the dispersed case of a number."""
        self.fleet.put(index, self._starts[case])
        self._steps[index] = 0
        self.task.begin(index)

    def step(self, actions: np.ndarray) -> Outcome:
        """Take one action in each episode; flights that have ended stay where they are."""
        self.task.command(self.task.allowed(actions))
        self.fleet.advance(self._cycles)
        self._steps += 1
        reward, over, success = self.task.result()
        truncated = ~over & (self._steps >= self._longest)
        self.fleet.halt(over | truncated)
        return Outcome(self.task.observe(), reward, over, truncated, success)
