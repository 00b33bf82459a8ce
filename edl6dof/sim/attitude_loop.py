"""The linear attitude loop of a flight at a moment, from the functions that fly, and its margins.

The loop of a frozen flight (:mod:`edl6dof.sim.frozen`) is opened at the thrusters.  Three parts are found by
finite differences: the torque that the flight software demands after a pulse of attitude or rate in one base
cycle, by the whole chain of instruments, navigation, estimator and controller; the torque that it demands
because thrusters were open for a control cycle, which the estimator subtracts; and the force and torque that
the allocation gives for a demand.  The plant is :func:`edl6dof.sim.linear.linear_plant`, sampled exactly.
Pulse modulation gives the mean of a demand, which counts as a hold over the control cycle; it begins when the
thrust has risen by half.

With the demand ``v`` and the motion ``x`` of the plant, ``v = C1 x + C2 v`` and ``x = P v``; the open loop at
the input of the plant is ``L = -(1 - C2)^-1 C1 P``.  The loop of one axis has the others closed.  Disk
margin: Seiler, Packard and Gahinet, IEEE Control Systems 40(5), 2020, without skew.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from itertools import permutations
from math import atan, degrees, inf, log, log10, nan, pi
from typing import NamedTuple

import numpy as np
from scipy.linalg import expm
from scipy.optimize import brentq, minimize_scalar

from edl6dof.sim.frozen import FrozenFlight
from edl6dof.sim.linear import linear_plant
from edl6dof.vehicle.propulsion.rcs import efficiency

#: Open loop L(j w) for frequencies (rad/s) of shape (n,).
Loop = Callable[[np.ndarray], np.ndarray]

#: Pulse of attitude (rad) and of rate (rad/s): thousands of counts of the gyros.
_PULSE = 2e-3
#: Control cycles before the pulse; time after which a response is constant, s; share of the largest torque of
#: an axis for which the allocation is examined.
_LEAD, _SETTLED_S, _SHARE = 4, 4.0, 0.3
#: Additional rates (rad/s) about each axis at which the law is linearised; the first counts at which the axis
#: does not rest, with at least this acceleration by rotation (1/s2) or rate (1/s).
_RATES, _RESTS = np.radians((0.0, 1.0, 6.0)), 0.02
#: Share by which the response to half a pulse may differ; a relay differs by one.
_BEND = 0.2
#: Lowest frequency of a margin (rad/s), number of frequencies evaluated first, and gain below which a loop
#: counts as open.
_LOWEST, _COUNT, _OPEN = 0.02, 1500, 1e-3
_ORDERS = list(permutations(range(3)))


class Margins(NamedTuple):
    """Margins of one loop; infinite where no change makes it unstable.

    Attributes:
        gain_db, gain_down_db: factors by which the gain may grow and shrink, both positive.
        phase_deg: smallest change of phase at unit gain that makes the loop unstable.
        delay_s: smallest delay that does.
        disk: alpha; gain may change by (1 + alpha / 2) / (1 - alpha / 2), and phase by 2 atan(alpha / 2), at
            the same time.
        crossover_rad_s: highest frequency of unit gain; NaN if there is none.
        turnover_rad_s: frequency of the oscillation at the largest gain; NaN if there is none.
    """

    gain_db: float
    gain_down_db: float
    phase_deg: float
    delay_s: float
    disk: float
    crossover_rad_s: float
    turnover_rad_s: float

    def __repr__(self) -> str:
        words = (
            f"gain {self.gain_db:.1f} dB, phase {self.phase_deg:.0f} deg, delay {1e3 * self.delay_s:.0f} ms"
        )
        return f"<Margins: {words}, disk {self.disk:.2f}>"

    @property
    def disk_gain_db(self) -> float:
        """Change of gain that the disk allows, dB."""
        return 20.0 * log10((2.0 + self.disk) / (2.0 - self.disk)) if self.disk < 2.0 else inf

    @property
    def disk_phase_deg(self) -> float:
        """Change of phase that the disk allows, deg."""
        return degrees(2.0 * atan(0.5 * self.disk))


#: Margins of a loop that is open.
NO_MARGINS = Margins(inf, inf, inf, inf, inf, nan, nan)


def margins(loop: Loop, highest: float) -> Margins:
    """Compute the margins of a loop that is stable when closed (return difference 1 + L).

    Args:
        loop: the open loop.
        highest: highest frequency, rad/s; of a sampled loop the Nyquist frequency.
    """
    w = np.geomspace(_LOWEST, highest, _COUNT)
    values = loop(w)

    def at(frequency: float) -> complex:
        return complex(loop(np.array([frequency]))[0])

    def root(f: Callable[[complex], float], k: int, seen: np.ndarray) -> float:
        if f(at(w[k])) * f(at(w[k + 1])) >= 0.0:  # one of them is zero but for rounding
            return float(w[k + np.argmin(np.abs(seen[k : k + 2]))])
        return float(brentq(lambda x: f(at(x)), w[k], w[k + 1], xtol=1e-12))

    def roots(f: Callable[[complex], float], seen: np.ndarray) -> list[float]:
        return [root(f, k, seen) for k in np.flatnonzero(seen[:-1] * seen[1:] < 0.0)]

    crossings = np.array(roots(lambda x: abs(x) - 1.0, np.abs(values) - 1.0))
    left = np.angle([-at(x) for x in crossings]) if len(crossings) else np.zeros(0)
    real = roots(lambda x: x.imag, values.imag)
    if abs(values[-1].imag) <= 1e-9 * abs(values[-1]):
        real.append(highest)
    turns = [(20.0 * log10(-size), x) for x in real if (size := at(x).real) < -_OPEN]
    up = min(((-gain, x) for gain, x in turns if gain < 0.0), default=(inf, nan))
    return Margins(
        gain_db=up[0],
        gain_down_db=min((gain for gain, _ in turns if gain > 0.0), default=inf),
        phase_deg=degrees(min(np.abs(left), default=inf)),
        delay_s=float(min(np.where(left > 0.0, left, left + 2.0 * pi) / crossings, default=inf)),
        disk=_disk(at, w, values),
        crossover_rad_s=float(max(crossings, default=nan)),
        turnover_rad_s=up[1],
    )


def _disk(at: Callable[[float], complex], w: np.ndarray, values: np.ndarray) -> float:
    """Disk margin alpha = 1 / max |S - 1/2| with S = 1 / (1 + L)."""

    def distance(x: np.ndarray | complex) -> np.ndarray:
        return np.abs(2.0 * (1.0 + x) / (1.0 - x))

    k = int(np.argmin(distance(values)))
    bounds = log(w[max(k - 1, 0)]), log(w[min(k + 1, len(w) - 1)])
    found = minimize_scalar(
        lambda x: float(distance(at(np.exp(x)))), bounds=bounds, method="bounded", options={"xatol": 1e-9}
    )
    return float(min(found.fun, distance(values[k])))


@dataclass(frozen=True)
class AttitudeLoop:
    """The sampled attitude loop of a frozen flight; axes x, y, z of B.

    Attributes:
        software: torque demanded after a pulse, shape (base cycles of a control cycle, control cycles, 3, 6):
            base cycle of the pulse, time, axis of the torque, rotation and rate of the pulse; N m / rad and
            N m s / rad.
        valves: torque demanded after a control cycle of thrust, over that torque, shape (control cycles, 3,
            3).
        a, b: continuous plant of rotation and rate under a demanded torque, shapes (6, 6) and (6, 3).
        control_s: control cycle, s.
        lag_s: time from the command to the thrust, s.
        largest_nm: largest torque that the thrusters give about each axis, N m, shape (3,).
        added_rate_rad_s: additional rate about each axis at which the law is linearised; NaN for an axis
            that rests at every rate, shape (3,).
    """

    software: np.ndarray
    valves: np.ndarray
    a: np.ndarray
    b: np.ndarray
    control_s: float
    lag_s: float
    largest_nm: np.ndarray
    added_rate_rad_s: np.ndarray

    def margins(self, i: int) -> Margins | None:
        """Margins of axis ``i`` with the other axes closed; ``None`` if its law rests."""
        rests = np.isnan(self.added_rate_rad_s[i]) or self.largest_nm[i] <= 0.0
        return None if rests else margins(self.axis(i), self.highest)

    @property
    def highest(self) -> float:
        """Nyquist frequency, rad/s."""
        return pi / self.control_s

    def axis(self, i: int) -> Loop:
        """Open loop of axis ``i`` with the other axes closed."""
        others = [k for k in range(3) if k != i]

        def loop(w: np.ndarray) -> np.ndarray:
            full = self.matrix(w)
            rest = np.eye(2) + full[:, others][:, :, others]
            inner = np.linalg.solve(rest, full[:, others, i][..., None])
            return full[:, i, i] - (full[:, None, i, others] @ inner)[:, 0, 0]

        return loop

    def locus(self, i: int) -> Loop:
        """Characteristic locus of axis ``i``: the eigenvalue of the open loop that belongs to it.  A change
        in all axes together has the margins of the loci.
        """

        def loop(w: np.ndarray) -> np.ndarray:
            full = self.matrix(w)
            values, own = np.linalg.eigvals(full), np.diagonal(full, axis1=1, axis2=2)
            distances = [np.abs(values[:, order] - own).sum(axis=1) for order in _ORDERS]
            chosen = np.array(_ORDERS)[np.argmin(distances, axis=0), i]
            return values[np.arange(len(w)), chosen]

        return loop

    def matrix(self, w: np.ndarray) -> np.ndarray:
        """Open loop of all axes at frequencies (rad/s) of shape (n,), shape (n, 3, 3)."""
        z = np.exp(1j * w * self.control_s)
        motions = zip(self.software, self._motion(z), strict=True)
        demand = sum(_transform(response, z) @ motion for response, motion in motions)
        return -np.linalg.solve(np.eye(3) - _transform(self.valves, z), demand)

    def _motion(self, z: np.ndarray) -> list[np.ndarray]:
        """Rotation and rate in each base cycle for demands ``z^k``, shape (n, 6, 3) each."""
        z = z[:, None, None]
        late = z ** -(self.lag_s // self.control_s)
        (turn, old, new), *within = self._sampled
        first = np.linalg.solve(z * np.eye(6) - turn, old / z + new)
        return [late * (turn @ first + old / z + new) for turn, old, new in within]

    @cached_property
    def _sampled(self) -> list[tuple[np.ndarray, np.ndarray, np.ndarray]]:
        """Transition over the control cycle, and up to each base cycle in it: from the state, shape (6, 6),
        and from the demands of the cycle before and of this one, shape (6, 3).
        """
        whole, lag = np.zeros((9, 9)), self.lag_s % self.control_s
        whole[:6, :6], whole[:6, 6:] = self.a, self.b

        def moved(t: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
            before, after = expm(whole * min(t, lag)), expm(whole * max(t - lag, 0.0))
            return after[:6, :6] @ before[:6, :6], after[:6, :6] @ before[:6, 6:], after[:6, 6:]

        times = [p * self.control_s / len(self.software) for p in range(len(self.software))]
        return [moved(t) for t in (self.control_s, *times)]


def _transform(response: np.ndarray, z: np.ndarray) -> np.ndarray:
    """z transform of a response along axis 0 that stays at its last value, shape (len(z), ...)."""
    last = response[-1]
    decaying = (response - last).reshape(len(response), -1)
    found = z[:, None] ** -np.arange(len(response)) @ decaying + last.reshape(-1) / (1.0 - 1.0 / z)[:, None]
    return found.reshape(len(z), *last.shape)


def linearise(frozen: FrozenFlight) -> AttitudeLoop:
    """Linearise the attitude loop of a frozen flight."""
    frozen.restart()
    plant = linear_plant(frozen.flight)
    wrench, duty, largest = _thrust(frozen)
    b = plant.b[6:] @ wrench
    cycles = round(_SETTLED_S / frozen.control_s)
    software, added = np.zeros((frozen.every, cycles, 3, 6)), np.full(3, nan)
    for rate in _RATES:
        moves = np.isnan(added) & _moves(frozen, rate, np.diag(b[3:]))
        if moves.any():
            software[:, :, moves], added[moves] = _software(frozen, rate, cycles)[:, :, moves], rate
    rise = frozen.flight.case["vehicle"]["rcs"]["thrusters"]["rise"][0, : len(duty)]
    weight = duty.sum(axis=1)
    return AttitudeLoop(
        software=software,
        valves=_valves(frozen, duty, cycles),
        a=plant.a[6:, 6:],
        b=b,
        control_s=frozen.control_s,
        lag_s=float(0.5 * rise @ weight / max(weight.sum(), 1e-9)),
        largest_nm=largest,
        added_rate_rad_s=added,
    )


def _demands(
    frozen: FrozenFlight,
    cycles: int,
    still: np.ndarray,
    pulse: np.ndarray | float = 0.0,
    when: int = 0,
    firing: np.ndarray | None = None,
) -> np.ndarray:
    """Torque demanded (N m, B), shape (cycles, 3), while the motion is imposed.

    Args:
        frozen: the flight.
        cycles: number of control cycles.
        still: rotation (rad) and rate (rad/s) added to those of the moment, shape (6,).
        pulse: more of them in base cycle ``when``.
        when: number of the base cycle.
        firing: thrusters that the flight software believes to be open in the first control cycle.
    """
    frozen.restart({"duties": np.zeros(frozen.thrusters)})
    found = np.zeros((_LEAD + cycles, 3))
    for k in range(-_LEAD * frozen.every, cycles * frozen.every):
        motion = still + pulse if k == when else still
        frozen.impose(motion[:3], motion[3:])
        frozen.command()
        if k % frozen.every == 0:
            found[_LEAD + k // frozen.every] = frozen.flight.fsw["own"]["torque_B"][0]
        if k == 0 and firing is not None:
            frozen.pretend(firing)
        frozen.coast()
    return found[_LEAD:]


def _software(frozen: FrozenFlight, rate: float, cycles: int, size: float = _PULSE) -> np.ndarray:
    """Responses to pulses of a ``size`` (rad, rad/s), as in :class:`AttitudeLoop`, with ``rate`` (rad/s)
    added about each axis.
    """
    found, still = np.zeros((frozen.every, cycles, 3, 6)), rate * np.repeat([0.0, 1.0], 3)
    for when in range(frozen.every):
        for j, pulse in enumerate(size * np.eye(6)):
            up, down = (_demands(frozen, cycles, still, sign * pulse, when) for sign in (1.0, -1.0))
            found[when, :, :, j] = (up - down) / (2.0 * size)
    return found


def _moves(frozen: FrozenFlight, rate: float, acceleration: np.ndarray) -> np.ndarray:
    """Return for each axis whether the law answers a pulse about it, and half a pulse by half as much, shape
    (3,); ``acceleration``: of each axis by its torque, 1 / (kg m2).
    """
    whole, half = (_software(frozen, rate, 3, size) for size in (_PULSE, 0.5 * _PULSE))
    own = [np.array([one[:, :, i, [i, 3 + i]] for i in range(3)]) for one in (whole, half)]
    largest, bend = np.abs(own[0]).max(axis=(1, 2, 3)), np.abs(own[1] - own[0]).max(axis=(1, 2, 3))
    return (largest * acceleration > _RESTS) & (bend < _BEND * largest)


def _valves(frozen: FrozenFlight, duty: np.ndarray, cycles: int) -> np.ndarray:
    """Responses to thrust, as in :class:`AttitudeLoop`; ``duty``: of the thrusters for each axis."""
    sets = [duty[:, i] > 0.1 * duty[:, i].max(initial=1e-9) for i in range(3)]
    if not all(one.any() for one in sets):
        return np.zeros((2, 3, 3))
    still, rest = np.zeros(6), _demands(frozen, cycles, np.zeros(6))
    after = np.stack([_demands(frozen, cycles, still, firing=one) - rest for one in sets], axis=2)
    effectiveness = frozen.flight.fsw["effectiveness"]["matrix"][0, : len(duty), 3:]
    return after @ np.linalg.pinv(np.stack([effectiveness[one].sum(axis=0) for one in sets], axis=1))


def _thrust(frozen: FrozenFlight) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """True torque and force (about the origin of B) by demanded torque, shape (6, 3); duties for a torque
    about each axis, shape (thrusters, 3); largest torque about each axis, N m, shape (3,).
    """
    count, rcs = frozen.thrusters, frozen.flight.case["vehicle"]["rcs"][0]
    jets = rcs["thrusters"][:count]

    def duties(torque: np.ndarray) -> np.ndarray:
        frozen.restart({"torque_nm": torque})
        frozen.command()
        return frozen.flight.fsw["allocation"]["duty"][0, :count].copy()

    def given(duty: np.ndarray) -> np.ndarray:
        left = efficiency(rcs, float(frozen.flight.outputs["dynamic_pressure"][0]))
        force = (left * jets["thrust"] * jets["thrust_factor"] * duty)[:, None] * jets["direction"]
        return np.concatenate([np.cross(jets["position"], force).sum(axis=0), force.sum(axis=0)])

    wrench, found, largest = np.zeros((6, 3)), np.zeros((count, 3)), np.zeros(3)
    for i, axis in enumerate(np.eye(3)):
        most = duties(1e6 * axis)
        largest[i] = max(most @ frozen.flight.fsw["effectiveness"]["matrix"][0, :count, 3 + i], 0.0)
        if largest[i] > 0.0:
            size = _SHARE * largest[i]
            up, down = (duties(sign * size * axis) for sign in (1.0, -1.0))
            wrench[:, i], found[:, i] = (given(up) - given(down)) / (2.0 * size), up
    return wrench, found, largest
