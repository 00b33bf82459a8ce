"""How the flight software itself does in the learning environments, as a policy: what it would command, given
as the action.

    python tools/baseline_score.py [TASK ...] [--episodes 100] [--flights 8]

Printed are the share of episodes that are done with its interval at 95 %, and the mean return.
"""

from __future__ import annotations

import argparse

import numpy as np

from edl6dof.campaign.statistics import Proportion
from edl6dof.gym import TASKS
from edl6dof.gym.episodes import Episodes


def score(task: str, episodes: int, flights: int, workers: int) -> None:
    """Fly episodes, each of a dispersed flight of its own, and print the score."""
    flown = Episodes(TASKS[task], flights, workers, episodes)
    begun = 0
    done, returns, flying = [], [], np.zeros(flights)
    free = np.ones(flights, bool)
    while len(done) < episodes:
        for index in np.flatnonzero(free)[: episodes - begun]:
            flown.begin_with(int(index), begun)
            begun, flying[index], free[index] = begun + 1, 0.0, False
        _, reward, over, cut_off, success = flown.step(flown.task.baseline())
        flying += reward
        for index in np.flatnonzero((over | cut_off) & ~free):
            done.append(bool(success[index]))
            returns.append(flying[index])
            free[index] = True
    share = Proportion(sum(done), episodes)
    print(f"{task:<16}{share!s:<32}return {np.mean(returns):6.2f}")
    flown.fleet.close()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("tasks", nargs="*", metavar="TASK")
    parser.add_argument("--episodes", type=int, default=100)
    parser.add_argument("--flights", type=int, default=8)
    parser.add_argument("--workers", type=int, default=1)
    options = parser.parse_args()
    for task in options.tasks or TASKS:
        score(task, options.episodes, options.flights, options.workers)


if __name__ == "__main__":
    main()
