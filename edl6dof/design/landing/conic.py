"""The convex landing of fixed time as a conic program, solved by the interior-point method of Clarabel.

Unknowns are the thrust acceleration u, its bound s >= |u|, and through them z = ln m: lossless
convexification, with the bounds of thrust over mass as Taylor series of exp(-z) about the mass of the
solution before.  Source: Acikmese & Ploen 2007, problem 3.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import cos, inf, pi, sqrt, tan
from typing import Any

import numpy as np
from scipy import sparse
from scipy.optimize import minimize_scalar

from edl6dof.design.landing.problem import Grid, Landing

#: Solutions of one problem, each about the mass of the one before.
EXPANSIONS = 4


@dataclass(frozen=True)
class Solution:
    """An optimal landing.

    Attributes:
        time: of flight, s.
        fuel: kg.
        miss: horizontal distance from the landing point at the end, m.
        times: shape (n + 1,), s.
        position, velocity: shape (n + 1, 3), east, north, up.
        acceleration: of the thrust, shape (m, 3), m/s2.
        bound: s, shape (m,), m/s2.
        mass: at the controls, shape (m,), kg.
    """

    time: float
    fuel: float
    miss: float
    times: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    bound: np.ndarray
    mass: np.ndarray


def solve(landing: Landing, grid: Grid, *, miss_weight: float = inf) -> Solution | None:
    """Least fuel of a landing in the time of the grid; ``None`` where there is none.

    Args:
        landing: the problem.
        grid: its controls.
        miss_weight: worth of a metre of horizontal miss, kg of fuel over the mass at the start; infinite: no
            miss is allowed.
    """
    lightest = landing.mass - landing.thrust[1] / landing.exhaust_speed * grid.at
    reference = np.log(np.maximum(lightest, 0.3 * landing.mass))
    found = None
    for _ in range(EXPANSIONS):
        answer = _solve_about(landing, grid, reference, miss_weight)
        if answer is None:
            return found
        found = answer
        if np.max(np.abs(np.log(found.mass) - reference)) < 1e-6:
            break
        reference = np.log(found.mass)
    return found


def best_time(
    landing: Landing, controls: Callable[[float], Grid], low: float, high: float
) -> Solution | None:
    """The solution of the time of flight, from ``low`` to ``high`` s, that takes least fuel (golden section);
    ``controls(time)`` makes the grid.
    """

    def fuel(time: float) -> float:
        found = solve(landing, controls(time))
        return found.fuel if found else 2.0 * landing.mass + abs(time - high)

    best = minimize_scalar(fuel, bounds=(low, high), method="bounded", options={"xatol": 0.02})
    return solve(landing, controls(float(best.x)))


def _solve_about(landing: Landing, grid: Grid, reference: np.ndarray, miss_weight: float) -> Solution | None:
    """The problem whose bounds are series about the logarithm of mass ``reference``, shape (m,)."""
    m = len(reference)
    program = _Program(4 * m + 1)
    _end(program, landing, grid, miss_weight)
    _thrust(program, landing, grid, reference)
    _path(program, landing, grid)
    cost = np.zeros(program.unknowns)
    cost[3 * m : 4 * m] = grid.velocity[-1]
    cost[4 * m] = miss_weight * landing.exhaust_speed if miss_weight < inf else 0.0
    x = program.minimise(cost)
    return None if x is None else _motion(landing, grid, x)


class _Program:
    """A conic program, gathered: ``rows x + constant`` in cones, shapes (n, unknowns) and (n,)."""

    def __init__(self, unknowns: int) -> None:
        import clarabel  # the optional extra "design"

        self.unknowns = unknowns
        self._clarabel = clarabel
        self._parts: list[tuple[np.ndarray, np.ndarray, Any]] = []

    def zero(self, rows: np.ndarray, constant: np.ndarray) -> None:
        """Rows that are zero."""
        self._parts.append((rows, constant, self._clarabel.ZeroConeT(len(constant))))

    def positive(self, rows: np.ndarray, constant: np.ndarray) -> None:
        """Rows that are not negative."""
        self._parts.append((rows, constant, self._clarabel.NonnegativeConeT(len(constant))))

    def within(self, rows: np.ndarray, constant: np.ndarray) -> None:
        """Rows of which the first is not less than the length of the others."""
        self._parts.append((rows, constant, self._clarabel.SecondOrderConeT(len(constant))))

    def minimise(self, cost: np.ndarray) -> np.ndarray | None:
        """The unknowns of least ``cost``; ``None`` where the rows cannot all be in their cones."""
        settings = self._clarabel.DefaultSettings()
        settings.verbose = False
        rows = np.vstack([rows for rows, _, _ in self._parts])
        right = np.concatenate([constant for _, constant, _ in self._parts])
        quadratic = sparse.csc_matrix((self.unknowns, self.unknowns))
        cones = [cone for _, _, cone in self._parts]
        solver = self._clarabel.DefaultSolver(
            quadratic, cost, sparse.csc_matrix(-rows), right, cones, settings
        )
        answer = solver.solve()
        return np.array(answer.x) if str(answer.status) in ("Solved", "AlmostSolved") else None


def _end(program: _Program, landing: Landing, grid: Grid, miss_weight: float) -> None:
    """At rest at the landing point, or as near to it as ``miss_weight`` makes it worth."""
    fall_velocity, fall_position = _without_thrust(landing, grid)
    program.zero(_by_axis(grid.velocity[-1], program.unknowns), fall_velocity[-1])
    rows = _by_axis(grid.position[-1], program.unknowns)
    if miss_weight == inf:
        program.zero(rows, fall_position[-1])
        return
    program.zero(rows[2:], fall_position[-1, 2:])
    miss = np.zeros((1, program.unknowns))
    miss[0, -1] = 1.0
    program.within(np.vstack([miss, rows[:2]]), np.append(0.0, fall_position[-1, :2]))


def _thrust(program: _Program, landing: Landing, grid: Grid, reference: np.ndarray) -> None:
    """Direction and size of the thrust at each control."""
    m = len(reference)
    start = np.log(landing.mass)
    for j in range(m):
        u = np.zeros((3, program.unknowns))
        u[range(3), range(j, 3 * m, m)] = 1.0
        s, spent = np.zeros((2, program.unknowns))
        s[3 * m + j] = 1.0
        program.within(np.vstack([s, u]), np.zeros(4))
        tilt = landing.tilt if j < m - 1 else min(landing.tilt, landing.end_tilt)
        if tilt < pi:
            program.positive((u[2] - cos(tilt) * s)[None], np.zeros(1))
        # d = z - reference = constant - rows x
        spent[3 * m :] = np.append(grid.spent[j], 0.0) / landing.exhaust_speed
        d = start - reference[j]
        if grid.at[j] < landing.full_time:
            level = landing.full_thrust * np.exp(-reference[j])
            program.zero((s / level - spent)[None], np.array([d - 1.0]))
            continue
        low, high = (thrust * np.exp(-reference[j]) for thrust in landing.thrust)
        program.positive((-s / high + spent)[None], np.array([1.0 - d]))
        # y = s / low - 1 + d >= d^2 / 2
        rows = np.vstack([s / low - spent, -sqrt(2.0) * spent, s / low - spent])
        program.within(rows, np.array([d, sqrt(2.0) * d, d - 2.0]))


def _path(program: _Program, landing: Landing, grid: Grid) -> None:
    """Above the glide slope."""
    if landing.glide_slope <= -pi / 2.0:
        return
    _, fall = _without_thrust(landing, grid)
    slope = tan(landing.glide_slope)
    for i in range(1, len(grid.times) - 1):
        rows = _by_axis(grid.position[i], program.unknowns)
        scale = np.array([1.0, slope, slope])
        program.within(scale[:, None] * rows[[2, 0, 1]], scale * fall[i, [2, 0, 1]])


def _by_axis(weights: np.ndarray, unknowns: int) -> np.ndarray:
    """Rows that sum the acceleration of each axis with ``weights``: shape (3, unknowns)."""
    m = len(weights)
    rows = np.zeros((3, unknowns))
    for axis in range(3):
        rows[axis, axis * m : (axis + 1) * m] = weights
    return rows


def _without_thrust(landing: Landing, grid: Grid) -> tuple[np.ndarray, np.ndarray]:
    """Velocity and position at the times without thrust, shape (n + 1, 3)."""
    t, down = grid.times[:, None], np.array([0.0, 0.0, -landing.gravity])
    start, velocity = np.array(landing.position), np.array(landing.velocity)
    return velocity + t * down, start + t * velocity + 0.5 * t * t * down


def _motion(landing: Landing, grid: Grid, x: np.ndarray) -> Solution:
    """The landing that the unknowns describe."""
    m = len(grid.at)
    acceleration, bound = x[: 3 * m].reshape(3, m).T, x[3 * m : 4 * m]
    velocity, position = _without_thrust(landing, grid)
    velocity = velocity + grid.velocity @ acceleration
    position = position + grid.position @ acceleration
    fuel = landing.mass * -np.expm1(-grid.velocity[-1] @ bound / landing.exhaust_speed)
    return Solution(
        time=float(grid.times[-1]),
        fuel=float(fuel),
        miss=float(np.hypot(*position[-1, :2])),
        times=grid.times,
        position=position,
        velocity=velocity,
        acceleration=acceleration,
        bound=bound,
        mass=landing.mass * np.exp(-grid.spent @ bound / landing.exhaust_speed),
    )
