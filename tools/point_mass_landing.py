"""The fuel-optimal pinpoint landing of a point mass, which tests and tools hold convex guidance and the rigid
landing against: as a conic program, solved by the interior-point method of Clarabel, and by the kernels of
the flight computer.

Axes: east, north, up, from the landing point.  Unknowns of the program are the thrust acceleration u, its
bound s >= |u|, and through them z = ln m: lossless convexification, with the bounds of thrust over mass as
Taylor series of exp(-z) about the mass of the solution before.  Sources: Acikmese & Ploen 2007, "Convex
programming approach to powered descent guidance for Mars landing", J. Guidance 30(5), problem 3; Acikmese,
Carson, Blackmore 2013, "Lossless convexification of nonconvex control bound and pointing constraints of the
soft landing optimal control problem", IEEE Trans. Control Systems Technology 21(6).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import cos, inf, pi, radians, sqrt, tan
from typing import Any

import numpy as np
from scipy import sparse
from scipy.optimize import minimize_scalar

from edl6dof.config.units import G0
from edl6dof.fsw.guidance.powered.convex import pipg
from edl6dof.fsw.guidance.powered.convex.flight_time import search_times
from edl6dof.fsw.guidance.powered.convex.landing_plan import LANDING, PLAN

#: Solutions of one problem, each about the mass of the one before.
EXPANSIONS = 4


@dataclass(frozen=True)
class Landing:
    """A powered landing to rest at the origin.

    Attributes:
        mass: at the start, kg.
        thrust: least and largest thrust along the path, N.
        exhaust_speed: thrust over mass flow, m/s.
        gravity: downwards, m/s2.
        position, velocity: at the start, (east, north, up), m and m/s.
        glide_slope: least angle of the line from the landing point to the vehicle over the horizon, rad; 0:
            never below the landing point; -pi / 2: none.
        tilt: largest angle of thrust from the vertical, rad, at most pi / 2; pi: none.
        end_tilt: that of the last control, rad.
        full_thrust: of the start, N.
        full_time: how long the thrust is ``full_thrust`` before its bounds hold, s.
    """

    mass: float
    thrust: tuple[float, float]
    exhaust_speed: float
    gravity: float
    position: tuple[float, float, float]
    velocity: tuple[float, float, float]
    glide_slope: float = -pi / 2.0
    tilt: float = pi
    end_tilt: float = pi
    full_thrust: float = 0.0
    full_time: float = 0.0


def classic_mars(glide_slope_deg: float | None = None) -> Landing:
    """The example of Acikmese & Ploen 2007: six engines of 3.1 kN, canted by 27 deg, at 30 to 80 %."""
    full = 6.0 * 3100.0 * cos(radians(27.0))
    return Landing(
        mass=1905.0,
        thrust=(0.3 * full, 0.8 * full),
        exhaust_speed=225.0 * G0 * cos(radians(27.0)),
        gravity=3.7114,
        position=(2000.0, 0.0, 1500.0),
        velocity=(100.0, 0.0, -75.0),
        glide_slope=-pi / 2.0 if glide_slope_deg is None else radians(glide_slope_deg),
    )


@dataclass(frozen=True)
class Grid:
    """Times, and what each thrust acceleration of a control adds to velocity and position at them.

    Attributes:
        times: shape (n + 1,), from 0 to the time of flight, s.
        velocity: shape (n + 1, m): velocity at each time for 1 m/s2 of each control, s.
        position: shape (n + 1, m): position likewise, s2.
        spent: shape (m, m): integral of each control up to where the thrust bounds of each control hold, s.
        at: shape (m,): that time, s.
    """

    times: np.ndarray
    velocity: np.ndarray
    position: np.ndarray
    spent: np.ndarray
    at: np.ndarray


def held_controls(time: float, count: int, full_time: float = 0.0) -> Grid:
    """A grid of ``count`` controls, each held constant; the first share of them, if any, fills ``full_time``.

    The bounds of a held control are those of the mass in its middle.
    """
    first = full_intervals(time, count, full_time)
    edges = np.concatenate(
        [np.linspace(0.0, full_time, first + 1)[:-1], np.linspace(full_time, time, count - first + 1)]
        if first
        else [np.linspace(0.0, time, count + 1)]
    )
    steps, middles = np.diff(edges), 0.5 * (edges[1:] + edges[:-1])
    before = np.tri(count + 1, count, -1)
    velocity = before * steps
    position = velocity * (edges[:, None] - middles)
    return Grid(edges, velocity, position, np.tri(count, count, -1) * steps + np.diag(0.5 * steps), middles)


def full_intervals(time: float, count: int, full_time: float) -> int:
    """How many of ``count`` controls fill the start at full thrust."""
    if full_time <= 0.0:
        return 0
    return int(np.clip(round(count * full_time / time), 1, count - 2))


def interpolated_controls(time: float, count: int) -> Grid:
    """A grid of ``count`` controls, thrust acceleration linear between them (first-order hold)."""
    times = np.linspace(0.0, time, count)
    step = times[1]
    velocity, position = np.zeros((count, count)), np.zeros((count, count))
    for i in range(1, count):
        velocity[i] = velocity[i - 1]
        position[i] = position[i - 1] + step * velocity[i - 1]
        velocity[i, i - 1 : i + 1] += 0.5 * step
        position[i, i - 1] += step * step / 3.0
        position[i, i] += step * step / 6.0
    return Grid(times, velocity, position, velocity, times)


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


def landing_record(landing: Landing, miss_price: float = 1.0) -> np.ndarray:
    """The ``LANDING`` record of a landing, shape (1,); ``miss_price`` 1/s: velocity worth a metre of miss."""
    record = np.zeros(1, LANDING)
    own = record[0]
    own["mass"], own["exhaust_speed"], own["gravity"] = landing.mass, landing.exhaust_speed, landing.gravity
    own["low"], own["high"], own["full"] = *landing.thrust, landing.full_thrust
    own["position"], own["velocity"] = landing.position, landing.velocity
    own["slope"] = tan(landing.glide_slope) if landing.glide_slope > -pi / 2.0 else -1.0
    own["cos_tilt"] = cos(landing.tilt)
    own["cos_last_tilt"] = cos(min(landing.tilt, landing.end_tilt))
    own["miss_price"] = miss_price
    return record


def first_guess(landing: Landing, time: float) -> np.ndarray:
    """A ``PLAN`` record, shape (1,), that holds against gravity for ``time`` s."""
    record = np.zeros(1, PLAN)
    plan = record[0]
    plan["time"], plan["full_time"] = time, landing.full_time
    plan["u"][:, 2], plan["primer_end"][2] = landing.gravity, -1.0
    return record


def solve_onboard(landing: Landing, time: float, most: int = 3000, miss_price: float = 1.0) -> np.ndarray:
    """The ``PLAN`` record, shape (1,), of a landing of given time."""
    plan = first_guess(landing, time)
    pipg.solve(landing_record(landing, miss_price)[0], most, plan[0])
    return plan


def plan_onboard(landing: Landing, throttled: float, guess: float, most: int = 300) -> np.ndarray:
    """The ``PLAN`` record, shape (1,), of a landing of free time: at least ``throttled`` s in the throttle
    band; ``guess`` s: the first time of flight to look at.
    """
    plan, other = first_guess(landing, guess), np.zeros(1, PLAN)
    search_times(landing_record(landing)[0], throttled, most, plan[0], other[0])
    return plan
