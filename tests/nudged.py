"""Initial states moved by a little: what a test asserts must not hang on the last bits of a flight."""

from __future__ import annotations

from functools import wraps

import numpy as np

from edl6dof.sim import flight_state
from edl6dof.vehicle.plant import ATTITUDE, POSITION, RATE, VELOCITY

#: How far the flights of this process begin beside their initial states.
nudged_by = 0.0


def nudge_initial_states(by: float) -> None:
    """From here on, let every flight begin a little beside its initial state.

    Args:
        by: share of position and velocity; angle (rad) and rate (rad/s) about each body axis.
    """
    global nudged_by
    nudged_by, exact = by, flight_state.beginning

    @wraps(exact)
    def beginning(loaded, *given, **named):
        moment, turns = exact(loaded, *given, **named), loaded.truth.dynamics != "point_mass"
        nudge(moment.plant["y"][0], by, turns)
        return moment

    flight_state.beginning = beginning


def nudge(y: np.ndarray, by: float, turns: bool) -> None:
    """Move a state in place; ``turns``: attitude and body rate too."""
    y[POSITION : VELOCITY + 3] *= 1.0 + by
    if not turns:
        return
    w, v = y[ATTITUDE], y[ATTITUDE + 1 : ATTITUDE + 4].copy()
    turn = np.full(3, 0.5 * by)
    q = np.array([w - v @ turn, *(v + w * turn + np.cross(v, turn))])
    y[ATTITUDE : ATTITUDE + 4] = q / np.sqrt(q @ q)
    y[RATE : RATE + 3] += by
