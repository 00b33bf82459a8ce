"""One step of successive convexification: the landing linearised about a flight, as a conic program.

Virtual control lets the linearised motion be feasible, at a price of each unit of it; a trust region is a
price on the square of what changes.  All unknowns are in units of the problem's own size.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi, sin, tan
from typing import Any

import numpy as np
from scipy import sparse

from edl6dof.design.rigid_landing import POSITION, RATE, STATES, THRUST, TORQUE, RigidLanding
from edl6dof.design.transcription import Linear, Nodes

#: Price of a unit of virtual control, in masses at the start; mass out of nothing would save one.
PRICE = 10.0
#: Longest over shortest time of a part of the flight beside the first guess.
LONGEST = 4.0


@dataclass(frozen=True)
class Scales:
    """Units of states, shape (14,), controls, (4,), and durations, s."""

    x: np.ndarray
    u: np.ndarray
    time: float


def scales_of(landing: RigidLanding, time: float) -> Scales:
    """Units in which a landing of about ``time`` s is of the size of one."""
    distance = max(float(np.linalg.norm(landing.start[POSITION])), 1.0)
    speed = max(float(np.linalg.norm(landing.start[4:7])), distance / time)
    x = np.repeat([landing.start[0], distance, speed, 1.0, landing.rate], [1, 3, 3, 4, 3])
    return Scales(x, np.append(landing.thrust[1], landing.torque), time)


@dataclass(frozen=True)
class Step:
    """A flight, its promised cost, and the largest change, both in units of the problem."""

    nodes: Nodes
    promised: float
    change: float


def solve_step(landing: RigidLanding, nodes: Nodes, linear: Linear, trust: float) -> Step | None:
    """The flight of least cost near ``nodes``: fuel, virtual control, and ``trust`` times the mean square
    of what changes.

    Args:
        landing: the problem.
        nodes: the flight that ``linear`` belongs to.
        linear: its motion.
        trust: price of change.

    Returns:
        ``None`` where the solver finds none.
    """
    import cvxpy as cp  # the optional extra "design"

    n, scales = len(nodes.x) - 1, scales_of(landing, float(np.sum(nodes.durations)))
    old = (nodes.x / scales.x, nodes.u / scales.u, nodes.durations / scales.time)
    x, u, time = unknowns = [cp.Variable(part.shape) for part in old]
    # both signs of virtual control: each node is where the interval before it ends, but for it
    virtual = [cp.Variable((n, STATES), nonneg=True) for _ in range(2)]
    reached = _reached(nodes, linear, scales, unknowns)
    limits = [
        x[1:] == reached[-1] + virtual[0] - virtual[1],
        *_ends(landing, scales, x),
        *_bounds(landing, nodes, scales, u, time),
        *(limit for states in reached[:-1] for limit in _path_limits(landing, scales, states)),
        *_path_limits(landing, scales, reached[-1][:-1]),  # the last node is at rest
    ]
    torque = landing.torque_price * cp.sum_squares(u[:, TORQUE])
    change = trust * sum(cp.sum_squares(new - part) for new, part in zip(unknowns, old, strict=True))
    cost = PRICE * cp.sum(sum(virtual)) - x[n, 0] + torque / (n + 1)
    problem = cp.Problem(cp.Minimize(cost + change / (n + 1)), limits)
    problem.solve(cp.CLARABEL)
    if problem.status not in (cp.OPTIMAL, cp.OPTIMAL_INACCURATE):
        return None
    largest = max(float(np.abs(new.value - part).max()) for new, part in zip(unknowns, old, strict=True))
    found = Nodes(x.value * scales.x, u.value * scales.u, time.value * scales.time, nodes.full)
    return Step(found, float(cost.value), largest)


def _reached(nodes: Nodes, linear: Linear, scales: Scales, unknowns: list[Any]) -> list[Any]:
    """States at each checked point of all intervals, shape (n, 14), linear in the ``unknowns``."""
    import cvxpy as cp

    x, u, time = unknowns
    n, units = len(nodes.x) - 1, np.concatenate([scales.x, scales.u, scales.u, [scales.time]])
    begin = cp.hstack([x[:-1], u[:-1], u[1:], cp.reshape(time[nodes.parts], (n, 1), order="C")])
    at = np.column_stack([nodes.x[:-1], nodes.u[:-1], nodes.u[1:], nodes.durations[nodes.parts]])
    found = []
    for states, by in zip(linear.x, linear.by, strict=True):
        constant = (states - (by @ at[..., None])[..., 0]) / scales.x
        matrix = sparse.block_diag(by * units / scales.x[:, None], format="csr")
        found.append(cp.reshape(matrix @ cp.vec(begin, order="C"), (n, STATES), order="C") + constant)
    return found


def _ends(landing: RigidLanding, scales: Scales, x: Any) -> list[Any]:
    """From the given state to rest at the origin, upright, heading as at the start, without rates."""
    rest = [1, 2, 3, 4, 5, 6, 8, 9, 11, 12, 13]
    heading = landing.start[10] * x[-1, 7] == landing.start[7] * x[-1, 10]
    dry = x[-1, 0] >= landing.dry_mass / scales.x[0]
    return [x[0] == landing.start / scales.x, x[-1, rest] == 0.0, heading, dry]


def _bounds(landing: RigidLanding, nodes: Nodes, scales: Scales, u: Any, time: Any) -> list[Any]:
    """Bounds of thrust, torque and durations."""
    least = np.array([landing.full_time, landing.throttled_time][-len(nodes.durations) :])
    low = np.full(len(nodes.u), landing.thrust[0])
    low[: nodes.full] = landing.thrust[1]  # the full thrust flown there is given
    most = np.tile(landing.torque / scales.u[TORQUE], (len(nodes.u), 1))
    thrust = [u[:, THRUST] >= low / scales.u[0], u[:, THRUST] <= landing.thrust[1] / scales.u[0]]
    return [
        *thrust,
        u[:, TORQUE] <= most,
        u[:, TORQUE] >= -most,
        time >= least / scales.time,
        time <= LONGEST,
    ]


def _path_limits(landing: RigidLanding, scales: Scales, states: Any) -> list[Any]:
    """Tilt, rate and glide slope of states of shape (n, 14)."""
    import cvxpy as cp

    tilt, rate = sin(0.5 * landing.tilt), landing.rate / scales.x[RATE][0]
    found = [cp.norm(states[:, 8:10], axis=1) <= tilt, cp.norm(states[:, RATE], axis=1) <= rate]
    if landing.glide_slope > -pi / 2.0:
        found.append(tan(landing.glide_slope) * cp.norm(states[:, 1:3], axis=1) <= states[:, 3])
    return found
