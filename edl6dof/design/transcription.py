"""A flight by nodes: states and controls at the ends of intervals, controls linear between them (first-order
hold), and what the end of each interval is by its beginning.

The intervals of the start at full level have one length, those of the throttle band another; both are free.
Source: Szmuk, Reynolds, Acikmese 2020, "Successive convexification for real-time six-degree-of-freedom
powered descent guidance with state-triggered constraints", J. Guidance 43(8), section III: the
variational equations.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from edl6dof.design.rigid_landing import CONTROLS, STATES, THRUST, RigidLanding, derivatives, motion

#: Runge-Kutta steps of an interval.
STEPS = 8
#: Steps after which limits are looked at; the last is the end.
CHECKED = (2, 4, 6, 8)


@dataclass(frozen=True)
class Nodes:
    """A flight by its nodes.

    Attributes:
        x: states, shape (n + 1, 14).
        u: controls, shape (n + 1, 4); the thrust of a node where two parts meet is that of the second.
        durations: of the part at full level, if any, and of that in the throttle band, s.
        full: intervals of the part at full level.
    """

    x: np.ndarray
    u: np.ndarray
    durations: np.ndarray
    full: int

    @property
    def parts(self) -> np.ndarray:
        """Index of the duration that each interval belongs to, shape (n,)."""
        return ((np.arange(len(self.x) - 1) >= self.full) & (self.full > 0)).astype(int)

    @property
    def shares(self) -> np.ndarray:
        """Length of each interval over its part's, shape (n,)."""
        return 1.0 / np.bincount(self.parts)[self.parts]

    @property
    def lengths(self) -> np.ndarray:
        """Of the intervals, s, shape (n,)."""
        return self.durations[self.parts] * self.shares

    @property
    def times(self) -> np.ndarray:
        """Of the nodes, s, shape (n + 1,)."""
        return np.append(0.0, np.cumsum(self.lengths))

    def ends(self, landing: RigidLanding) -> tuple[np.ndarray, np.ndarray]:
        """Controls where each interval begins and ends, shape (n, 4)."""
        first, last = self.u[:-1].copy(), self.u[1:].copy()
        first[: self.full, THRUST] = last[: self.full, THRUST] = landing.full_thrust
        return first, last


@dataclass(frozen=True)
class Linear:
    """States at ``CHECKED`` points of the intervals, the last of them the end, and their derivatives.

    Attributes:
        x: shape (points, n, 14).
        by: shape (points, n, 14, 23): by the state at the beginning (14), the controls there (4) and at the
            end (4), and the duration of the part.
    """

    x: np.ndarray
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
    """Fly the controls from the start by scipy's DOP853: times (s), states and controls, ``samples`` of each
    interval and the end.
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
