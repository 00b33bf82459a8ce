"""Every entry law on the same seven entries: with one condition changed at a time, and on four of them with
everything dispersed.

This is an experiment of this simulator and of no paper: all laws fly each vehicle with one plant, one
attitude controller, one reversal logic and the same errors, from entry interface to the mortar.  The miss is
the distance at mortar fire from the point to which entry guidance steers.  Two missions fly in six degrees of
freedom with instruments, each with two kinds of parachute trigger.  The point masses of three papers get what
a vehicle has: a limited bank rate, and a drag reference that is updated by the range to go.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import product
from math import cos, degrees, inf, isfinite, nan, radians, sin
from typing import Any, NamedTuple

import numpy as np

import edl6dof
from edl6dof import Case, LoadedScenario, fly_rows
from edl6dof.campaign.design.plan import load_plan
from edl6dof.campaign.executor import Row
from edl6dof.campaign.statistics import percent
from edl6dof.config.model_paths import value_at
from edl6dof.config.wording import counted
from edl6dof.fsw.functions import chosen
from edl6dof.fsw.guidance.entry.reference import reference_bank
from edl6dof.fsw.guidance.entry.registry import ENTRY_LAWS, ENTRY_MEMORY, entry_guidance
from edl6dof.fsw.guidance.guidance_command import GUIDE
from edl6dof.fsw.navigation.derived import NAV
from edl6dof.interface.roles import LIFT
from edl6dof.kernels import kernel
from edl6dof.scenario.records import build_records
from edl6dof.scenario.schema import Scenario
from edl6dof.sensors.ground_tracking import GroundTrackingParams
from edl6dof.sim.flight import Flight
from edl6dof.sim.flight_state import snapshots_at
from edl6dof.studies.frame import Finding, Grid, Line, Panel, Report, Session, Study
from edl6dof.studies.samples import (
    column,
    distribution,
    kinds,
    mean,
    percentage,
    pick,
    quantile_grid,
    quickest_us,
    with_quantile,
)

ENTRY, SEED = "flight_software.guidance.entry", 2021
#: All laws but constant bank, which is no guidance.
LAWS = tuple(name for name in ENTRY_LAWS.names if name != "constant_bank")
#: Dispersed flights for each flight of a condition.
_PER_CONDITION = 20
#: Targets of this study: share of the best law's misses that must be within a distance (km), time of a call
#: (us) of a law that predicts by flying ahead, and of any other.
TARGET_SHARE, TARGET_KM, PREDICTOR_CALL_US, CALL_US = 0.99, 2.5, 2000.0, 5.0
PREDICTORS = ("npc", "fnpeg")
REMARKS = (
    "The bounds are this project's own targets; the box is the scenario's limits on Mach, dynamic pressure "
    "and total angle of attack.",
    "Laws without a reference drag have no drag error; 'lim.' is the time with the bank magnitude at its "
    "least or largest value.",
    "bank_profile flies the planned bank open loop: what the conditions do without guidance.",
)
Values = dict[str, Any]
#: Time (us) of a call by vehicle and law.
Calls = dict[tuple[str, str], float]


def run(session: Session) -> Report:
    """Fly dispersed entries and conditions by all laws; fly entries that all laws missed with lift up."""
    flights, rows = session.flights, []
    calls: Calls = {}
    each = [len(cases(vehicle, vehicle.load().scenario, "", flights)) for vehicle in VEHICLES]
    session.total = sum(each) * len(session.parts)
    for vehicle in VEHICLES:
        for law in session.parts:
            loaded = with_law(vehicle, law)
            rows += session.fly(loaded, cases(vehicle, loaded.scenario, law, flights), of_flight)
            calls[vehicle.name, law] = call_time(loaded)
    far = [row for vehicle in VEHICLES if vehicle.dispersions for row in lift_up(vehicle, rows, flights)]
    beyond = {vehicle.name: out_of_reach(pick(far, vehicle=vehicle.name)) for vehicle in VEHICLES}
    found, grids = list(findings(rows, calls, beyond)), list(_grids(rows, calls))
    pictures = _pictures(pick(rows, condition=DISPERSED))
    return Report(found, [*rows, *far], session.total + len(far), grids, REMARKS, pictures)


# ---- vehicles and laws ---------------------------------------------------------------------------------


class Vehicle(NamedTuple):
    """An entry: its scenario, added ``--set`` texts, and the campaign of its dispersions, if any."""

    name: str
    changes: tuple[str, ...] = ()
    dispersions: str = ""

    def load(self, *more: str) -> LoadedScenario:
        """Return the scenario of the vehicle with its changes and ``more`` overrides (``PATH=VALUE``); the
        flight ends at mortar fire.
        """
        return edl6dof.load(self.name, ["mission.goal=deployment", *self.changes, *more])


#: Changes with which the point mass of a paper flies like a vehicle.
_AS_A_VEHICLE = (
    "point_mass.bank_response=rate_limited",
    "point_mass.bank_rate_deg_s=20",
    f"{ENTRY}.bank_rate_deg_s=20",
    f"{ENTRY}.tracking.update=true",
)
VEHICLES = (
    *(Vehicle(name, dispersions="tianwen1_mc") for name in ("tianwen1", "tianwen1_range_trigger")),
    *(Vehicle(name, dispersions="msl_mc") for name in ("msl", "msl_range_trigger")),
    *(Vehicle(name, _AS_A_VEHICLE) for name in ("zheng2015", "wu2013", "yan2016")),
)


def with_law(vehicle: Vehicle, law: str) -> LoadedScenario:
    """The entry flown by a law; the open-loop law flies the planned bank angle as a function of speed."""
    planned = vehicle.load(f"{ENTRY}.reference_bank.fit_range=true")
    onboard, entry = build_records(planned).onboard[0], planned.scenario.flight_software.guidance.entry
    speeds = np.linspace(entry.align_speed_m_s + 1.0, planned.scenario.initial.speed, 16)
    shift = float(onboard["reference"]["shift"])
    banks = [degrees(reference_bank(onboard, shift, v)) for v in speeds]
    points = [{"at": round(float(v), 3), "bank_deg": bank} for v, bank in zip(speeds, banks, strict=True)]
    own = [f"{ENTRY}.law={law}", f"{ENTRY}.bank_profile={json.dumps({'points': points})}"]
    if law == "fnpeg":  # it plans its reversals itself
        own.append(f"{ENTRY}.reversal.logic=own_sign")
    return vehicle.load("simulation.log_every=5", *own)


# ---- conditions ----------------------------------------------------------------------------------------

#: Changes of every flight; each flight has its own waves of density, gusts and instrument errors.
WAVES_AND_GUSTS: Values = {"atmosphere.perturbation.enabled": True, "wind.gust.enabled": True}
_ANGLE = "initial.flight_path_angle_deg"
_SLOW_DEG_S, _WIND_M_S = 5.0, 60.0
#: Error of the state that the ground sends up, over the believed error.
_WORSE_TRACKING = 3.0


def _is_rigid(scenario: Scenario) -> bool:
    return scenario.dynamics == "six_dof"


def _less_lift(scenario: Scenario, flight: int) -> Values:
    """A lift-to-drag ratio a fifth lower; for a capsule, a centre of mass with an offset a third smaller."""
    path, factor = "vehicle.aero.lift_drag.lift_to_drag", 0.8
    if _is_rigid(scenario):
        path, factor = "vehicle.mass.entry_centre_m.2", 2.0 / 3.0
    return {path: factor * value_at(scenario, path)}


def wind(scenario: Scenario, flight: int) -> Values:
    """The same wind at all altitudes: from behind, from the right, from ahead and from the left, in turn."""
    towards = radians(value_at(scenario, "initial.azimuth_deg") + 90.0 * flight)
    return {
        "wind.model": "constant",
        "wind.constant.north_m_s": _WIND_M_S * cos(towards),
        "wind.constant.east_m_s": _WIND_M_S * sin(towards),
    }


def _slow_bank(scenario: Scenario, flight: int) -> Values:
    steering = "flight_software.control.bank_to_steer.bank.rate_deg_s"
    vehicle = steering if _is_rigid(scenario) else "point_mass.bank_rate_deg_s"
    return {f"{ENTRY}.bank_rate_deg_s": _SLOW_DEG_S, vehicle: _SLOW_DEG_S}


def _poor_navigation(scenario: Scenario, flight: int) -> Values:
    """State errors three times those believed, sent by the ground; for a point mass in the whole flight."""
    rigid, draws = _is_rigid(scenario), np.random.default_rng((SEED, flight))
    tracking = scenario.sensors.ground_tracking if rigid else GroundTrackingParams()
    section = "sensors.ground_tracking" if rigid else "sensors.navigation_error"
    return {
        f"{section}.{name}.{axis}": _WORSE_TRACKING
        * getattr(tracking, name)[axis]
        * (1.0 if rigid else draws.standard_normal())
        for axis in range(3)
        for name in ("position_m", "velocity_m_s")
    }


def _navigation_with_errors(scenario: Scenario, flight: int) -> Values:
    return {} if _is_rigid(scenario) else {"sensors.carried": ["perfect", "imu", "navigation_error"]}


#: Values by dotted path, of the scenario and the number of the flight.
Change = Callable[[Scenario, int], Values]


class Condition(NamedTuple):
    """A condition that is not as planned, named as in the table: changes that the flight computer does not
    know (``truth``) and those that it knows (``belief``).
    """

    name: str
    truth: Change = lambda scenario, flight: {}
    belief: Change = lambda scenario, flight: {}

    def case(self, index: int, scenario: Scenario, flight: int, label: Values) -> Case:
        """Case number ``index``: the condition's flight number ``flight``."""
        truth, label = {**WAVES_AND_GUSTS, **self.truth(scenario, flight)}, {**label, "condition": self.name}
        return Case(index, truth, self.belief(scenario, flight), flight, label)


