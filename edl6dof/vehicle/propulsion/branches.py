"""Propellant branches: thrusters behind one latch valve, which shuts them all."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import Protocol

import numpy as np

from edl6dof.config.base import REQUIRED, Hardware, Key, param


class Jet(Protocol):
    """What a branch needs to know of a thruster."""

    @property
    def name(self) -> str:
        """Its name."""

    @property
    def full_flow_kg_s(self) -> float:
        """What it uses while it fires, kg/s."""


class Branch(Hardware):
    """One propellant branch."""

    name: Key = param(REQUIRED, "name, unique in the vehicle", record=False)
    thrusters: list[Key] = param(REQUIRED, "thrusters behind its latch valve", record=False, min_length=1)


def branch_problems(branches: Sequence[Branch], thrusters: Sequence[str]) -> dict[str, str]:
    """What is wrong with the branches of a vehicle with ``thrusters``, by dotted key: each thruster must lie
    on one of them, unless there are none.
    """
    given = Counter(name for branch in branches for name in branch.thrusters)
    problems = {
        f"branches.{k}.thrusters.{j}": f"no thruster named {name!r}; names: {', '.join(thrusters) or 'none'}"
        for k, branch in enumerate(branches)
        for j, name in enumerate(branch.thrusters)
        if name not in thrusters
    }
    twice = [name for name in thrusters if given[name] > 1]
    missing = [name for name in thrusters if given[name] == 0]
    words = [f"{', '.join(twice)} on more than one"] if twice else []
    words += [f"{', '.join(missing)} on none"] if missing and branches else []
    if words:
        problems["branches"] = f"every thruster must be on one branch (got {'; '.join(words)})"
    return problems


def fill_branches(record: np.void, branches: Sequence[Branch], thrusters: Sequence[Jet]) -> None:
    """Fill a ``BRANCHES`` record of zeros; each thruster lies on one of the ``branches``."""
    record["count"] = len(branches)
    for i, jet in enumerate(thrusters):
        own = next(k for k, branch in enumerate(branches) if jet.name in branch.thrusters)
        record["of"][i] = own
        record["full_flow"][own] += jet.full_flow_kg_s
