"""Episodes of a task, flown side by side: what both kinds of environment are made of."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from edl6dof.gym.starts import StartPool
from edl6dof.gym.task import Task


class Outcome(NamedTuple):
    """What a step came to, each shape (flights,) or (flights, size)."""

    observation: np.ndarray
    reward: np.ndarray
    terminated: np.ndarray
    truncated: np.ndarray
    success: np.ndarray


class Episodes:
    """Episodes under way.

    Args:
        task: the task.
        count: how many.
        workers: threads.
        pool: dispersed flights that episodes begin from.
    """

    def __init__(self, task: type[Task], count: int, workers: int, pool: int):
        self._starts = StartPool(task, pool)
        self.fleet = self._starts.fleet(count, workers)
        self.task = task(self._starts.loaded, self.fleet)
        self.interval_s = task.interval_s
        base = self._starts.loaded.scenario.flight_software.rates.base_hz
        self._cycles, self._longest = round(task.interval_s * base), round(task.longest_s / task.interval_s)
        self._steps = np.zeros(count, np.int64)

    def begin(self, which: Iterable[int], generators: list[np.random.Generator]) -> None:
        """Let some episodes begin anew, each with a flight that its own generator draws."""
        for index in which:
            self.begin_with(index, int(generators[index].integers(len(self._starts))))

    def begin_with(self, index: int, number: int) -> None:
        """Let an episode begin anew, with the dispersed flight of a number below that of the pool."""
        self.fleet.put(index, self._starts[number])
        self._steps[index] = 0
        self.task.begin(index)

    def observe(self) -> np.ndarray:
        """What the flight computers know, shape (flights, size)."""
        return self.task.observe()

    def step(self, actions: np.ndarray) -> Outcome:
        """One action each; flights that have ended stay where they are."""
        self.task.command(actions)
        self.fleet.advance(self._cycles)
        self._steps += 1
        reward, over, success = self.task.result()
        truncated = ~over & (self._steps >= self._longest)
        self.fleet.halt(over | truncated)
        return Outcome(self.task.observe(), reward, over, truncated, success)
