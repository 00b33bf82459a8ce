"""The environments: a task in one flight, or in many that one call steps together."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import gymnasium
import numpy as np
from gymnasium.utils.seeding import np_random
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space

from edl6dof.api.live import WatchedFleet
from edl6dof.config.wording import unknown
from edl6dof.gym.episodes import Episodes, known_options
from edl6dof.gym.task import Task
from edl6dof.gym.tasks import DeadThruster, EntryBank, FaultDiagnosis, HazardDivert, PoweredDescent

TASKS: dict[str, type[Task]] = {
    task.__name__: task for task in (EntryBank, PoweredDescent, HazardDivert, DeadThruster, FaultDiagnosis)
}


def task_called(name: str) -> type[Task]:
    """Return the task of a name; raise ValueError if there is none."""
    if name not in TASKS:
        raise ValueError(unknown("task", name, TASKS))
    return TASKS[name]


class FlightEnv(gymnasium.Env[np.ndarray, Any]):
    """A task in one flight.

    It can be copied and pickled, even in an episode.  The information of the last step of an episode has
    ``is_success``.

    Args:
        task: name of the task, one of :data:`edl6dof.gym.TASKS`.
        pool: number of dispersed flights that episodes draw from; each is flown when it is first drawn.
        first_case: case number of the first flight of the pool.  Environments whose ranges of ``pool`` cases
            from ``first_case`` on do not overlap have no flight in common.
        render_mode: ``None``, or ``human`` to show each episode in the desktop viewer while it is stepped, as
            :func:`edl6dof.live` does.

    Raises:
        ValueError: there is no such task, pool or render mode.
    """

    metadata: dict[str, Any] = {"render_modes": ["human"], "render_fps": 2.0}

    def __init__(self, task: str, pool: int = 64, first_case: int = 0, render_mode: str | None = None):
        if render_mode not in (None, *self.metadata["render_modes"]):
            raise ValueError(unknown("render mode", render_mode, self.metadata["render_modes"]))
        self.render_mode = render_mode
        self._watched: WatchedFleet | None = None
        self._episodes = Episodes(task_called(task), 1, 1, pool, first_case)
        self.observation_space = self.task.observation_space
        self.action_space = self.task.action_space

    @property
    def task(self) -> Task:
        """The task."""
        return self._episodes.task

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Begin an episode with a case that is drawn from the pool, or with any case by the option ``case``.

        Raises:
            ValueError: there is no such case, or no such option.
        """
        super().reset(seed=seed)
        given = known_options(options, ["case"])
        if "case" in given:
            self._episodes.begin_with(0, given["case"])
        else:
            self._episodes.begin([0], [self.np_random])
        if self.render_mode is not None:
            self._watched = self._watched or WatchedFleet(self.task.fleet, self.task.loaded)
            self._watched.begin()
        return self.task.observe()[0], {}

    def step(self, action: Any) -> tuple[np.ndarray, float, bool, bool, dict[str, Any]]:
        """Take an action; a number beyond its bound counts as the bound.

        Raises:
            ValueError: the action has a wrong shape, is not finite, or is no choice of the task.
        """
        seen, *values = self._episodes.step(np.asarray(action)[None])
        reward, over, cut_off, success = (one.item() for one in values)
        if self._watched is not None:
            self._watched.step(over or cut_off)
        return seen[0], reward, over, cut_off, {"is_success": success} if over or cut_off else {}

    def baseline(self) -> Any:
        """Return the action that the flight software itself would take now."""
        return self.task.baseline()[0]

    def render(self) -> None:
        """Draw nothing: each step has updated the viewer."""

    def close(self) -> None:
        """Close the viewer."""
        if self._watched is not None:
            self._watched.close()
            self._watched = None

    def __getstate__(self) -> dict[str, Any]:
        """State for a copy or a pickle, which opens a viewer of its own at its next reset."""
        return {**vars(self), "_watched": None}


