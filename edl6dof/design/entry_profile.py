"""The bank profile of an entry by direct shooting: bank angles at a few speeds that maximise the parachute
altitude, or minimise the dispersion of the open loop, within the limits.

Every profile is flown as the plan is flown, by the flight's own mission and steering with reversals at the
bank rate.  The optimisation solves linear programs in a trust region, with slopes over a few degrees:
reversals come at whole guidance cycles and their number changes, which leaves tens of metres of noise, too
much for quadratic models.  Source: direct shooting, Betts 1998, "Survey of numerical methods for trajectory
optimization", JGCD 21(2); successive linear programming with an exact penalty, Fletcher & Sainz de la Maza
1989, Mathematical Programming 43.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import cos, degrees, radians, sin
from typing import Literal

import numpy as np
from scipy.optimize import linprog

from edl6dof.config.units import G0
from edl6dof.fsw.guidance.entry.reference import MAX_POINTS, reference_bank
from edl6dof.scenario.planned_entry import fly_shifted, planned_again
from edl6dof.scenario.records import build_onboard
from edl6dof.scenario.schema import Scenario, Start, start_of

#: One standard deviation of the errors of an open-loop entry: density and lift-to-drag ratio over the
#: expected ones, and the entry angle (deg).  A third of the three-sigma values of tianwen1_mc [E].
DENSITY, LIFT, ANGLE_DEG = 0.2 / 3.0, 0.1 / 3.0, 0.1


@dataclass(frozen=True)
class Plan:
    """Figures of a planned entry."""

    #: speed (m/s) and bank angle (deg) of the profile, ascending in speed, before any shift
    points: tuple[tuple[float, float], ...]
    altitude_m: float  # altitude above the ellipsoid at the final speed or Mach number, where the plan ends
    beyond_m: float  # distance of the end beyond the aim point
    aside_m: float  # distance of the end right of the aim point
    load_g0: float  # largest aerodynamic load
    heat_rate_w_cm2: float  # largest stagnation-point heat rate
    dynamic_pressure_pa: float  # largest dynamic pressure
    reserve_deg: float  # least distance of the bank angles in range control from the bank limits
    bank_slope_deg_s: float  # fastest change of the profile itself
    #: downrange miss of the open loop by one sigma of density, lift-to-drag ratio, entry angle
    misses_m: tuple[float, ...]

    @property
    def dispersion_m(self) -> float:
        """One sigma of the downrange miss without guidance."""
        return float(np.linalg.norm(self.misses_m))


def with_points(onboard: np.ndarray, points: Sequence[tuple[float, float]]) -> np.ndarray:
    """A copy of an onboard record with the profile of ``points`` (m/s, deg) as reference, without a shift."""
    if not 1 <= len(points) <= MAX_POINTS:
        raise ValueError(f"a profile has 1 to {MAX_POINTS} points (got {len(points)})")
    copy = onboard.copy()
    profile = copy[0]["guidance"]["entry"]["reference_bank"]
    profile["n_points"] = len(points)
    for slot, (speed, bank) in zip(profile["points"], points, strict=False):
        slot["at"], slot["bank"] = speed, radians(bank)
    return copy


def own_points(record: np.void, lowest: float, highest: float) -> list[tuple[float, float]]:
    """Points (m/s, deg) of the profile of an onboard record between two speeds (m/s), without the shift."""
    profile = record["guidance"]["entry"]["reference_bank"]
    points = profile["points"][: int(profile["n_points"])]
    speeds = np.unique(np.clip(points["at"], lowest, highest))
    banks = np.degrees(np.interp(speeds, points["at"], points["bank"]))
    return list(zip(speeds.tolist(), banks.tolist(), strict=True))


def figures(
    onboard: np.ndarray, start: Start, points: Sequence[tuple[float, float]], shift: float = 0.0
) -> Plan:
    """Integrate a bank profile without errors and once with each error (density, lift-to-drag ratio, entry
    angle); return the figures of the plan.  ``shift``: change of the cosine of the bank angle.
    """
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
    """Least distance (deg) of the shifted bank angles of the points from the limits; negative outside."""
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


Goal = Literal["parachute_altitude", "dispersion"]

#: Bank angle by which a slope is measured either way, and the trust region: first and last, deg.
NUDGE_DEG, FIRST_STEP_DEG, LAST_STEP_DEG = 3.0, 12.0, 0.5
#: Largest number of linear programs.
PROGRAMS = 25
#: Scales of altitude and miss, m, and penalty of a limit that is exceeded by its own size.
ALTITUDE_SCALE, MISS_SCALE, PENALTY = 1e3, 1e4, 20.0
#: Share of the bank rate that the profile itself may use; the rest is for control.
SHARE_OF_RATE = 0.25
#: Largest range error (m) that is left to the shift that fits the profile, and largest crossrange at its end.
CLOSE, CLOSE_ASIDE = 2000.0, 1000.0


@dataclass(frozen=True)
class Limits:
    """Largest load (g0), heat rate (W/cm2) and dynamic pressure (Pa), less their margin; least distance to
    the bank limits (deg), largest slope of the profile (deg/s) and largest crossrange at its end (m).
    """

    load_g0: float
    heat_rate_w_cm2: float
    dynamic_pressure_pa: float
    reserve_deg: float
    bank_slope_deg_s: float
    aside_m: float

    def slack(self, plan: Plan) -> dict[str, float]:
        """Margin to each limit as a share of the limit; negative if the plan exceeds it."""
        return {
            "load": 1.0 - plan.load_g0 / self.load_g0,
            "heat rate": 1.0 - plan.heat_rate_w_cm2 / self.heat_rate_w_cm2,
            "dynamic pressure": 1.0 - plan.dynamic_pressure_pa / self.dynamic_pressure_pa,
            "bank slope": 1.0 - plan.bank_slope_deg_s / self.bank_slope_deg_s,
            "crossrange": 1.0 - abs(plan.aside_m) / self.aside_m,
            "reserve": (plan.reserve_deg - self.reserve_deg) / 90.0,
        }


@dataclass(frozen=True)
class Design:
    """The plan of the scenario, the designed plan, and the limits."""

    before: Plan  # the plan of the scenario
    planned_deg: tuple[float, ...]  # its bank angles at the speeds of the designed one
    after: Plan  # the designed plan
    limits: Limits  # of the designed plan
    profiles: int  # number of flown profiles

    @property
    def broken(self) -> list[str]:
        """Limits that the designed plan exceeds, and the aim point if the plan misses it."""
        missed = ["aim point"] if abs(self.after.beyond_m) > CLOSE else []
        return [name for name, left in self.limits.slack(self.after).items() if left < -1e-3] + missed


def design_entry(scenario: Scenario, goal: Goal, nodes: int, reserve_deg: float) -> Design:
    """Design the bank profile of a scenario.

    Args:
        scenario: with a phase that flies entry guidance.
        goal: maximum of the parachute altitude, or minimum of the dispersion.
        nodes: number of speeds at which the bank angle is free.
        reserve_deg: least distance of the bank angles from the bank limits.
    """
    onboard, start = build_onboard(scenario), start_of(scenario)
    record, entry = onboard[0], onboard[0]["guidance"]["entry"]
    shift, limits = float(record["reference"]["shift"]), _limits(record, reserve_deg)
    rows = planned_again(onboard, scenario)
    lowest = max(float(entry["align_speed"]), float(entry["heading"]["speed"]), float(rows["speed"][-1]))
    highest = float(rows["speed"][rows["side"] != 0.0].max())
    speeds = np.linspace(lowest, highest, nodes)
    by_hand = np.degrees([reference_bank(record, shift, speed + 1e-3) for speed in speeds])
    bounds = degrees(entry["bank_min"]) + reserve_deg, degrees(entry["bank_max"]) - reserve_deg
    count = 0

    def plan_of(banks: np.ndarray) -> Plan:
        nonlocal count
        count += 1
        return figures(onboard, start, list(zip(speeds.tolist(), banks.tolist(), strict=True)))

    before = figures(onboard, start, own_points(record, lowest, highest), shift)
    found = _optimised(plan_of, np.clip(by_hand, *bounds), bounds, goal, limits)
    return Design(before, tuple(by_hand.tolist()), plan_of(found), limits, count)


def _limits(record: np.void, reserve_deg: float) -> Limits:
    given = record["guidance"]["entry"]["limits"]
    kept = 1.0 - float(given["margin"])
    return Limits(
        load_g0=kept * float(given["load"]) / G0,
        heat_rate_w_cm2=kept * float(given["heat_rate"]) / 1e4,
        dynamic_pressure_pa=kept * float(given["dynamic_pressure"]),
        reserve_deg=reserve_deg,
        bank_slope_deg_s=SHARE_OF_RATE * degrees(record["guidance"]["entry"]["bank_rate"]),
        aside_m=CLOSE_ASIDE,
    )


def _optimised(
    plan_of: Callable[[np.ndarray], Plan],
    first: np.ndarray,
    bounds: tuple[float, float],
    goal: Goal,
    limits: Limits,
) -> np.ndarray:
    """Improve bank angles (deg), beginning with ``first``, until no linear program improves them further."""

    def terms(banks: np.ndarray) -> np.ndarray:
        """Cost, range error and margins to the limits for some bank angles (deg)."""
        plan = plan_of(banks)
        high = -plan.altitude_m / ALTITUDE_SCALE
        cost = high if goal == "parachute_altitude" else plan.dispersion_m / MISS_SCALE
        slack = [left for name, left in limits.slack(plan).items() if name != "reserve"]  # bounds keep it
        return np.array([cost, plan.beyond_m / MISS_SCALE, *slack])

    def merit(t: np.ndarray) -> float:
        return float(t[0] + PENALTY * (abs(t[1]) - np.minimum(t[2:], 0.0).sum()))

    banks, here, step = first, terms(first), FIRST_STEP_DEG
    slopes = _slopes(terms, banks)
    for _ in range(PROGRAMS):
        if step < LAST_STEP_DEG:
            break
        low, high = np.maximum(bounds[0] - banks, -step), np.minimum(bounds[1] - banks, step)
        candidate = banks + _program(here, slopes, low, high)
        there = terms(candidate)
        # back to the range, which bends more than all else: all bank angles alike, by what is missed
        candidate = np.clip(candidate - there[1] / slopes[1].sum(), *bounds)
        there = terms(candidate)
        if merit(there) < merit(here) - 1e-6:
            banks, here, step = candidate, there, 1.5 * step
            slopes = _slopes(terms, banks)
        else:
            step *= 0.5
    return banks


def _slopes(terms: Callable[[np.ndarray], np.ndarray], banks: np.ndarray) -> np.ndarray:
    """Central differences of the terms by the bank angles, shape (terms, nodes), 1/deg."""
    nudges = NUDGE_DEG * np.eye(len(banks))
    return np.array([(terms(banks + e) - terms(banks - e)) / (2.0 * NUDGE_DEG) for e in nudges]).T


def _program(here: np.ndarray, slopes: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Change of bank angles (deg) between ``low`` and ``high`` that minimises the linear model of the merit.

    Unknowns: the changes, the range beyond and short of the aim point, and the excess of each limit, each at
    least zero.
    """
    nodes, limits = len(low), len(here) - 2
    costs = np.concatenate([slopes[0], np.full(2 + limits, PENALTY)])
    ranged = np.concatenate([slopes[1], [-1.0, 1.0], np.zeros(limits)])
    kept = np.hstack([-slopes[2:], np.zeros((limits, 2)), -np.eye(limits)])
    spans = [*zip(low, high, strict=True), *([(0.0, None)] * (2 + limits))]
    found = linprog(costs, A_ub=kept, b_ub=here[2:], A_eq=ranged[None], b_eq=[-here[1]], bounds=spans)
    return found.x[:nodes]
