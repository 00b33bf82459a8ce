"""Train a policy in a learning environment by stable-baselines3's proximal policy optimisation.

    pip install 'edl6dof[gym]' stable-baselines3
    python tools/train.py [TASK] [--steps 300000] [--flights 16] [--out policy.zip]

The environment of many flights, stepped in one call, is handed to stable-baselines3 by a thin adapter.  The
policy is trained on the first cases; the share of the cases after them that it gets done, one episode each,
is printed last.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from typing import Any

import numpy as np
from stable_baselines3 import PPO
from stable_baselines3.common.vec_env import VecEnv, VecMonitor

from edl6dof.gym import FlightEnv, FlightVectorEnv


class Many(VecEnv):
    """The vector environment of edl6dof as stable-baselines3 knows them: an episode begins anew in the step
    that ends it.
    """

    def __init__(self, env: FlightVectorEnv):
        self._env, self._actions = env, np.zeros(0)
        self.render_mode = None
        super().__init__(env.num_envs, env.single_observation_space, env.single_action_space)

    def reset(self) -> np.ndarray:
        """Begin all episodes."""
        seeds = [seed for seed in self._seeds if seed is not None]
        return self._env.reset(seed=seeds or None)[0]

    def step_async(self, actions: np.ndarray) -> None:
        """Take note of the actions."""
        self._actions = actions

    def step_wait(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, list[dict[str, Any]]]:
        """Fly."""
        seen, reward, over, cut_off, found = self._env.step(self._actions)
        told: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]
        for k in np.flatnonzero(over | cut_off):
            told[k] = {
                "terminal_observation": found["final_obs"][k],
                "TimeLimit.truncated": bool(cut_off[k]),
                "is_success": bool(found["is_success"][k]),
            }
        return seen, reward.astype(np.float32), over | cut_off, told

    def close(self) -> None:
        """End the threads."""
        self._env.close()

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        """Attribute of the environment, once for each flight."""
        return [getattr(self._env, attr_name)] * self.num_envs

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        """Set an attribute of the environment."""
        setattr(self._env, attr_name, value)

    def env_method(self, method_name: str, *args: Any, indices: Any = None, **named: Any) -> list[Any]:
        """Call a method of the environment."""
        return [getattr(self._env, method_name)(*args, **named)]

    def env_is_wrapped(self, wrapper_class: type, indices: Any = None) -> Sequence[bool]:
        """Whether the flights are wrapped, which they never are."""
        return [False] * self.num_envs


def done(model: PPO, task: str, cases: range) -> float:
    """Share of cases that the policy gets done."""
    env, count = FlightEnv(task), 0
    for case in cases:
        seen, _ = env.reset(options={"case": case})
        over = cut_off = False
        while not (over or cut_off):
            action, _ = model.predict(seen, deterministic=True)
            seen, _, over, cut_off, information = env.step(action)
        count += information["is_success"]
    return count / len(cases)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("task", nargs="?", default="PoweredDescent")
    parser.add_argument("--steps", type=int, default=300_000)
    parser.add_argument("--flights", type=int, default=16)
    parser.add_argument("--pool", type=int, default=64, help="cases to train on, from 0 on")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--episodes", type=int, default=50, help="cases after those, flown at the end")
    parser.add_argument("--out", default="")
    options = parser.parse_args()
    env = FlightVectorEnv(
        options.task, options.flights, options.pool, workers=options.workers, autoreset_mode="SameStep"
    )
    model = PPO(
        "MlpPolicy",
        VecMonitor(Many(env)),
        n_steps=1024,
        batch_size=1024,
        gamma=0.999,
        gae_lambda=0.98,
        seed=1,
        verbose=1,
        device="cpu",
    )
    model.learn(options.steps)
    if options.out:
        model.save(options.out)
    unseen = range(options.pool, options.pool + options.episodes)
    print(f"done: {100.0 * done(model, options.task, unseen):.1f} % of {options.episodes} unseen cases")
    env.close()


if __name__ == "__main__":
    main()