CONDITIONS = (
    Condition("nominal"),
    Condition("density -40 %", lambda scenario, flight: {"atmosphere.density_factor": 0.6}),
    Condition("density +40 %", lambda scenario, flight: {"atmosphere.density_factor": 1.4}),
    Condition("L/D -20 %", _less_lift),
    Condition("bank 5 deg/s", belief=_slow_bank),
    Condition("entry -0.3 deg", lambda scenario, flight: {_ANGLE: value_at(scenario, _ANGLE) - 0.3}),
    Condition("entry +0.3 deg", lambda scenario, flight: {_ANGLE: value_at(scenario, _ANGLE) + 0.3}),
    Condition("wind 60 m/s", wind),
    Condition("navigation", _poor_navigation, _navigation_with_errors),
)
DISPERSED = "dispersed"


def entries(vehicle: Vehicle, flights: int) -> list[Values]:
    """True values of dispersed entries of a campaign; values that act after mortar fire change nothing."""
    if not vehicle.dispersions:
        return []
    return [dict(case.truth) for case in load_plan(vehicle.dispersions, cases=flights).cases()]


def cases(vehicle: Vehicle, scenario: Scenario, law: str, flights: int) -> list[Case]:
    """Return all cases of a law on a vehicle: ``flights`` dispersed entries, and some for each changed
    condition.
    """
    label = {"vehicle": vehicle.name, "law": law}
    some = range(max(flights // _PER_CONDITION, 1))
    planned = [
        condition.case(index, scenario, flight, label)
        for index, (condition, flight) in enumerate(product(CONDITIONS, some))
    ]
    about, truths = {**label, "condition": DISPERSED}, entries(vehicle, flights)
    dispersed = ({**truth, **WAVES_AND_GUSTS} for truth in truths)
    return planned + [
        Case(len(planned) + flight, truth, profile=flight, label=about)
        for flight, truth in enumerate(dispersed)
    ]


# ---- entries that no bank angle brings to the aim point ------------------------------------------------

#: A flight at zero bank from entry interface to the parachute flies about as far as that entry can.
_LIFT_UP = (
    f"{ENTRY}.law=constant_bank",
    f"{ENTRY}.constant_bank.bank_deg=0",
    f"{ENTRY}.bank_min_deg=0",
    f"{ENTRY}.preset_bank_deg=0",
    f"{ENTRY}.heading.speed_m_s=0",
    f"{ENTRY}.reversal.logic=own_sign",
)


def lift_up(vehicle: Vehicle, rows: Sequence[Row], flights: int) -> list[Row]:
    """Fly those of ``flights`` drawn entries that all laws missed again with lift up; return their rows."""
    best: dict[int, float] = {}
    own = pick(rows, vehicle=vehicle.name, condition=DISPERSED)
    for row, miss in zip(own, misses(own), strict=True):
        best[row["profile"]] = min(best.get(row["profile"], miss), miss)
    missed = sorted(number for number, miss in best.items() if miss > TARGET_KM)
    if not missed:
        return []
    truths = entries(vehicle, flights)
    about = {"vehicle": vehicle.name, "condition": "lift up", "law": "constant_bank"}
    planned = (
        Case(index, {**truths[number], **WAVES_AND_GUSTS}, profile=number, label=about)
        for index, number in enumerate(missed)
    )
    return list(fly_rows(vehicle.load("simulation.log_every=5", *_LIFT_UP), planned))


def out_of_reach(rows: Sequence[Row]) -> set[int]:
    """Return the numbers (``profile``) of the entries that fall short of the aim point by more than
    ``TARGET_KM`` even with lift up; ``rows``: flights of :func:`lift_up`.
    """
    return {row["profile"] for row in rows if row.get("parachute_downrange_m", 0.0) < -1e3 * TARGET_KM}


# ---- one flight ----------------------------------------------------------------------------------------


def of_flight(flight: Flight) -> dict[str, float]:
    """Control effort, saturation and tracking in lift control above the alignment speed."""
    rows, entry = flight.telemetry, flight.scenario.flight_software.guidance.entry
    lift = flight.during(LIFT)
    steered = lift & (rows["truth.speed_m_s"] > max(entry.align_speed_m_s, entry.heading_below_m_s))
    bank, dt = np.abs(rows["guide.bank_deg"][steered]), np.gradient(rows["t_s"])[steered]
    at_limit = (bank >= entry.bank_max_deg - 0.01) | (bank <= entry.bank_min_deg + 0.01)
    reference = rows["guide.reference_drag_m_s2"][steered]
    followed = reference > 0.0
    error = (rows["nav.drag_m_s2"][steered] - reference)[followed]
    return {
        "bank_travel_deg": float(np.sum(np.abs(np.diff(rows["guide.bank_deg"][lift])))),
        "saturation_s": float(np.sum(dt[at_limit])),
        "tracking_error_m_s2": float(np.sqrt(np.mean(error**2))) if followed.any() else nan,
    }


#: Flight times (s) at which calls are timed, how often each, and blocks of which the quickest counts.
TIMED_AT, REPEATS, BLOCKS = (90.0, 110.0, 130.0, 160.0, 200.0), 20, 15


@kernel
def _repeat(entry_law, bank_side, onboards, navs, memories, work, outs, repeats):
    """Call an entry law repeatedly on a few states, each time with the memory as it was at first."""
    for _ in range(repeats):
        for j in range(navs.shape[0]):
            work[0] = memories[j]
            entry_guidance(entry_law, bank_side, onboards[0], navs[j], work[0], out=outs[0])


def call_time(loaded: LoadedScenario) -> float:
    """Mean processor time (us) of a call of the compiled law, steering and air data included."""
    onboard, saved = build_records(loaded).onboard, snapshots_at(loaded, TIMED_AT)
    navs, memories = np.zeros(len(saved), NAV), np.zeros(len(saved), ENTRY_MEMORY)
    for j, state in enumerate(saved):
        navs[j], memories[j] = state.fsw["nav"][0], state.fsw["guidance"]["entry"][0]
    functions = (chosen(name, onboard[0]) for name in ("entry_law", "bank_side"))
    given = (*functions, onboard, navs, memories, np.zeros(1, ENTRY_MEMORY), np.zeros(1, GUIDE))
    return quickest_us(lambda: _repeat(*given, REPEATS), BLOCKS) / (REPEATS * len(saved))


# ---- what came out -------------------------------------------------------------------------------------


def misses(rows: Sequence[Row]) -> np.ndarray:
    """Miss at mortar fire, km; infinite without mortar fire."""
    return np.nan_to_num(column(rows, "parachute_miss_m"), nan=inf, posinf=inf) / 1e3


def best_first(rows: Sequence[Row]) -> list[str]:
    """The laws of some rows in the order of the miss that 99 % of their flights do not exceed."""
    return sorted(kinds(rows, "law"), key=lambda law: _worst_hundredth(pick(rows, law=law)))


def _worst_hundredth(rows: Sequence[Row]) -> float:
    """Smallest of the largest hundredth of the misses, km."""
    return float(np.quantile(misses(rows), 0.99, method="higher"))


def unflown(rows: Sequence[Row]) -> list[Row]:
    """Flights that ended before mortar fire; their rows have the cause."""
    return [row for row in rows if not isfinite(row.get("parachute_miss_m", nan))]


def _grids(rows: Sequence[Row], calls: Calls) -> Iterator[Grid]:
    """For each vehicle: largest miss in each condition, quantiles of dispersed entries, and cost."""
    for vehicle in kinds(rows, "vehicle"):
        flown = pick(rows, vehicle=vehicle)
        yield _conditions(vehicle, flown)
        if dispersed := pick(flown, condition=DISPERSED):
            title = f"{vehicle}: quantiles of the miss at the mortar, km, of dispersed entries"
            miss = {law: misses(pick(dispersed, law=law)) for law in best_first(dispersed)}
            yield quantile_grid(title, "law", miss)
        yield _effort(vehicle, flown, calls)


def _conditions(vehicle: str, rows: Sequence[Row]) -> Grid:
    names, laws = (*(one.name for one in CONDITIONS), DISPERSED), len(kinds(rows, "law"))
    counts = {name: len(own) // laws for name in names if (own := pick(rows, condition=name))}
    lines: list[Line] = []
    for law in best_first(rows):
        miss = [misses(pick(rows, law=law, condition=name)) for name in counts]
        lines.append((law, *(float(np.max(one, initial=0.0)) for one in miss)))
    several = f"{counted(next(iter(counts.values())), 'flight')} in each column"
    if DISPERSED in counts:
        several += f", {counts[DISPERSED]} dispersed"
    return Grid(f"{vehicle}: largest miss at the mortar, km; {several}", ("law", *counts), lines)


_HEADS = (
    "law", "in box %", "load g", "alt. mean km", "Mach", "drag RMS m/s2", "bank travel deg", "in wind deg",
    "fuel kg", "lim. s", "call us", "failed",
)  # fmt: skip


def _effort(vehicle: str, rows: Sequence[Row], calls: Calls) -> Grid:
    lines: list[Line] = []
    for law in best_first(rows):
        flown = pick(rows, law=law)
        lines.append((
            law, percentage(row["success"] for row in flown), mean(flown, "peak_load_g0"),
            mean(flown, "parachute_altitude_m") / 1e3, mean(flown, "parachute_mach"),
            mean(flown, "tracking_error_m_s2"), mean(pick(flown, condition="nominal"), "bank_travel_deg"),
            mean(pick(flown, condition="wind 60 m/s"), "bank_travel_deg"), mean(flown, "propellant_used_kg"),
            mean(flown, "saturation_s"), calls[vehicle, law], float(len(unflown(flown))),
        ))  # fmt: skip
    return Grid(f"{vehicle}: mean of {counted(len(rows) // len(lines), 'flight')}", _HEADS, lines)


def findings(rows: Sequence[Row], calls: Calls, beyond: Mapping[str, set[int]]) -> Iterator[Finding]:
    """Best laws, failed flights, times of a call; ``beyond``: entries of each vehicle out of reach."""
    dispersed = pick(rows, condition=DISPERSED)
    for vehicle in kinds(dispersed, "vehicle"):
        yield from _best_law(vehicle, pick(dispersed, vehicle=vehicle), beyond.get(vehicle, set()))
    failed = unflown(rows)
    why = f"{failed[0]['vehicle']}, {failed[0]['law']}: {failed[0]['cause']}" if failed else ""
    label = "flights that did not reach the mortar"
    yield Finding(label, "", float(len(failed)), 0.0, "<=", why=why)
    first = rows[0]["vehicle"]  # others may fly reversals that are found by flying ahead
    of_first = [(us, law) for (name, law), us in calls.items() if name == first]
    for which, bound, ahead in (
        ("laws that fly ahead", PREDICTOR_CALL_US, True),
        ("the others", CALL_US, False),
    ):
        if own := [(us, law) for us, law in of_first if (law in PREDICTORS) == ahead]:
            us, law = max(own)
            yield Finding(f"{first}: longest guidance call of {which}", "us", us, bound, "<=", law)


def _best_law(vehicle: str, flown: Sequence[Row], beyond: set[int]) -> Iterator[Finding]:
    """Misses of the best law, of all entries and of those in reach, and the law's deployment box."""
    best = best_first(flown)[0]
    mine = pick(flown, law=best)
    share, words = 100.0 * len(beyond) / len(mine), f"{vehicle}: {percent(TARGET_SHARE)} of misses"
    in_reach = misses([row for row in mine if row["profile"] not in beyond])
    asked = Finding(f"{words}, best law", "km", nan, TARGET_KM, "<=", best)
    every = with_quantile(asked, misses(mine), TARGET_SHARE)
    within = with_quantile(replace(asked, label=f"{words} of the entries in reach"), in_reach, TARGET_SHARE)
    if within.computed <= TARGET_KM < every.computed:
        cause = f"{share:.1f} % of the entries end short with lift up all the way, flown so"
        every = replace(every, why=cause)
    yield every
    if beyond:
        yield within
        yield Finding(f"{vehicle}: entries short of the target with lift up", "%", share)
    kept = percentage(row["success"] for row in mine)
    yield Finding(f"{vehicle}: deployment box kept, best law", "%", kept, 100.0, ">=", best)


def _pictures(dispersed: Sequence[Row]) -> dict[str, list[Panel]]:
    """Misses of dispersed entries on each vehicle."""
    panels = []
    for vehicle in kinds(dispersed, "vehicle"):
        own = pick(dispersed, vehicle=vehicle)
        order = best_first(own)
        curves = [distribution(misses(pick(own, law=law)), law) for law in order]
        limit = 3.0 * _worst_hundredth(pick(own, law=order[0]))
        options = {"xlim": (0.0, max(2.0 * TARGET_KM, limit))} if isfinite(limit) else {}
        labels = (f"{vehicle}: miss at the mortar", "miss (km)", "flights within (%)")
        panels.append(Panel(*labels, curves, options))
    return {"comparison": panels}


TITLE = "Entry laws on the same entries: other air, lift, wind and entry angle, slow bank, and all dispersed"
STUDY = Study("guidance", TITLE, "this simulator, 2026", run, runs=200, quick_runs=20, parts=LAWS)
