"""Feed system: tanks, and the propellant branches of thrusters, each behind one latch valve that shuts them
all.

An engine or thruster draws on the tanks that it names, on all where it names none.  Tanks drawn on together
give in proportion to their loads, as on one manifold at one pressure: they run empty together.  An empty tank
is shut off, and the others give all; an engine or thruster with empty tanks only gives no thrust.  A tank is
a piece of the lander: no separation takes its propellant away.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from typing import Protocol

import numpy as np

from edl6dof.config.base import REQUIRED, Hardware, Key, param
from edl6dof.interface.capacities import MAX_ENGINES, MAX_TANKS, MAX_THRUSTERS
from edl6dof.kernels import inlined_kernel, kernel
from edl6dof.vehicle.mass import Tank, body_of, join
from edl6dof.vehicle.plant import PROPELLANT


class Jet(Protocol):
    """Properties of a thruster that a branch needs."""

    @property
    def name(self) -> str:
        """Its name."""

    @property
    def full_flow_kg_s(self) -> float:
        """Propellant flow while it fires, kg/s."""


class Branch(Hardware):
    """One propellant branch."""

    name: Key = param(REQUIRED, "name, unique in the vehicle", record=False)
    thrusters: list[Key] = param(REQUIRED, "thrusters behind its latch valve", record=False, min_length=1)


def branch_problems(branches: Sequence[Branch], thrusters: Sequence[str]) -> dict[str, str]:
    """Find problems of the branches of a vehicle with ``thrusters``, by dotted key: each thruster must lie on
    one branch, unless there are no branches.
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


#: Load (kg) of each tank that feeds an engine or thruster, in rows; 0 for one that does not.
FEEDS = np.dtype(
    [("engines", "f8", (MAX_ENGINES, MAX_TANKS)), ("thrusters", "f8", (MAX_THRUSTERS, MAX_TANKS))], align=True
)


def fill_feeds(rows: np.ndarray, drawing: Iterable[Sequence[str]], tanks: Sequence[Tank]) -> None:
    """Fill the ``rows`` of ``FEEDS`` of those whose names of tanks are ``drawing``."""
    for row, names in zip(rows, drawing, strict=False):
        row[: len(tanks)] = [tank.mass_kg if tank.name in names or not names else 0.0 for tank in tanks]


@kernel
def load_within_reach(loads, row, filled):
    """Load (kg) of the tanks that feed ``row`` and are not empty; 0: it starves."""
    total = 0.0
    for k in range(MAX_TANKS):
        if filled[k] != 0:
            total += loads[row, k]
    return total


@kernel
def draw(loads, row, filled, within, flow, taken, first):
    """Add what each tank gives of a ``flow`` (kg/s) to ``taken[first:]``, for ``row`` with ``within`` kg of
    load in reach.
    """
    for k in range(MAX_TANKS):
        if filled[k] != 0:
            taken[first + k] += flow * (loads[row, k] / within)


@inlined_kernel
def with_propellant(dry, tanks, count, y):
    """Mass properties of ``dry`` with what the state ``y`` has left in each of its ``count`` ``tanks``."""
    body = body_of(dry)
    for k in range(count):
        left = y[PROPELLANT + k]
        if left > 0.0:
            share = left / tanks[k].mass
            c, i = tanks[k].centre, tanks[k].inertia
            inertia = (i[0] * share, i[1] * share, i[2] * share, 0.0, 0.0, 0.0)
            body = join(body, (left, (c[0], c[1], c[2]), inertia))
    return body


@kernel
def propellant_left(count, y):
    """Propellant (kg) in all ``count`` tanks."""
    total = 0.0
    for k in range(count):
        total += y[PROPELLANT + k]
    return total
