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
from edl6dof.api.fleet import Fleet

#: Bound of every observation, in its scale.
BOUND = 10.0


@dataclass(frozen=True)
class Feature:
    """Numbers of an observation: what they are, the scale they are divided by, and where they stand in the
    memories of the flight computers (``FSW``, shape (flights,)), as (flights,) or (flights, n).
    """

    name: str
    scale: float
    read: Callable[[np.ndarray], np.ndarray] = field(repr=False)
    size: int = 1


class StepResult(NamedTuple):
    """Result of a step, each shape (flights,): reward, true where the task is over, and where it was done."""

    reward: np.ndarray
    over: np.ndarray
    success: np.ndarray


class Task(ABC):
    """A task."""

    title: str
    scenario: str = "tianwen1_mc"  # scenario or campaign that episodes are taken from
    overrides: Mapping[str, Any] = {}  # changes of it
    faults: tuple[Mapping[str, Any], ...] = ()  # of which each flight has one
    role: str  # of the mission phase in which an episode begins
    later_s: float = 0.0  # time from the beginning of that phase to the episode, s
    interval_s: float  # time between two actions, s
    longest_s: float  # time after which an episode is cut off, s
    features: tuple[Feature, ...]  # of an observation
    size: int  # numbers of an action

    def __init__(self, loaded: edl6dof.LoadedScenario, fleet: Fleet):
        self.loaded, self.fleet = loaded, fleet
        self.roles = np.array(loaded.scenario.phase_roles)
        self.thrusters = loaded.scenario.thruster_names

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
        """Observe what the flight computers know, shape (flights, size); nothing of it is the truth."""
        columns = [
            np.asarray(feature.read(self.fleet.memories), float).reshape(len(self.fleet), -1) / feature.scale
            for feature in self.features
        ]
        return np.clip(np.concatenate(columns, axis=1), -BOUND, BOUND).astype(np.float32)

    def allowed(self, actions: Any) -> np.ndarray:
        """Actions of a policy as the task takes them, one for each flight: a number beyond its bound counts
        as the bound.

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
        """Forget the episode of a flight that begins anew."""

    def in_roles(self, *roles: str) -> np.ndarray:
        """True for each flight in a phase of these roles, shape (flights,)."""
        return np.isin(self.roles[self.fleet.memories["mission"]["phase"]], roles)

    def ended(self) -> np.ndarray:
        """True for each flight that has ended, shape (flights,)."""
        return ~self.fleet.flying


def nav(field: str) -> Callable[[np.ndarray], np.ndarray]:
    """Return a function that reads a field of navigation."""
    return lambda memories: memories["nav"][field]


def guide(field: str) -> Callable[[np.ndarray], np.ndarray]:
    """Reader of a field of guidance."""
    return lambda memories: memories["guide"][field]
