"""One step of successive convexification: the landing linearised about a flight, as a conic program.

Virtual control lets the linearised motion be feasible, at a price of each unit of it; a trust region is a
price on the square of what changes.  All unknowns are in units of the problem's own size.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from math import pi, sin, tan
from typing import Any

import numpy as np
from scipy import sparse

from edl6dof.design.rigid_landing import CONTROLS, STATES, RigidLanding
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
    distance = max(float(np.linalg.norm(landing.start[1:4])), 1.0)
    speed = max(float(np.linalg.norm(landing.start[4:7])), distance / time)
    x = np.concatenate(
        [[landing.start[0]], np.full(3, distance), np.full(3, speed), np.ones(4), np.full(3, landing.rate)]
    )
    return Scales(x, np.append(landing.thrust[1], landing.torque), time)


@dataclass(frozen=True)
class Step:
    """A flight, the cost that the linearised problem promises of it, and the largest change, both in units of
    the problem.
    """

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
    program = _Sparse(landing, nodes)
    _start_and_end(program, landing)
    _motion(program, linear)
    _bounds(program, landing)
    _limits(program, landing, linear)
    return program.solve(trust, landing.torque_price)


class _Sparse:
    """A conic program in the unknowns x, u, durations, and both signs of virtual control."""

    def __init__(self, landing: RigidLanding, nodes: Nodes) -> None:
        self.nodes = nodes
        self.scales = scales_of(landing, float(np.sum(nodes.durations)))
        self.n = len(nodes.x) - 1
        self.at_u = STATES * (self.n + 1)
        self.at_time = self.at_u + CONTROLS * (self.n + 1)
        self.at_virtual = self.at_time + len(nodes.durations)
        self.unknowns = self.at_virtual + 2 * STATES * self.n
        self._rows: dict[str, list[tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]]] = {}
        self._cones: list[tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]] = []

    def x(self, node: int | np.ndarray, component: int | np.ndarray) -> np.ndarray:
        """Indices of states."""
        return np.asarray(STATES * np.asarray(node) + component)

    def u(self, node: int | np.ndarray, component: int | np.ndarray) -> np.ndarray:
        """Indices of controls."""
        return np.asarray(self.at_u + CONTROLS * np.asarray(node) + component)

    def add(self, cone: str, columns: np.ndarray, values: np.ndarray, constant: np.ndarray) -> None:
        """Rows ``sum(values * unknowns[columns]) + constant``, shapes (m, j), (m, j), (m,), in a cone:
        ``zero``, ``positive``, or one second-order cone of all of them.
        """
        rows = np.repeat(np.arange(len(constant)), np.shape(columns)[1])
        part = (rows, np.ravel(columns), np.ravel(values), np.asarray(constant, float))
        (self._cones if cone == "second_order" else self._rows.setdefault(cone, [])).append(part)

    def solve(self, trust: float, torque_price: float) -> Step | None:
        """The step that costs least."""
        import clarabel  # the optional extra "design"

        parts = [*self._rows["zero"], *self._rows["positive"], *self._cones]
        sizes = [len(part[3]) for part in parts]
        offsets = np.append(0, np.cumsum(sizes))
        rows = np.concatenate([part[0] + at for part, at in zip(parts, offsets, strict=False)])
        columns, values = (np.concatenate([part[i] for part in parts]) for i in (1, 2))
        matrix = sparse.csc_matrix((-values, (rows, columns)), shape=(offsets[-1], self.unknowns))
        zeros, positive = (sum(len(part[3]) for part in self._rows[name]) for name in ("zero", "positive"))
        cones: list[Any] = [clarabel.ZeroConeT(zeros), clarabel.NonnegativeConeT(positive)]
        cones += [clarabel.SecondOrderConeT(len(part[3])) for part in self._cones]
        old = self._packed(self.nodes)
        weight = np.zeros(self.unknowns)
        weight[: self.at_virtual] = 2.0 * trust / (self.n + 1)
        priced = np.zeros(self.unknowns)
        torques = self.u(np.arange(self.n + 1)[:, None], np.arange(1, CONTROLS))
        priced[torques] = 2.0 * torque_price / (self.n + 1)
        cost = np.zeros(self.unknowns)
        cost[self.at_virtual :] = PRICE
        cost[self.x(self.n, 0)] = -1.0
        settings = clarabel.DefaultSettings()
        settings.verbose = False
        quadratic = sparse.diags(weight + priced, format="csc")
        right = np.concatenate([part[3] for part in parts])
        problem = (quadratic, cost - weight * old, matrix, right, cones, settings)
        answer = clarabel.DefaultSolver(*problem).solve()
        if str(answer.status) not in ("Solved", "AlmostSolved"):
            return None
        new = np.array(answer.x)
        change = float(np.max(np.abs((new - old)[: self.at_virtual])))
        return Step(self._unpacked(new), float(cost @ new + 0.5 * priced @ new**2), change)

    def _packed(self, nodes: Nodes) -> np.ndarray:
        x, u = nodes.x / self.scales.x, nodes.u / self.scales.u
        virtual = np.zeros(self.unknowns - self.at_virtual)
        return np.concatenate([x.ravel(), u.ravel(), nodes.durations / self.scales.time, virtual])

    def _unpacked(self, unknowns: np.ndarray) -> Nodes:
        x = unknowns[: self.at_u].reshape(-1, STATES) * self.scales.x
        u = unknowns[self.at_u : self.at_time].reshape(-1, CONTROLS) * self.scales.u
        return Nodes(x, u, unknowns[self.at_time : self.at_virtual] * self.scales.time, self.nodes.full)


def _start_and_end(program: _Sparse, landing: RigidLanding) -> None:
    """From the given state to rest at the origin, upright, heading as at the start, without rates."""
    held = np.arange(STATES)
    program.add("zero", program.x(0, held)[:, None], np.ones((STATES, 1)), -landing.start / program.scales.x)
    rest = np.array([1, 2, 3, 4, 5, 6, 8, 9, 11, 12, 13])
    program.add("zero", program.x(program.n, rest)[:, None], np.ones((len(rest), 1)), np.zeros(len(rest)))
    heading = np.array([[landing.start[10], -landing.start[7]]])
    program.add("zero", program.x(program.n, np.array([[7, 10]])), heading, np.zeros(1))


def _reached(
    program: _Sparse, linear: Linear, k: int, point: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The state at a point of interval ``k``: columns, shape (23,), their values, (14, 23), and constant,
    (14,), all in units of the problem.
    """
    scales, nodes, by = program.scales, program.nodes, linear.by[point, k]
    at = np.concatenate([nodes.x[k], nodes.u[k], nodes.u[k + 1], [nodes.durations[nodes.parts[k]]]])
    units = np.concatenate([scales.x, scales.u, scales.u, [scales.time]])
    controls = (program.u(node, np.arange(CONTROLS)) for node in (k, k + 1))
    time = [program.at_time + nodes.parts[k]]
    columns = np.concatenate([program.x(k, np.arange(STATES)), *controls, time])
    return columns, by * units / scales.x[:, None], (linear.x[point, k] - by @ at) / scales.x


