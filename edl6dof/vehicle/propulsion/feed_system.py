"""Feed system: tanks, and the propellant that engines and thrusters draw from them.

An engine or thruster draws on the tanks that it names, on all where it names none.  Tanks drawn on together
give in proportion to their loads, as on one manifold at one pressure: they run empty together.  An empty tank
is shut off, and the others give all; an engine or thruster with empty tanks only gives no thrust.  A tank is
a piece of the lander: no separation takes its propellant away.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from edl6dof.interface.capacities import MAX_ENGINES, MAX_TANKS, MAX_THRUSTERS
from edl6dof.kernels import inlined_kernel, kernel
from edl6dof.records import record
from edl6dof.vehicle.mass import Tank, body_of, join
from edl6dof.vehicle.plant import PROPELLANT

#: Loads (kg) of the tanks that feed each engine or thruster, a row each; 0 for a tank that does not.
FEEDS = record(("engines", "f8", (MAX_ENGINES, MAX_TANKS)), ("thrusters", "f8", (MAX_THRUSTERS, MAX_TANKS)))


def fill_feeds(rows: np.ndarray, drawing: Iterable[Sequence[str]], tanks: Sequence[Tank]) -> None:
    """Fill the ``rows`` of ``FEEDS``; ``drawing``: for each engine or thruster, the names of the tanks that
    it draws from, or none for all tanks.
    """
    for row, names in zip(rows, drawing, strict=False):
        row[: len(tanks)] = [tank.mass_kg if tank.name in names or not names else 0.0 for tank in tanks]


@kernel
def load_within_reach(loads, row, filled):
    """Load (kg) of the tanks that feed ``row`` and are not empty; 0: no propellant."""
    total = 0.0
    for k in range(MAX_TANKS):
        if filled[k] != 0:
            total += loads[row, k]
    return total


@kernel
def draw(feed, flow, taken, first):
    """Add each tank's share of a ``flow`` (kg/s) to ``taken[first:]``; ``feed``: loads (kg), row of the
    engine or thruster in them, filled tanks, and load within reach.
    """
    loads, row, filled, within = feed
    for k in range(MAX_TANKS):
        if filled[k] != 0:
            taken[first + k] += flow * (loads[row, k] / within)


@inlined_kernel
def with_propellant(dry, tanks, count, y):
    """Mass properties of the ``dry`` vehicle with the propellant of the state ``y`` in its ``count``
    ``tanks``.
    """
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
