"""The bank profile of an entry by direct shooting: bank angles at a few speeds that make the most of the
parachute altitude, or the least of the open loop's dispersion, and keep to the limits.

Every profile is flown as the plan is flown, by the flight's own mission and steering with reversals at the
bank rate, so that what is optimised is what is planned.  Linear programs in a trust region, with slopes over
a few degrees: reversals come at whole guidance cycles and their number changes, which leaves tens of metres
of noise that quadratic models do not survive.
Source: direct shooting, Betts 1998, "Survey of numerical methods for trajectory optimization", JGCD 21(2);
successive linear programming with an exact penalty, Fletcher & Sainz de la Maza 1989, Mathematical
Programming 43.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import degrees
from typing import Literal

import numpy as np
from scipy.optimize import linprog

from edl6dof.config.units import G0
from edl6dof.design.entry_plan import Plan, figures, own_points
from edl6dof.fsw.guidance.entry.prediction.reference import reference_bank
from edl6dof.scenario.places import start_of
from edl6dof.scenario.planned_entry import planned_again
from edl6dof.scenario.records import build_onboard
from edl6dof.scenario.schema import Scenario

Goal = Literal["parachute_altitude", "dispersion"]

#: Bank angle by which a slope is measured either way, and the trust region: first and last, deg.
NUDGE_DEG, FIRST_STEP_DEG, LAST_STEP_DEG = 3.0, 12.0, 0.5
#: Linear programs at most.
PROGRAMS = 25
#: Scales of altitude and miss, m, and what a broken limit costs: a scale of it, this many of the objective.
ALTITUDE_SCALE, MISS_SCALE, PENALTY = 1e3, 1e4, 20.0
#: Share of the bank rate that the profile itself may use; the rest is for control.
SHARE_OF_RATE = 0.25
#: Range (m) that the profile may leave to the shift that fits it, and crossrange that it may end with.
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
        """Margin to each limit, as a share of it; below zero where it is broken."""
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
    """The plan of the scenario, the designed one, and the limits.

    Attributes:
        before: the plan of the scenario.
        planned_deg: its bank angles at the speeds of the designed one.
        after: the designed plan.
        limits: what it keeps to.
        profiles: how many were flown.
    """

    before: Plan
    planned_deg: tuple[float, ...]
    after: Plan
    limits: Limits
    profiles: int

    @property
    def broken(self) -> list[str]:
        """Limits that the designed plan breaks, and the aim point if it is missed."""
        missed = ["aim point"] if abs(self.after.beyond_m) > CLOSE else []
        return [name for name, left in self.limits.slack(self.after).items() if left < -1e-3] + missed


def design_entry(scenario: Scenario, goal: Goal, nodes: int, reserve_deg: float) -> Design:
    """Design the bank profile of a scenario.

    Args:
        scenario: with a phase that flies entry guidance.
        goal: what is made the most, or the least, of.
        nodes: speeds at which the bank angle is free.
        reserve_deg: how far from the bank limits all of them stay.
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
    """Bank angles (deg), from ``first`` on, that no linear program improves any more."""

    def terms(banks: np.ndarray) -> np.ndarray:
        """Objective, range, slacks."""
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
    """Change of the bank angles (deg) between ``low`` and ``high`` with the least linear model of the merit.

    Unknowns: the changes, the range beyond and short of the aim point, and what breaks each limit, each at
    least zero.
    """
    nodes, limits = len(low), len(here) - 2
    costs = np.concatenate([slopes[0], np.full(2 + limits, PENALTY)])
    ranged = np.concatenate([slopes[1], [-1.0, 1.0], np.zeros(limits)])
    kept = np.hstack([-slopes[2:], np.zeros((limits, 2)), -np.eye(limits)])
    spans = [*zip(low, high, strict=True), *([(0.0, None)] * (2 + limits))]
    found = linprog(costs, A_ub=kept, b_ub=here[2:], A_eq=ranged[None], b_eq=[-here[1]], bounds=spans)
    return found.x[:nodes]
