"""Successive convexification: a sequence of conic programs, each about the solution of the previous one.

A flight is given by nodes: states and controls at the ends of intervals; controls are linear between nodes
(first-order hold).  The intervals of the start at full level have one length, those of the throttle band
another; both are free.  The motion is linearised about a flight, and a conic program finds the landing near
it of least cost.  Virtual control makes the linearised motion feasible, at a price per unit; a trust region
is a price on the square of changes.  All unknowns of a program are in units of the problem's own size.

The cost of changes increases while the changes do not decrease, and is reset where they stop, until a reset
brings no further gain.  If no landing within the limits exists, virtual control remains.

Source: Szmuk & Acikmese 2018, AIAA 2018-0617, algorithm 1; Szmuk, Reynolds, Acikmese 2020, "Successive
convexification for real-time six-degree-of-freedom powered descent guidance with state-triggered
constraints", J. Guidance 43(8), section III: the variational equations; the rule for the cost is this
project's own.
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from math import pi, sin, tan
from typing import Any

import numpy as np
from scipy import sparse
from scipy.integrate import solve_ivp

from edl6dof.design.rigid_landing import (
    CONTROLS,
    POSITION,
    RATE,
    STATES,
    THRUST,
    TORQUE,
    RigidLanding,
    derivatives,
    motion,
)

#: Intervals, and those of them at full level.
INTERVALS, FULL_INTERVALS = 30, 4
#: Largest number of conic programs.
PROGRAMS = 150
#: Price of change at first, and what it is multiplied by where a change is not less than the one before, and
#: where a step is refused, whose true motion misses the next node by more than the size of the problem.
FIRST_TRUST, FACTOR, REFUSED, WILD = 0.02, 1.5, 4.0, 1.0
#: Largest defect (units of the problem), and difference between the costs that two programs promise (masses
#: at the start), at which it has converged.
DEFECT, GAIN = 5e-7, 2e-6
#: Least gain of a round from the first price of change for another round, masses at the start.
AGAIN = 1e-4
#: Runge-Kutta steps of an interval.
STEPS = 8
#: Steps of an interval after which limits are checked; the last is its end.
CHECKED = (2, 4, 6, 8)


@dataclass(frozen=True)
class Nodes:
    """A flight, given by its nodes."""

    x: np.ndarray  # states, shape (n + 1, 14)
    #: controls, shape (n + 1, 4); the thrust of a node where two parts meet is that of the second
    u: np.ndarray
    durations: np.ndarray  # of the part at full level, if any, and of the part in the throttle band, s
    full: int  # intervals of the part at full level

    @property
    def parts(self) -> np.ndarray:
        """Index of the duration that each interval belongs to, shape (n,)."""
        return ((np.arange(len(self.x) - 1) >= self.full) & (self.full > 0)).astype(int)

    @property
    def shares(self) -> np.ndarray:
        """Length of each interval as a share of the duration of its part, shape (n,)."""
        return 1.0 / np.bincount(self.parts)[self.parts]

    @property
    def lengths(self) -> np.ndarray:
        """Lengths of the intervals, s, shape (n,)."""
        return self.durations[self.parts] * self.shares

    @property
    def times(self) -> np.ndarray:
        """Times of the nodes, s, shape (n + 1,)."""
        return np.append(0.0, np.cumsum(self.lengths))

    def ends(self, landing: RigidLanding) -> tuple[np.ndarray, np.ndarray]:
        """Controls at the beginning and at the end of each interval, each of shape (n, 4)."""
        first, last = self.u[:-1].copy(), self.u[1:].copy()
        first[: self.full, THRUST] = last[: self.full, THRUST] = landing.full_thrust
        return first, last


@dataclass(frozen=True)
class Linear:
    """States at the ``CHECKED`` points of each interval, the last at its end, and their derivatives."""

    x: np.ndarray  # shape (points, n, 14)
    #: shape (points, n, 14, 23): by the state at the beginning (14), the controls there (4) and at the
    #: end (4), and the duration of the part
    by: np.ndarray


def linearise(landing: RigidLanding, nodes: Nodes) -> Linear:
    """Integrate motion and variational equations over all intervals at once."""
    first, last = nodes.ends(landing)
    lengths = nodes.lengths[:, None, None]
    x, by = nodes.x[:-1], np.zeros((len(nodes.x) - 1, STATES, STATES + 2 * CONTROLS + 1))
    by[:, range(STATES), range(STATES)] = 1.0

    def slopes(at: float, x: np.ndarray, by: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        u = (1.0 - at) * first + at * last
        change = motion(landing, x, u)
        by_state, by_control = derivatives(landing, x, u)
        by_controls = ((1.0 - at) * by_control, at * by_control)
        own = np.concatenate([np.zeros_like(by_state), *by_controls, change[..., None] / lengths], -1)
        return lengths[:, 0] * change, lengths * (by_state @ by + own)

    found, h = [], 1.0 / STEPS
    for step in range(STEPS):
        at = step * h
        x1, by1 = slopes(at, x, by)
        x2, by2 = slopes(at + 0.5 * h, x + 0.5 * h * x1, by + 0.5 * h * by1)
        x3, by3 = slopes(at + 0.5 * h, x + 0.5 * h * x2, by + 0.5 * h * by2)
        x4, by4 = slopes(at + h, x + h * x3, by + h * by3)
        x = x + h / 6.0 * (x1 + 2.0 * x2 + 2.0 * x3 + x4)
        by = by + h / 6.0 * (by1 + 2.0 * by2 + 2.0 * by3 + by4)
        if step + 1 in CHECKED:
            found.append((x, by))
    states, slopes_at = (np.array(part) for part in zip(*found, strict=True))
    slopes_at[:, : nodes.full, :, [14, 18]] = 0.0  # full thrust is given
    slopes_at[..., 22] *= nodes.shares[:, None]
    return Linear(states, slopes_at)


def propagate(landing: RigidLanding, nodes: Nodes, samples: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Fly the controls from the start by scipy's DOP853: times (s), states and controls at ``samples`` points
    of each interval and at the end.
    """
    first, last = nodes.ends(landing)
    t, x, u = [], [], []
    state, began = landing.start, 0.0
    for k, length in enumerate(nodes.lengths):

        def control(at: float, k: int = k, length: float = float(length)) -> np.ndarray:
            return first[k] + at / length * (last[k] - first[k])

        def slopes(at: float, y: np.ndarray, control: Any = control) -> np.ndarray:
            return motion(landing, y, control(at))

        times = np.linspace(0.0, length, samples + 1)
        found = solve_ivp(slopes, (0.0, length), state, "DOP853", times, rtol=1e-10, atol=1e-10)
        t.append(began + found.t[:-1])
        x.append(found.y[:, :-1].T)
        u.append(np.array([control(at) for at in found.t[:-1]]))
        state, began = found.y[:, -1], began + length
    return np.append(np.concatenate(t), began), np.vstack([*x, state]), np.vstack([*u, last[-1]])