class FlightVectorEnv(VectorEnv[np.ndarray, Any, np.ndarray]):
    """A task in many flights, each of which is the same as in a :class:`FlightEnv` with its seed.

    The information of a step has ``is_success`` and ``_is_success`` of the flights whose episodes it ended.

    Args:
        task: name of the task.
        num_envs: number of flights.
        pool: number of dispersed flights that episodes draw from.
        first_case: case number of the first flight of the pool, as for :class:`FlightEnv`.
        workers: number of threads.
        autoreset_mode: when the next episode of a flight begins: in the next step, whose action is not used
            (the default); in the same step, whose information then has ``final_obs``; or when ``reset`` is
            called with the option ``reset_mask``.
        render_mode: always ``None``.
    """

    def __init__(
        self,
        task: str,
        num_envs: int = 1,
        pool: int = 64,
        first_case: int = 0,
        workers: int = 1,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        render_mode: str | None = None,
    ):
        self.render_mode = render_mode
        self.num_envs = num_envs
        self._mode = AutoresetMode(autoreset_mode)
        self.metadata = {"autoreset_mode": self._mode, "render_modes": []}
        self._episodes = Episodes(task_called(task), num_envs, workers, pool, first_case)
        self.single_observation_space = self.task.observation_space
        self.single_action_space = self.task.action_space
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self._generators: list[np.random.Generator] = []
        self._ended = np.zeros(num_envs, bool)

    @property
    def task(self) -> Task:
        """The task."""
        return self._episodes.task

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Begin episodes: all, or those of the option ``reset_mask``, shape (num_envs,), bool."""
        self._seed(seed)
        mask = known_options(options, ["reset_mask"]).get("reset_mask")
        which = np.ones(self.num_envs, bool) if mask is None else np.asarray(mask, bool)
        if which.shape != (self.num_envs,):
            raise ValueError(f"reset_mask must have {self.num_envs} values (got {which.shape})")
        self._begin(which)
        return self.task.observe(), {}

    def _seed(self, seed: int | Sequence[int | None] | None) -> None:
        """Seed the generator of each flight; a whole number is the first seed, the others count up."""
        every = range(self.num_envs)
        seeds = [seed + k for k in every] if isinstance(seed, int) else seed or [None for _ in every]
        if len(seeds) != self.num_envs:
            raise ValueError(f"there must be {self.num_envs} seeds (got {len(seeds)})")
        kept = self._generators or [np_random()[0] for _ in every]
        self._generators = [
            old if one is None else np_random(one)[0] for one, old in zip(seeds, kept, strict=True)
        ]

    def _begin(self, which: np.ndarray) -> None:
        self._episodes.begin(np.flatnonzero(which), self._generators)
        self._ended[which] = False

    def step(self, actions: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, dict[str, Any]]:
        """Take one action in each flight; a number beyond its bound counts as the bound.

        Raises:
            ValueError: the actions have a wrong shape, are not finite, or are no choices of the task.
        """
        begins = self._ended
        if self._mode is AutoresetMode.DISABLED and begins.any():
            raise ValueError(f"episodes {np.flatnonzero(begins).tolist()} have ended; reset them first")
        seen, reward, over, cut_off, success = self._episodes.step(np.asarray(actions))
        if begins.any():
            for values in (reward, over, cut_off, success):
                values[begins] = 0
            self._begin(begins.copy())
            seen = self.task.observe()
        self._ended = over | cut_off
        information: dict[str, Any] = {}
        if self._ended.any():
            information = {"is_success": success, "_is_success": self._ended.copy()}
            if self._mode is AutoresetMode.SAME_STEP:
                information |= {"final_obs": _rows(seen, self._ended), "_final_obs": self._ended.copy()}
                self._begin(self._ended.copy())
                seen = self.task.observe()
        return seen, reward, over, cut_off, information

    def baseline(self) -> np.ndarray:
        """Return the actions that the flight software itself would take now, shape (num_envs, ...)."""
        return self.task.baseline()

    def close_extras(self, **kwargs: Any) -> None:
        """Stop the threads."""
        self._episodes.fleet.close()


def _rows(observations: np.ndarray, which: np.ndarray) -> np.ndarray:
    """Array of objects: the observations of the flights in ``which``, ``None`` for the others."""
    rows = np.full(len(which), None, dtype=object)
    for index in np.flatnonzero(which):
        rows[index] = observations[index].copy()
    return rows
