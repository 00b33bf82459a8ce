"""Margins and limit cycles of the attitude loop as it flies, in a frozen flight (:mod:`edl6dof.sim.frozen`).

Margins are measured by a push about one axis, with a gain on the thrust of all thrusters or a delay of all
valves; the smallest gain and delay at which the oscillation lasts are found by bisection.  Both act on all
axes at once: the margins of the linear loop to compare with are those of its characteristic loci.

A law that rests within a deadband has a limit cycle.  The prediction is the periodic motion of a relay loop,
as Hamel and Tsypkin compute it (Tsypkin, Relay Control Systems, 1984), by time steps: the law, allocation and
modulation that fly, instruments with their delay but no errors, pulses that are late by half the rise of the
thrust, and the linear plant with its constant torque.  A describing function would take the motion for a
sine, but it is made of straight lines or, where the air pushes to one side of the deadband, of parabolas.
Where each firing is one shortest pulse of the thrusters, the rates before and after it add up to a constant,
and every division of this sum is periodic.  The symmetric one, of shortest period, is predicted.  Prediction
and flight begin with the attitude of the moment and the rate of this division.  The limit cycle is that of
one axis: its firings turn the other axes, too, which would change the division and are held without error.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from math import inf, nan, pi, sqrt
from typing import NamedTuple

import numpy as np

from edl6dof.sim.attitude_loop import NO_MARGINS, AttitudeLoop, margins
from edl6dof.sim.frozen import FrozenFlight
from edl6dof.sim.linear import linear_plant, turned
from edl6dof.vehicle.plant import ATTITUDE, RATE

#: Share of the largest torque that the push makes the law demand, and largest angle of the oscillation (rad).
_SHARE, _ANGLE = 0.3, np.radians(0.25)
#: Periods of a measurement; shares of the time over which its first and last amplitude are taken; relative
#: precision of a delay, precision of a gain (dB).
_PERIODS, _FIRST, _LAST, _DELAY_STEP, _GAIN_STEP = 16, (0.1, 0.4), (0.7, 1.0), 0.01, 0.1
#: Last amplitude of an oscillation that lasts, over the first one, over the push, and over that of the pulses
#: in the unchanged flight.
_KEPT, _OF_PUSH, _FLOORS = 0.8, 0.3, 2.0
#: Time of a limit cycle (s), and half cycles of it that are evaluated, before noise has changed the division.
_CYCLES_S, _HALVES = 400.0, 4
#: First rate that is tried (rad/s); time without a pulse after which a firing has ended (s); time constant at
#: which the error of the other axes is removed (s).
_RATE, _QUIET_S, _HOLD_S = np.radians(0.02), 1.0, 20.0


class Measured(NamedTuple):
    """Largest gain and delay of all axes at which a push decays, infinite if it decays at all values tried;
    and those of the linear loop.
    """

    gain_db: float
    delay_s: float
    linear_gain_db: float
    linear_delay_s: float


class LimitCycle(NamedTuple):
    """Half the mean range between turning points of an attitude error, and its period; NaN without one."""

    amplitude_deg: float
    period_s: float


def measured(frozen: FrozenFlight, loop: AttitudeLoop) -> Measured:
    """Measure the margins of a flight with this linear ``loop``; axes that rest are not pushed."""
    axes = [i for i in range(3) if loop.added_rate_rad_s[i] == 0.0]
    found = [(margins(loop.locus(i), loop.highest), i) for i in axes]
    gain_db = delay_s = inf
    strong, i = min(found, key=lambda pair: pair[0].gain_db, default=(NO_MARGINS, 0))
    if strong.gain_db < inf:
        push = Push.of(frozen, loop, i, strong.turnover_rad_s)
        gain_db = bisected(lambda gain: push.lasts(gain_db=gain), strong.gain_db, _GAIN_STEP)
    late, i = min(found, key=lambda pair: pair[0].delay_s, default=(NO_MARGINS, 0))
    if late.delay_s < inf:
        push = Push.of(frozen, loop, i, late.crossover_rad_s)
        delay_s = bisected(lambda delay: push.lasts(delay_s=delay), late.delay_s, _DELAY_STEP * late.delay_s)
    return Measured(gain_db, delay_s, strong.gain_db, late.delay_s)


def bisected(unstable: Callable[[float], bool], guess: float, step: float) -> float:
    """Find the smallest value from 0 on at which something is unstable; infinite beyond 6 times ``guess``."""
    low, high = 0.0, 1.5 * guess
    while not unstable(high):
        low, high = high, 2.0 * high
        if high > 6.0 * guess:
            return inf
    while high - low > step:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if unstable(middle) else (middle, high)
    return 0.5 * (low + high)


@dataclass(frozen=True)
class Push:
    """A push of a frozen flight about one axis.

    Attributes:
        frozen: the flight.
        axis: number of the axis of B.
        rate: rate added at the start, rad/s.
        frequency: expected frequency of the oscillation, rad/s.
        floor: amplitude of the unchanged flight some time after the push, rad/s.
    """

    frozen: FrozenFlight
    axis: int
    rate: float
    frequency: float
    floor: float = 0.0

    @classmethod
    def of(cls, frozen: FrozenFlight, loop: AttitudeLoop, axis: int, frequency: float) -> Push:
        """Choose a push within the linear range of the law."""
        by_turn, by_rate = np.abs(loop.software[..., axis, [axis, 3 + axis]]).max(axis=(0, 1))
        answer = max(float(by_turn) / frequency, float(by_rate))
        rate = min(_SHARE * float(loop.largest_nm[axis]) / answer, _ANGLE * frequency)
        push = cls(frozen, axis, rate, frequency)
        return replace(push, floor=push.amplitudes(0.0, 0.0)[1])

    def lasts(self, gain_db: float = 0.0, delay_s: float = 0.0) -> bool:
        """Return whether the oscillation after the push lasts, with this gain on the thrust and delay of the
        valves: it keeps its amplitude, and exceeds a part of that of the push and the one of the pulses.
        """
        first, last = self.amplitudes(gain_db, delay_s)
        return last > max(_KEPT * first, _OF_PUSH * self.rate, _FLOORS * self.floor)

    def amplitudes(self, gain_db: float, delay_s: float) -> tuple[float, float]:
        """Fly after the push; return the amplitude of the rate (rad/s) early and late, root mean square."""
        self.frozen.restart(gain=10.0 ** (gain_db / 20.0))
        rate = self.frozen.flight.plant["y"][0, RATE + self.axis : RATE + self.axis + 1]
        rate += self.rate
        seconds = max(_PERIODS * 2.0 * pi / self.frequency, 40.0 * self.frozen.control_s)
        flown = np.array([float(rate[0]) for _ in self.frozen.flown(seconds, delay_s)])
        early, late = (slice(*(int(x * len(flown)) for x in window)) for window in (_FIRST, _LAST))
        return float(np.std(flown[early])), float(np.std(flown[late]))


def limit_cycles(frozen: FrozenFlight, axis: int) -> tuple[LimitCycle, LimitCycle]:
    """Return the predicted and the flown limit cycle of an axis; the other axes are held without error."""
    relay = Relay(frozen, axis)
    start = relay.symmetric_rate()
    predicted = [error for error, *_ in relay.motion(relay.angle, start, _CYCLES_S)]
    frozen.restart()
    error = frozen.flight.fsw["demand"]["attitude_error"][0]
    rate = frozen.flight.plant["y"][0, RATE : RATE + 3]
    others, rate[axis], flown = np.arange(3) != axis, start, []
    rate[others] = 0.0
    for _ in frozen.flown(_CYCLES_S):
        flown.append(float(error[axis]))
        rate[others] = error[others] / _HOLD_S
    return oscillation(np.array(predicted), frozen.control_s), oscillation(np.array(flown), frozen.control_s)


def oscillation(errors: np.ndarray, step_s: float) -> LimitCycle:
    """Amplitude and mean period of the first cycles of errors (rad) at equal times, about the middle of their
    range after the first quarter.
    """
    late = errors[len(errors) // 4 :]
    above = errors >= 0.5 * (late.max() + late.min())
    passed = (np.flatnonzero(above[1:] != above[:-1]) + 1).tolist()
    turns = [
        first + int((np.argmax if above[first] else np.argmin)(errors[first:last]))
        for first, last in pairwise(passed[: 2 + _HALVES])
    ]
    if len(turns) < 3:
        return LimitCycle(nan, nan)
    half_s = step_s * (turns[-1] - turns[0]) / (len(turns) - 1)
    return LimitCycle(float(np.degrees(0.5 * np.mean(np.abs(np.diff(errors[turns]))))), 2.0 * half_s)


class Relay:
    """An axis of a frozen flight as a relay loop, with the other axes at rest without error.

    Attributes:
        angle: attitude of the moment, as an angle (rad) about the axis from the attitude without error.
        steady, stiffness, damping: acceleration without error (rad/s2), by an angle (1/s2), by a rate (1/s).
    """

    def __init__(self, frozen: FrozenFlight, axis: int) -> None:
        self.frozen, self.axis, flight = frozen, axis, frozen.flight
        frozen.restart()
        frozen.command()
        y, inputs = flight.plant["y"][0], flight.plant["inputs"]
        q = y[ATTITUDE : ATTITUDE + 4]
        error = flight.fsw["demand"]["attitude_error"][0]
        self.angle = -float(error[axis])
        q[:] = self._q_I2B = _turned(q, error)
        y[RATE : RATE + 3] = inputs["rcs_moment"] = inputs["rcs_force"] = 0.0
        flight.look()
        self.steady = float(flight.work["k"][0, 0, RATE + axis])
        plant = linear_plant(flight)
        self.stiffness, self.damping = (float(plant.a[9 + axis, place + axis]) for place in (6, 9))
        jets = flight.case["vehicle"]["rcs"]["thrusters"][0, : frozen.thrusters]
        self._age = float(flight.onboard["imu_delay"][0]) + 0.5 * jets["rise"]
        force = (jets["thrust"] * jets["thrust_factor"])[:, None] * jets["direction"]
        moment = np.cross(jets["position"], force)
        self._gained = np.concatenate([moment, force], axis=1) @ plant.b[9 + axis]

    def symmetric_rate(self) -> float:
        """Rate (rad/s), from the attitude of the moment on, that a firing reverses without changing its
        size; zero if the firing always makes it smaller.
        """
        rate = _RATE
        for _ in range(8):
            found = self.firing(self.angle, rate)
            if found is None:
                rate *= 2.0
                continue
            before, after = found
            # the same torque acts on the way to the firing with another rate: the energies differ equally
            rate = sqrt(max(rate**2 + (0.5 * (after - before)) ** 2 - before**2, 0.0))
        return rate

    def firing(self, angle: float, rate: float) -> tuple[float, float] | None:
        """Rate (rad/s) before and after the first firing that reverses it; ``None`` if there is none."""
        before = after = nan
        quiet_s = inf
        for _, now, gained in self.motion(angle, rate, 0.5 * _CYCLES_S):
            if gained != 0.0:
                before = before if quiet_s < _QUIET_S else now
                quiet_s, after = 0.0, now + gained
            elif quiet_s >= _QUIET_S and before * after < 0.0:
                return before, after
            quiet_s += self.frozen.control_s
        return None

    def motion(self, angle: float, rate: float, seconds: float) -> Iterator[tuple[float, float, float]]:
        """Attitude error (rad), rate (rad/s) and change of the rate by pulses in each control cycle, from an
        ``angle`` (rad) and a ``rate`` on.
        """
        frozen, axis, step = self.frozen, self.axis, self.frozen.control_s
        frozen.restart()
        one, unseen = np.eye(3)[axis], 0.0
        error = frozen.flight.fsw["demand"]["attitude_error"][0]
        for _ in range(round(seconds / step)):
            on = frozen.believe(turned(self._q_I2B, axis, angle), (rate - unseen) * one)
            drift = self.steady + self.stiffness * angle + self.damping * rate
            pulses = self._gained * on  # from the start of the cycle on
            gained = float(pulses.sum())
            yield float(error[axis]), rate, gained
            unseen = float(self._gained @ np.clip(on + self._age - step, 0.0, on))
            angle += rate * step + 0.5 * drift * step**2 + float(pulses @ (step - 0.5 * on))
            rate += drift * step + gained


def _turned(q_I2B: np.ndarray, angles: np.ndarray) -> np.ndarray:
    """An attitude turned by small angles (rad) about the axes of B."""
    for axis, angle in enumerate(angles.tolist()):
        q_I2B = turned(q_I2B, axis, angle)
    return q_I2B