#: Price of a unit of virtual control, in masses at the start (a unit of virtual mass saves one).
PRICE = 10.0
#: Longest duration of a part of the flight over the time of the first guess.
LONGEST = 4.0


@dataclass(frozen=True)
class Scales:
    """Units of states, shape (14,), controls, (4,), and durations, s."""

    x: np.ndarray
    u: np.ndarray
    time: float


def scales_of(landing: RigidLanding, nodes: Nodes) -> Scales:
    """Units in which the numbers of a landing of about this duration are about one."""
    whole, distance = float(np.sum(nodes.durations)), max(float(np.linalg.norm(landing.start[POSITION])), 1.0)
    speed = max(float(np.linalg.norm(landing.start[4:7])), distance / whole)
    x = np.repeat([landing.start[0], distance, speed, 1.0, landing.rate], [1, 3, 3, 4, 3])
    return Scales(x, np.append(landing.thrust[1], landing.torque), whole)


@dataclass(frozen=True)
class Step:
    """A flight that a program found, its cost by the linear model, its largest change, in problem units."""

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
        the flight; ``None`` if the solver finds none.
    """
    import cvxpy as cp  # the optional extra "design"

    n, scales = len(nodes.x) - 1, scales_of(landing, nodes)
    old = (nodes.x / scales.x, nodes.u / scales.u, nodes.durations / scales.time)
    unknowns: list[Any] = [cp.Variable(part.shape) for part in old]
    x, u, time = unknowns
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
    solved_x, solved_u, solved_time = (np.asarray(one.value) for one in (x, u, time))
    found = Nodes(solved_x * scales.x, solved_u * scales.u, solved_time * scales.time, nodes.full)
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
    """Constrain both ends: the given state; rest at the origin, upright, with the initial heading."""
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


@dataclass(frozen=True)
class Converged:
    """Result of successive convexification: the trajectory of the last iteration, and how it was found."""

    nodes: Nodes  # trajectory of the last iteration
    fuel: float  # kg
    #: largest difference between the end of an interval and the node there, in units of the problem
    defect: float
    programs: int  # convex programs solved
    seconds: float  # time of computing
    landed: bool  # True if the trajectory has no defect and no better one is near it


def land(landing: RigidLanding, intervals: int = INTERVALS) -> Converged:
    """Find the landing of least fuel."""
    began = time.perf_counter()
    nodes = first_guess(landing, intervals)
    linear, trust, settled, programs = linearise(landing, nodes), FIRST_TRUST, False, 0
    promised, change, best, landed = np.inf, np.inf, np.inf, None
    while programs < PROGRAMS and not settled:
        programs += 1
        step = solve_step(landing, nodes, linear, trust)
        tried = None if step is None else linearise(landing, step.nodes)
        if step is None or tried is None or not _defect(landing, step.nodes, tried) < WILD:
            trust *= REFUSED
            continue
        gain, larger = abs(promised - step.promised), step.change >= change
        nodes, promised, change, linear = step.nodes, step.promised, step.change, tried
        if larger:
            trust *= FACTOR
        if gain < GAIN and _defect(landing, nodes, linear) < DEFECT:
            # a price of change that has grown may keep the flight from a better one
            settled = promised > best - AGAIN
            if promised < best:
                best, landed = promised, (nodes, linear)
            trust, change = FIRST_TRUST, np.inf
    nodes, linear = landed or (nodes, linear)
    return Converged(
        nodes=nodes,
        fuel=float(landing.start[0] - nodes.x[-1, 0]),
        defect=_defect(landing, nodes, linear),
        programs=programs,
        seconds=time.perf_counter() - began,
        landed=landed is not None,
    )


def first_guess(landing: RigidLanding, intervals: int) -> Nodes:
    """A straight line to the landing point in the time of a constant deceleration, upright, thrust against
    gravity; the part at full thrust takes its shortest time.
    """
    height, descent = landing.start[3], max(-landing.start[6], 10.0)
    whole = max(2.0 * height / descent, 2.0 * (landing.full_time + landing.throttled_time))
    full = FULL_INTERVALS if landing.starts_full else 0
    durations = np.array([landing.full_time, whole - landing.full_time] if full else [whole])
    nodes = Nodes(np.empty((intervals + 1, 14)), np.zeros((intervals + 1, 4)), durations, full)
    share = (nodes.times / whole)[:, None]
    upright = np.array([landing.start[7], 0.0, 0.0, landing.start[10]])
    end = np.concatenate([[landing.start[0]], np.zeros(6), upright / np.linalg.norm(upright), np.zeros(3)])
    nodes.x[:] = (1.0 - share) * landing.start + share * end
    weight = landing.start[0] * landing.gravity
    nodes.u[:, 0] = np.clip(weight, *landing.thrust)
    nodes.u[:full, 0] = landing.thrust[1]
    return nodes


def _defect(landing: RigidLanding, nodes: Nodes, linear: Linear) -> float:
    """Largest difference between the flown end of an interval and the next node, in units of the problem."""
    return float(np.max(np.abs(linear.x[-1] - nodes.x[1:]) / scales_of(landing, nodes).x))