def _motion(program: _Sparse, linear: Linear) -> None:
    """Each node is where the linearised interval before it ends, but for virtual control."""
    own, signs = np.arange(STATES)[:, None], np.tile([-1.0, 1.0, -1.0], (STATES, 1))
    for k in range(program.n):
        columns, values, constant = _reached(program, linear, k, -1)
        virtual = program.at_virtual + 2 * STATES * k + own
        more = np.hstack([program.x(k + 1, own), virtual, virtual + STATES])
        columns = np.hstack([np.tile(columns, (STATES, 1)), more])
        program.add("zero", columns, np.hstack([values, signs]), constant)


def _bounds(program: _Sparse, landing: RigidLanding) -> None:
    """Bounds of single unknowns: controls, mass, durations, and the signs of virtual control."""
    scales, nodes, nodes_of = program.scales, program.nodes, np.arange(program.n + 1)
    low, high = np.full(program.n + 1, landing.thrust[0]), np.full(program.n + 1, landing.thrust[1])
    low[: nodes.full] = high[: nodes.full] = landing.thrust[1]  # the full thrust flown there is given
    _between(program, program.u(nodes_of, 0), low / scales.u[0], high / scales.u[0])
    for axis in range(3):
        most = np.full(program.n + 1, landing.torque[axis] / scales.u[1 + axis])
        _between(program, program.u(nodes_of, 1 + axis), -most, most)
    least = np.array([landing.full_time, landing.throttled_time][-len(nodes.durations) :])
    time = program.at_time + np.arange(len(least))
    _between(program, time, least / scales.time, np.full(len(least), LONGEST))
    _above(program, program.x(program.n, 0)[None], np.array([landing.dry_mass / scales.x[0]]))
    _above(program, np.arange(program.at_virtual, program.unknowns), np.zeros(2 * STATES * program.n))


def _between(program: _Sparse, which: np.ndarray, low: np.ndarray, high: np.ndarray) -> None:
    _above(program, which, low)
    program.add("positive", which[:, None], -np.ones((len(which), 1)), high)


def _above(program: _Sparse, which: np.ndarray, low: np.ndarray) -> None:
    program.add("positive", which[:, None], np.ones((len(which), 1)), -low)


def _limits(program: _Sparse, landing: RigidLanding, linear: Linear) -> None:
    """Tilt, rate and glide slope at the checked points; the last node is at rest."""
    tilt, rate = sin(0.5 * landing.tilt), landing.rate / program.scales.x[11]
    for point, k in product(range(len(linear.x)), range(program.n)):
        if point == len(linear.x) - 1 and k == program.n - 1:
            continue
        columns, values, constant = _reached(program, linear, k, point)
        for which, most in (([8, 9], tilt), ([11, 12, 13], rate)):
            rows = np.vstack([np.zeros_like(columns, float), values[which]])
            _within(program, columns, rows, np.append(most, constant[which]))
        if landing.glide_slope > -pi / 2.0:
            scale = np.array([1.0, tan(landing.glide_slope), tan(landing.glide_slope)])
            rows, constant = values[[3, 1, 2]] * scale[:, None], constant[[3, 1, 2]] * scale
            _within(program, columns, rows, constant)


def _within(program: _Sparse, columns: np.ndarray, rows: np.ndarray, constant: np.ndarray) -> None:
    """Rows of which the first is not less than the length of the others."""
    program.add("second_order", np.tile(columns, (len(rows), 1)), rows, constant)
