"""Figures of a planned entry: where it ends, the loads it meets, the authority it leaves, and how far
the open loop misses when air, lift or entry angle are not the expected ones.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, degrees, radians, sin

import numpy as np

from edl6dof.config.units import G0
from edl6dof.fsw.guidance.entry.profiles.bank_points import MAX_POINTS
from edl6dof.scenario.places import Start
from edl6dof.scenario.planned_entry import fly_shifted

#: One standard deviation of what an open-loop entry meets: density and lift-to-drag ratio over the expected
#: ones, and the entry angle (deg).  A third of the three-sigma values of tianwen1_mc [E].
DENSITY, LIFT, ANGLE_DEG = 0.2 / 3.0, 0.1 / 3.0, 0.1


@dataclass(frozen=True)
class Plan:
    """Figures of a planned entry.

    Attributes:
        points: speed (m/s) and bank angle (deg) of the profile, ascending in speed, before any shift.
        altitude_m: above the ellipsoid, where the range is to be met.
        beyond_m: beyond the aim point there.
        aside_m: right of it.
        load_g0: largest aerodynamic load.
        heat_rate_w_cm2: largest stagnation-point heat rate.
        dynamic_pressure_pa: largest dynamic pressure.
        reserve_deg: from the bank angles flown in range control to the nearer bank limit, the least.
        bank_slope_deg_s: fastest change of the profile itself.
        misses_m: downrange miss of the open loop by one sigma of density, lift-to-drag ratio, entry angle.
    """

    points: tuple[tuple[float, float], ...]
    altitude_m: float
    beyond_m: float
    aside_m: float
    load_g0: float
    heat_rate_w_cm2: float
    dynamic_pressure_pa: float
    reserve_deg: float
    bank_slope_deg_s: float
    misses_m: tuple[float, ...]

    @property
    def dispersion_m(self) -> float:
        """One sigma of the downrange miss without guidance."""
        return float(np.linalg.norm(self.misses_m))


def with_points(onboard: np.ndarray, points: Sequence[tuple[float, float]]) -> np.ndarray:
    """A copy of an onboard record whose reference is the profile of ``points`` (m/s, deg), not shifted."""
    if not 1 <= len(points) <= MAX_POINTS:
        raise ValueError(f"a profile has 1 to {MAX_POINTS} points (got {len(points)})")
    copy = onboard.copy()
    profile = copy[0]["guidance"]["entry"]["reference_bank"]
    profile["n_points"] = len(points)
    for slot, (speed, bank) in zip(profile["points"], points, strict=False):
        slot["at"], slot["bank"] = speed, radians(bank)
    return copy


def own_points(record: np.void, lowest: float, highest: float) -> list[tuple[float, float]]:
    """The profile (m/s, deg) of an onboard record, not shifted, between two speeds."""
    profile = record["guidance"]["entry"]["reference_bank"]
    points = profile["points"][: int(profile["n_points"])]
    speeds = np.unique(np.clip(points["at"], lowest, highest))
    banks = np.degrees(np.interp(speeds, points["at"], points["bank"]))
    return list(zip(speeds.tolist(), banks.tolist(), strict=True))


def figures(
    onboard: np.ndarray, start: Start, points: Sequence[tuple[float, float]], shift: float = 0.0
) -> Plan:
    """Fly a profile as the plan is flown, and once more for each of the three errors."""
    own = with_points(onboard, points)
    rows = fly_shifted(own[0], start, shift)
    end = rows[-1]
    return Plan(
        points=tuple((float(speed), float(bank)) for speed, bank in points),
        altitude_m=float(end["altitude"]),
        beyond_m=float(end["beyond"]),
        aside_m=float(end["aside"]),
        load_g0=float(rows["load"].max()) / G0,
        heat_rate_w_cm2=_heat_rate(own[0], rows) / 1e4,
        dynamic_pressure_pa=float(rows["dynamic_pressure"].max()),
        reserve_deg=_reserve(own[0], points, shift),
        bank_slope_deg_s=_slope(points, shift, rows),
        misses_m=tuple(float(r["beyond"][-1] - end["beyond"]) for r in _off_nominal(own, start, shift)),
    )


def _off_nominal(onboard: np.ndarray, start: Start, shift: float) -> list[np.ndarray]:
    """Flights in denser air, with more lift, and at a steeper angle, each by one sigma."""
    denser, lifting = onboard.copy(), onboard.copy()
    denser[0]["atmosphere"]["ln_density"] += np.log1p(DENSITY)
    lifting[0]["vehicle"]["lift_to_drag"] *= 1.0 + LIFT
    flights = [(denser, start), (lifting, start), (onboard, _steeper(start))]
    return [fly_shifted(record[0], begin, shift) for record, begin in flights]


def _steeper(start: Start) -> Start:
    """The initial state with its velocity turned downwards by one sigma."""
    r, v = np.array(start[:3]), np.array(start[3:])
    across = np.cross(r, v)
    across /= np.linalg.norm(across)
    angle = radians(ANGLE_DEG)
    x, y, z = v * cos(angle) + np.cross(across, v) * sin(angle)
    return start[0], start[1], start[2], float(x), float(y), float(z)


def _heat_rate(record: np.void, rows: np.ndarray) -> float:
    """Largest stagnation-point heat rate (W/m2, Sutton & Graves 1971)."""
    nose = float(record["guidance"]["entry"]["limits"]["nose_radius"])
    airspeed = np.sqrt(2.0 * rows["dynamic_pressure"] / rows["density"])
    constant = float(record["planet"]["sutton_graves_constant"])
    return float(np.max(constant * np.sqrt(rows["density"] / nose) * airspeed**3))


def _reserve(record: np.void, points: Sequence[tuple[float, float]], shift: float) -> float:
    """Least distance (deg) of the shifted bank angles of the points from the limits; negative beyond them."""
    entry = record["guidance"]["entry"]
    banks = _shifted(np.array([bank for _, bank in points]), shift)
    low, high = degrees(entry["bank_min"]), degrees(entry["bank_max"])
    return float(min(np.min(banks) - low, high - np.max(banks)))


def _slope(points: Sequence[tuple[float, float]], shift: float, rows: np.ndarray) -> float:
    """Fastest change (deg/s) of the shifted profile along the flight."""
    speeds, banks = np.array(points).T
    along = _shifted(np.interp(rows["speed"], speeds, banks), shift)
    return float(np.max(np.abs(np.gradient(along, rows["t"]))))


def _shifted(banks: np.ndarray, shift: float) -> np.ndarray:
    """Bank angles (deg) with ``shift`` added to their cosine."""
    return np.degrees(np.arccos(np.clip(np.cos(np.radians(banks)) + shift, -1.0, 1.0)))
