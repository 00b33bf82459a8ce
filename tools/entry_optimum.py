"""Reach of any entry law: the entry with the highest parachute, or the nearest to the aim point, by
a sequence of conic programs.

The control is the lift vector across the flow, up and to the right, in units of the lift; it is linear in
speed between knots.  Its length is at most one, its upward part at least the cosine of the largest bank
angle: a convex set.  A real lift vector has length one; a shorter one is the mean of quick reversals.  Bank
rate, smallest bank angle and heading alignment are left out, so the optimum bounds every law from above.  The
motion is that of the on-board prediction; below the speed of level wings the lift is up.

Each program maximises the linearised altitude at the parachute less a price of the miss, in a trust region.
The price is high enough to make the miss zero wherever the aim point is in reach; elsewhere the sequence is
repeated with the miss as its only goal.  Sources: Liu, Shen & Lu 2015, "Entry trajectory optimization by
second-order cone programming", J. Guidance 39(2) (relaxed lift vector); Benito & Mease 2010, "Reachable and
controllable sets for planetary entry and landing", J. Guidance 33(3) (bank angle as the only limit).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from edl6dof.fsw.guidance.entry.predictor import (
    AS_BELIEVED,
    LONGEST_STEP,
    LOWEST,
    MAX_STEPS,
    SHORTEST_STEP,
    SPEED_STEP,
    acceleration,
    aim_direction,
    height_above_ellipsoid,
    step,
)
from edl6dof.kernels import kernel
from edl6dof.spatial.elementary import asin, atan2
from edl6dof.spatial.table_index import between, held_cell
from edl6dof.spatial.vector import clamp, cross, dot, norm, scale, sub, take3, unit

#: Knots of the lift vector.
KNOTS = 10
#: Change of a component by which slopes are measured.
NUDGE = 0.02
#: Trust region of a component, first and last, and most programs.
FIRST_STEP, LAST_STEP, PROGRAMS = 0.5, 0.004, 40
#: Price of a metre of miss in metres of altitude, and the miss (m) up to which the aim point is met.
PRICE, MET = 10.0, 50.0


@dataclass(frozen=True)
class Reach:
    """The best end of an entry."""

    lifts: np.ndarray  # lift vector at the knots, up and right, shape (KNOTS, 2), ascending in speed
    beyond_m: float  # distance of the end beyond the aim point
    aside_m: float  # distance of the end right of the course to the aim point
    altitude_m: float  # height above the ellipsoid at the end

    @property
    def miss_m(self) -> float:
        """Distance of the end from the aim point."""
        return float(np.hypot(self.beyond_m, self.aside_m))


@kernel
def from_aim(onboard, here, there):
    """Distances (m) of ``there`` beyond the aim point and right of the course to it from ``here``; both unit
    vectors (F).
    """
    target, radius = aim_direction(onboard), onboard.planet.equatorial_radius
    ahead = unit(sub(target, scale(dot(target, here), here)))
    beyond = atan2(dot(there, ahead), dot(there, here)) - atan2(dot(target, ahead), dot(target, here))
    return radius * beyond, radius * asin(clamp(dot(there, cross(ahead, here)), -1.0, 1.0))


@kernel
def fly_lift(onboard, start, lowest, lifts, end):
    """Fly from ``start`` (position in m and planet-relative velocity in m/s, F, shape (6,)) with the lift
    vector ``lifts`` (shape (knots, 2)), whose knots are evenly spaced in speed from ``lowest`` to that of the
    start.

    Writes into ``end`` the distance beyond the aim point and right of the course to it (m), and the altitude
    (m) at the final speed or Mach number.
    """
    planet, entry = onboard.planet, onboard.guidance.entry
    r, v = take3(start, 0), take3(start, 3)
    here = unit(r)
    spacing = (norm(v) - lowest) / (lifts.shape[0] - 1)
    r_old, excess, excess_old = r, 0.0, 0.0
    for _ in range(MAX_STEPS):
        speed = norm(v)
        i, f = held_cell((speed - lowest) / spacing, lifts.shape[0] - 1)
        lift = (between(lifts[:, 0], i, f), between(lifts[:, 1], i, f))
        if speed <= entry.align_speed:
            lift = (1.0, 0.0)
        a, drag, mach = acceleration(onboard, AS_BELIEVED, r, v, lift)
        final = entry.final_mach * speed / max(mach, 1e-3) if entry.final_mach > 0.0 else entry.final_speed
        excess = speed - final
        if excess <= 0.0 or height_above_ellipsoid(planet, r) < LOWEST:
            break
        dt = clamp(SPEED_STEP / max(drag, 1e-3), SHORTEST_STEP, LONGEST_STEP)
        r_old, excess_old = r, excess
        r, v = step(onboard, AS_BELIEVED, r, v, a, lift_shares=lift, dt=dt)
    if excess < 0.0 < excess_old:
        back = excess / (excess - excess_old)
        r = (
            r[0] + back * (r_old[0] - r[0]),
            r[1] + back * (r_old[1] - r[1]),
            r[2] + back * (r_old[2] - r[2]),
        )
    end[0], end[1] = from_aim(onboard, here, unit(r))
    end[2] = height_above_ellipsoid(planet, r)


class Entry:
    """An entry from ``start`` (shape (6,), F) in the air, wind and airframe of the record ``onboard``."""

    def __init__(self, onboard: np.void, start: np.ndarray) -> None:
        self.onboard, self.start = onboard, np.ascontiguousarray(start, dtype=float)
        entry = onboard["guidance"]["entry"]
        self.lowest = max(float(entry["align_speed"]), float(entry["final_speed"]))
        self.least_up = float(np.cos(entry["bank_max"]))

    def ends(self, lifts: np.ndarray) -> np.ndarray:
        """Distances beyond and right of the aim point, and altitude (m), shape (3,)."""
        end = np.zeros(3)
        fly_lift(self.onboard, self.start, self.lowest, np.ascontiguousarray(lifts), end)
        return end

    def slopes(self, lifts: np.ndarray) -> np.ndarray:
        """Derivatives of the end by the lift vector, central differences, shape (3, 2 knots)."""
        nudges = NUDGE * np.eye(lifts.size).reshape(lifts.size, *lifts.shape)
        return np.array([(self.ends(lifts + e) - self.ends(lifts - e)) / (2.0 * NUDGE) for e in nudges]).T


class _Program:
    """The conic program about a lift vector, set up once."""

    def __init__(self, least_up: float, price: float, worth: float) -> None:
        import cvxpy as cp  # the optional extra "design"

        self.new, self.old = cp.Variable((KNOTS, 2)), cp.Parameter((KNOTS, 2))
        self.slopes, self.rest = cp.Parameter((3, 2 * KNOTS)), cp.Parameter(3)
        self.step = cp.Parameter(nonneg=True)
        #: kilometres, linear in the new lift vector
        end = self.slopes @ cp.vec(self.new, order="C") + self.rest
        limits = [
            cp.norm(self.new, axis=1) <= 1.0,
            self.new[:, 0] >= least_up,
            cp.abs(self.new - self.old) <= self.step,
        ]
        self._problem = cp.Problem(cp.Minimize(price * cp.norm(end[:2]) - worth * end[2]), limits)

    def solve(self, lifts: np.ndarray, end: np.ndarray, slopes: np.ndarray, step: float) -> np.ndarray:
        """The best lift vector near ``lifts``, whose flight has this ``end`` (m) and these ``slopes``."""
        self.old.value, self.slopes.value, self.step.value = lifts, slopes / 1e3, step
        self.rest.value = (end - slopes @ lifts.ravel()) / 1e3
        self._problem.solve(solver="CLARABEL")
        found: Any = self.new.value
        return np.asarray(found)


def best(onboard: np.void, start: np.ndarray) -> Reach:
    """The highest end at the aim point, or the nearest end to it where it is out of reach.

    Args:
        onboard: ``ONBOARD`` record that holds the air, wind, airframe and aim point.
        start: position (m) and planet-relative velocity (m/s) in F, shape (6,).
    """
    entry = Entry(onboard, start)
    lifts, end = _improved(entry, _even(0.0), PRICE, 1.0)
    if np.hypot(*end[:2]) > MET:
        # without lift to a side the end has no slope by its size: begin with lift to either side too
        found = [_improved(entry, first, PRICE, 0.0) for first in (lifts, _even(0.5), _even(-0.5))]
        lifts, end = min(found, key=lambda one: float(np.hypot(*one[1][:2])))
    return Reach(lifts, *(float(value) for value in end))


def _even(right: float) -> np.ndarray:
    """A first lift vector: half the lift up, and a share of it to the right, at all knots."""
    return np.tile([0.5, right], (KNOTS, 1))


def _improved(entry: Entry, lifts: np.ndarray, price: float, worth: float) -> tuple[np.ndarray, np.ndarray]:
    """Solve programs about ``lifts`` until none improves the flight; return the lift vector and its end."""
    program = _Program(entry.least_up, price, worth)

    def cost(end: np.ndarray) -> float:
        return float(price * np.hypot(*end[:2]) - worth * end[2])

    end, slopes, size = entry.ends(lifts), entry.slopes(lifts), FIRST_STEP
    for _ in range(PROGRAMS):
        if size < LAST_STEP:
            break
        candidate = program.solve(lifts, end, slopes, size)
        there = entry.ends(candidate)
        if cost(there) < cost(end) - 0.1:
            lifts, end, slopes = candidate, there, entry.slopes(candidate)
            size = min(1.5 * size, FIRST_STEP)
        else:
            size *= 0.5
    return lifts, end
