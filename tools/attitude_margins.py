"""Stability margins of the attitude loops of a scenario inside their PID zones, from the sampled linear loop
as it flies: ``python tools/attitude_margins.py tianwen1``.

One axis is a double integrator of unit inertia.  The control law runs every cycle T; the demanded torque acts
from the valve lag on until the next one does (pulse modulation gives the demanded mean over a cycle, so it
counts as a hold).  The disturbance estimator sees the rate a sensor delay late and knows which commands fell
into the cycle it looks at.  Left out: the quantum of the minimum pulse and the deadband of the modulation,
which make a limit cycle of their own size but do not move these margins.
Source: the loop of Hu et al. 2022, sections 4 and 6; margins by the open loop at the plant's input, in the
z-domain.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass, replace
from math import degrees, exp, pi
from typing import Any

import numpy as np

import edl6dof
from edl6dof.scenario.schema import Scenario

#: States: angle, rate, last input of the plant, last measured rate, last two commands, disturbance estimate,
#: the same smoothed, integral.
_STATES = 9
#: Changes of gain that are tried, dB.
SEARCH_DB = 60.0


@dataclass(frozen=True)
class Loop:
    """One attitude axis: gains per unit inertia, and the times of the sampled loop.

    Attributes:
        proportional: acceleration per angle error, 1/s2.
        integral: acceleration per integrated error, 1/s3.
        derivative: acceleration per rate, 1/s.
        pole: of the disturbance estimator that works in the loop, rad/s; 0 for none.
        smoothing: time constant of the filter behind the estimator, s; 0 for none.
        cycle: control cycle T, s.
        valve_lag: time by which thrust follows the valve, s.
        sensor_delay: age of the inertial reading that the estimator sees, s.
    """

    proportional: float
    integral: float
    derivative: float
    pole: float = 0.0
    smoothing: float = 0.0
    cycle: float = 0.04
    valve_lag: float = 0.006
    sensor_delay: float = 0.02

    def with_bandwidth(self, factor: float) -> Loop:
        """The loop with the natural frequency of its PID law multiplied, as a mission phase may ask."""
        p, i, d = self.proportional * factor**2, self.integral * factor**3, self.derivative * factor
        smoothing = (1.0 / factor - 1.0) / self.pole if self.pole and factor < 1.0 else 0.0
        return replace(self, proportional=p, integral=i, derivative=d, smoothing=smoothing)

    def matrices(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """(A, B, C) from the acceleration that reaches the plant to the one commanded, one cycle to the
        next.
        """
        cycle, lag, delay = self.cycle, self.valve_lag, self.sensor_delay
        gain = 1.0 - exp(-self.pole * cycle)
        smooth = 1.0 - exp(-cycle / self.smoothing) if self.smoothing else 1.0
        angle, rate, applied, measured, last, before, estimate, smoothed, integral = np.eye(_STATES)
        now = rate - delay * applied
        expected = ((delay + lag) * before + (cycle - delay - lag) * last) / cycle
        found = (
            gain * ((now - measured) / cycle - expected) + (1.0 - gain) * estimate
            if self.pole
            else 0.0 * estimate
        )
        used = smoothed + smooth * (found - smoothed)
        summed = integral - cycle * angle if self.integral else 0.0 * integral
        command = -self.proportional * angle + self.integral * summed - self.derivative * rate - used
        rest = cycle - lag
        moved = angle + cycle * rate + lag * (cycle - lag / 2.0) * applied
        after = np.stack([moved, rate + lag * applied, 0 * rate, now, command, last, found, used, summed])
        entering = np.array([rest * rest / 2.0, rest, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
        return after, entering, command

    def open_loop(self, frequency: np.ndarray) -> np.ndarray:
        """L(j w) at the plant's input for frequencies in rad/s; the closed loop is stable where 1 + L is not
        encircled.
        """
        a, b, c = self.matrices()
        z = np.exp(1j * np.asarray(frequency) * self.cycle)
        answers = np.linalg.solve(z[:, None, None] * np.eye(_STATES) - a, b)
        return np.array([-c @ answer for answer in answers])

    def is_stable(self, gain: float = 1.0) -> bool:
        """Whether the loop is stable with ``gain`` times the thrust that the law reckons with."""
        a, b, c = self.matrices()
        return bool(np.max(np.abs(np.linalg.eigvals(a + gain * np.outer(b, c)))) < 1.0 - 1e-12)


@dataclass(frozen=True)
class Margins:
    """Margins of one loop.

    Attributes:
        crossover_rad_s: highest frequency of unit gain.
        phase_deg: phase margin there.
        gain_db: factor by which the gain may grow.
        gain_down_db: factor by which it may shrink (negative); ``-SEARCH_DB`` stands for any.
        delay_s: dead time that the phase margin is worth.
    """

    crossover_rad_s: float
    phase_deg: float
    gain_db: float
    gain_down_db: float
    delay_s: float


def margins(loop: Loop) -> Margins:
    """Phase margin from the open loop on a fine grid up to the Nyquist frequency, gain margins from the poles
    of the closed one.
    """
    w = np.geomspace(1e-2, 0.9999 * pi / loop.cycle, 20000)
    answer = loop.open_loop(w)
    down = np.flatnonzero(np.abs(answer) >= 1.0)[-1]
    angle = float(np.angle(-answer[down]))
    return Margins(
        float(w[down]),
        degrees(angle),
        _gain_limit(loop, 1.0),
        _gain_limit(loop, -1.0),
        angle / float(w[down]),
    )


def _gain_limit(loop: Loop, sign: float) -> float:
    """Change of gain (dB) at which a stable loop becomes unstable, upwards or downwards, by bisection."""
    stable, unstable = 0.0, SEARCH_DB
    if loop.is_stable(10.0 ** (sign * unstable / 20.0)):
        return sign * unstable
    while unstable - stable > 1e-3:
        middle = 0.5 * (stable + unstable)
        if loop.is_stable(10.0 ** (sign * middle / 20.0)):
            stable = middle
        else:
            unstable = middle
    return sign * stable


def flown_loops(scenario: Scenario) -> dict[str, Loop]:
    """The PID loops of a scenario's attitude control, by channel."""
    software = scenario.flight_software
    control, rates = software.control, software.rates
    times = {
        "cycle": rates.control_every / rates.base_hz,
        "valve_lag": software.estimation.valve_lag_s,
        "sensor_delay": scenario.sensors.imu.delay_cycles / rates.base_hz,
    }
    steer, lander = control.bank_to_steer, control.thrust_vector
    pole = (
        software.estimation.first_order.torque_pole_rad_s
        if lander.against_disturbance == "estimator"
        else 0.0
    )

    def loop(zone: Any, pole: float = 0.0, integral: bool = True) -> Loop:
        return Loop(zone.proportional, zone.integral if integral else 0.0, zone.derivative, pole, **times)

    own = lander.against_disturbance == "integral"
    loops = {
        "bank": loop(steer.bank),
        "alpha held": loop(steer.held_alpha),
        "parachute roll": loop(control.rate_damping.roll),
        "lander pitch and yaw": loop(lander.pitch_yaw, pole, own),
        "lander roll": loop(lander.roll, pole, own),
    }
    for phase in scenario.mission.phases:
        if phase.control == "thrust_vector" and phase.bandwidth != 1.0:
            loops[phase.name] = loops["lander pitch and yaw"].with_bandwidth(phase.bandwidth)
    return loops


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scenario", nargs="?", default="tianwen1")
    parser.add_argument("--set", action="append", default=[], metavar="PATH=VALUE")
    given = parser.parse_args()
    print(f"{'loop':24}{'crossover rad/s':>16}{'phase deg':>10}{'gain dB':>9}{'down dB':>9}{'delay s':>9}")
    for name, loop in flown_loops(edl6dof.load(given.scenario, given.set).scenario).items():
        own = margins(loop)
        figures = (own.phase_deg, own.gain_db, own.gain_down_db)
        words = "".join(f"{x:{width}.0f}" for x, width in zip(figures, (10, 9, 9), strict=True))
        print(f"{name:24}{own.crossover_rad_s:16.1f}{words}{own.delay_s:9.2f}")


if __name__ == "__main__":
    main()
