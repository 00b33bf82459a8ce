"""A part of a flight as a task to learn: where it begins, observation, command and reward.

A task works on a fleet, all its flights at once; an environment of one flight has a fleet of one.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from gymnasium import spaces

import edl6dof
from edl6dof.api.simulation import Fleet

#: Bound of every observation, in its scale.
BOUND = 10.0


@dataclass(frozen=True)
class Feature:
    """Numbers of an observation: name, scale they are divided by and its unit, and their source in the
    memories of the flight computers (``FSW``, shape (flights,)): a dotted path, or a function that returns
    them, (flights,) or (flights, n).
    """

    name: str
    scale: float
    unit: str
    source: str | Callable[[np.ndarray], np.ndarray] = field(repr=False)
    size: int = 1

    def __str__(self) -> str:
        return f"{self.name} / {self.scale_and_unit}" + (f", {self.size} numbers" if self.size > 1 else "")

    @property
    def scale_and_unit(self) -> str:
        """The scale in words, such as ``60 m/s2``."""
        return f"{self.scale:g} {self.unit}".rstrip()

    def read(self, memories: np.ndarray) -> np.ndarray:
        """Return the numbers in their scale, shape (flights, size)."""
        if isinstance(self.source, str):
            found = memories
            for name in self.source.split("."):
                found = found[name]
        else:
            found = self.source(memories)
        return np.asarray(found, float).reshape(len(memories), -1) / self.scale


class StepResult(NamedTuple):
    """Result of a step, each shape (flights,): reward, whether the task is over, whether it succeeded."""

    reward: np.ndarray
    over: np.ndarray
    success: np.ndarray


class Task(ABC):
    """A task to learn, flown by all flights of a fleet."""

    title: str
    scenario: str = "tianwen1_mc"  # scenario or campaign that episodes are taken from
    overrides: Mapping[str, Any] = {}  # changes of the scenario
    faults: tuple[Mapping[str, Any], ...] = ()  # each flight has one of these
    role: str  # of the mission phase in which an episode begins
    later_s: float = 0.0  # time from the beginning of that phase to the episode, s
    interval_s: float  # time between two actions, s
    longest_s: float  # time after which an episode is cut off, s
    features: tuple[Feature, ...]  # of an observation
    size: int  # numbers of an action

    def __init__(self, loaded: edl6dof.LoadedScenario, fleet: Fleet):
        self.loaded, self.fleet = loaded, fleet
        self.roles = np.array(loaded.scenario.phase_roles)

    def __str__(self) -> str:
        """Observation with scales and units, action and reward."""
        seen = "".join(f"\n  {feature}" for feature in self.features)
        about = " ".join((self.__doc__ or "").split())
        return f"{self.title}\nobservation:{seen}\n{about}"

    @property
    def observation_space(self) -> spaces.Space:
        """Numbers between -10 and 10, most of them below 1."""
        size = sum(feature.size for feature in self.features)
        return spaces.Box(-BOUND, BOUND, (size,), np.float32)

    @property
    def action_space(self) -> spaces.Space:
        """Actions of a policy: ``size`` numbers between -1 and 1."""
        return spaces.Box(-1.0, 1.0, (self.size,), np.float32)

    def observe(self) -> np.ndarray:
        """Return the observation, which contains only what the flight computers know; shape (flights,
        size).
        """
        columns = [feature.read(self.fleet.memories) for feature in self.features]
        return np.clip(np.concatenate(columns, axis=1), -BOUND, BOUND).astype(np.float32)

    def allowed(self, actions: Any) -> np.ndarray:
        """Return the actions of a policy as the task uses them, one for each flight; a number beyond its
        bound is replaced by the bound.

        Raises:
            ValueError: the actions have a wrong shape, are not finite, or are no choices of the task.
        """
        space, given = self.action_space, np.asarray(actions)
        shape = (len(self.fleet), *(space.shape or ()))
        if given.shape != shape:
            raise ValueError(f"actions must have the shape {shape[1:]} (got {given.shape[1:]})")
        if isinstance(space, spaces.Discrete):
            if given.dtype.kind not in "iu" or not ((given >= 0) & (given < space.n)).all():
                raise ValueError(f"an action must be a whole number from 0 to {space.n - 1} (got {given})")
            return given
        if given.dtype.kind not in "iuf" or not np.isfinite(given).all():
            raise ValueError(f"actions must be finite numbers (got {given})")
        return np.clip(given, -1.0, 1.0)

    @abstractmethod
    def command(self, actions: np.ndarray) -> None:
        """Give the flights their commands; ``actions``: one for each flight."""

    @abstractmethod
    def baseline(self) -> np.ndarray:
        """Return the actions of the flight software itself."""

    @abstractmethod
    def result(self) -> StepResult:
        """Evaluate the step since the last call."""

    def begin(self, index: int) -> None:  # noqa: B027  few tasks remember anything
        """Reset the memory of the task for a flight that begins an episode."""

    def give(self, command: str, given: Any = 1, **values: np.ndarray) -> None:
        """Write a command and its fields ``values`` for all flights, or only where ``given`` is true."""
        external = self.fleet.memories["external"]
        external["given"][command] = given
        for name, value in values.items():
            external[name] = value

    def in_role(self, role: str) -> np.ndarray:
        """True for each flight in a phase of the role, shape (flights,)."""
        return self.roles[self.fleet.memories["mission"]["phase"]] == role

    def ended(self) -> np.ndarray:
        """True for each flight that has ended, shape (flights,)."""
        return ~self.fleet.flying

    def landing(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return three arrays of shape (flights,): True for flights that have ended, True for those that
        landed within limits, and the reward, which is 1 for these and -1 for the others that have ended.
        """
        over, success = self.ended(), self.fleet.landed_well(self.loaded.scenario.limits)
        return over, success, np.where(over, np.where(success, 1.0, -1.0), 0.0)
