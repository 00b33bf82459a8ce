"""The setting of Lu & Bayard's theorem, integrated by itself: drag, drag rate and speed under eq. 15,
constant theta, unlimited control.

The controller is made of the kernels that fly (feedback, Riccati solution, adaptation); the reference is a
given function of time.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from edl6dof.fsw.guidance.entry.laws.hinf import adapt, feedback, riccati
from edl6dof.fsw.guidance.entry.prediction.uncertain_drag import uncertain_drag

STEP_S = 0.05


@dataclass(frozen=True)
class Design:
    """What the controller is told.

    Attributes:
        gain, weight, energy: lambda (s2), rho (s4) and epsilon (m2/s3) of the law.
        low, high: the set of theta, shape (5,).
        gravity, radius, scale_height: of the reference sphere, SI.
    """

    gain: float
    weight: float
    energy: float
    low: np.ndarray
    high: np.ndarray
    gravity: float
    radius: float
    scale_height: float


@dataclass(frozen=True)
class Response:
    """One integration or flight; every array has shape (rows,).

    Attributes:
        t, error, disturbance: time (s), drag error (m/s2) and w (m/s4).
        state_energy: z' P z, m2/s3.
    """

    t: np.ndarray
    error: np.ndarray
    disturbance: np.ndarray
    state_energy: np.ndarray

    @property
    def error_energy(self) -> float:
        """Integral of e^2, m2/s3."""
        return float(np.trapezoid(self.error**2, self.t))

    def disturbance_energy(self, design: Design) -> float:
        """lambda^2 int w^2, m2/s3."""
        return float(design.gain**2 * np.trapezoid(self.disturbance**2, self.t))

    def over_bound(self, design: Design) -> float:
        """Error energy over what the theorem allows: lambda^2 int w^2 + epsilon + z(0)' P z(0)."""
        allowed = self.disturbance_energy(design) + design.energy + self.state_energy[0]
        return self.error_energy / float(allowed)

    def settled_error(self) -> float:
        """Largest drag error of the last 5 s, m/s2."""
        return float(np.max(np.abs(self.error[self.t > self.t[-1] - 5.0])))


@dataclass(frozen=True)
class Adapted(Response):
    """A response with the estimates of theta, shape (rows, 5)."""

    theta: np.ndarray

    def storage(self, design: Design, theta: np.ndarray) -> np.ndarray:
        """W = z' P z + (p - theta)' Q (p - theta) of each row, which without disturbance must not rise."""
        width = design.high - design.low
        off = (self.theta - theta) / width
        return self.state_energy + design.energy / len(width) * np.sum(off**2, axis=1)


def state_energy(design: Design, error: np.ndarray, rate: np.ndarray) -> np.ndarray:
    """z' P z of drag errors (m/s2) and their rates (m/s3)."""
    p11, p12, p22 = riccati(design.gain, design.weight)
    return p11 * error**2 + 2.0 * p12 * error * rate + p22 * rate**2


def respond(
    design: Design,
    reference: Callable[[float], tuple[float, float, float]],
    theta: np.ndarray,
    disturbance: Callable[[float], float],
    start: tuple[float, float, float],
    duration: float,
    *,
    adaptive: bool = True,
) -> Adapted:
    """Integrate the closed loop by RK4, the estimate of theta held over each step.

    Args:
        design: the controller's settings.
        reference: drag to follow and its first two derivatives at a time.
        theta: the true parameters, shape (5,).
        disturbance: w at a time, m/s4.
        start: drag error, its rate, and speed at the start.
        duration: s.
        adaptive: whether the estimate moves.
    """
    _, p12, p22 = riccati(design.gain, design.weight)
    goal, goal_rate, _ = reference(0.0)
    state, estimate = (
        np.array([goal + start[0], goal_rate + start[1], start[2]]),
        0.5 * (design.low + design.high),
    )
    steps = round(duration / STEP_S)
    t, errors, error_rates = STEP_S * np.arange(steps + 1), np.empty(steps + 1), np.empty(steps + 1)
    estimates = np.empty((steps + 1, len(estimate)))
    for k, now in enumerate(t):
        goal, goal_rate, _ = reference(now)
        error, error_rate = state[0] - goal, state[1] - goal_rate
        errors[k], error_rates[k], estimates[k] = error, error_rate, estimate
        first, regressor = _rates(design, reference, theta, estimate, disturbance, now, state)
        half = now + 0.5 * STEP_S
        second, _ = _rates(
            design, reference, theta, estimate, disturbance, half, state + 0.5 * STEP_S * first
        )
        third, _ = _rates(
            design, reference, theta, estimate, disturbance, half, state + 0.5 * STEP_S * second
        )
        fourth, _ = _rates(
            design, reference, theta, estimate, disturbance, now + STEP_S, state + STEP_S * third
        )
        if adaptive:
            adapt(
                estimate,
                design.low,
                design.high,
                regressor,
                p12 * error + p22 * error_rate,
                design.energy,
                STEP_S,
            )
        state = state + STEP_S / 6.0 * (first + 2.0 * (second + third) + fourth)
    w = np.array([disturbance(now) for now in t])
    return Adapted(t, errors, w, state_energy(design, errors, error_rates), estimates)


def _rates(
    design: Design,
    reference: Callable[[float], tuple[float, float, float]],
    theta: np.ndarray,
    estimate: np.ndarray,
    disturbance: Callable[[float], float],
    t: float,
    state: np.ndarray,
) -> tuple[np.ndarray, tuple[float, ...]]:
    """Rates of (drag, drag rate, speed) under the control of eq. 16, and the regressor g1."""
    drag, rate, speed = state
    free, unknown, per_u = uncertain_drag(
        drag, rate, speed, design.gravity, design.radius, design.scale_height
    )
    goal, goal_rate, goal_acceleration = reference(t)
    f1, f2 = feedback(design.gain, design.weight)
    wanted = goal_acceleration + f1 * (drag - goal) + f2 * (rate - goal_rate)
    u = (wanted + free + np.dot(unknown, estimate)) / ((1.0 - estimate[3]) * per_u)
    regressor = (*unknown[:3], per_u * u, unknown[4])
    k = 1.0 + 2.0 * design.gravity * design.scale_height / speed**2
    climb = -design.scale_height / k * (rate / drag + 2.0 * drag / speed - theta[0])
    acceleration = per_u * u - free - np.dot(regressor, theta) + disturbance(t)
    return np.array([rate, acceleration, -drag - design.gravity * climb / speed]), regressor
