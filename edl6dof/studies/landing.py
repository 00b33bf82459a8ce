"""Every powered law from the same dispersed ignition states, on diverts of three lengths, and with the engine
failing.

This is an experiment of this simulator and of no paper.  The flights are those of ``tianwen1_mc``, and the
same for all laws until ignition, so that they differ by the laws only.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from math import hypot, inf, isfinite, nan, sqrt

import numpy as np

import edl6dof
from edl6dof import Case, LoadedScenario
from edl6dof.campaign.design.plan import load_plan
from edl6dof.campaign.executor import Row
from edl6dof.config.wording import counted
from edl6dof.fsw.functions import chosen
from edl6dof.fsw.guidance.guidance_command import GUIDE
from edl6dof.fsw.guidance.powered.registry import POWERED_LAWS
from edl6dof.fsw.guidance.powered.target import POWERED_TARGET
from edl6dof.fsw.navigation.derived import NAV
from edl6dof.fsw.vehicle_state import VEHICLE_STATE
from edl6dof.interface.roles import HOVER_IMAGING, PARACHUTE, POWERED_DECELERATION
from edl6dof.kernels import kernel
from edl6dof.scenario.records import build_records
from edl6dof.scenario.schema import Scenario
from edl6dof.sim.flight import Flight
from edl6dof.sim.flight_state import snapshots_at
from edl6dof.studies.frame import Curve, Finding, Grid, Line, Panel, Report, Session, Study, quickest_us
from edl6dof.studies.samples import column, kinds, mean, percentage, pick, quantile_grid

SCENARIO, LAWS = "tianwen1_mc", POWERED_LAWS.names
POWERED = "flight_software.guidance.powered"
DISPERSED = "dispersed"
#: Diverts (m) against the drift, and dispersed flights for each flight of one of them.
DIVERTS, _PER_DIVERT = (0.0, 300.0, 600.0), 10
#: Heights (m) of a late release of the backshell, in flights that are not dispersed: the first three are too
#: low for any law to stop.
LATE_RELEASES = (300.0, 325.0, 350.0, 400.0, 450.0, 500.0, 550.0, 600.0, 800.0)
#: Faults of the engine in flights that are not dispersed: when after backshell release (s), and which.
ENGINE_FAULTS: dict[str, tuple[float, str, dict[str, float]]] = {
    **{f"{100.0 * x:g} % thrust": (0.0, "engine_shortfall", {"thrust_factor": x}) for x in (0.8, 0.7, 0.6)},
    **{f"{late:g} s late": (0.0, "ignition_delay", {"delay_s": late}) for late in (2.0, 4.0)},
    **{f"stuck {after:g} s": (after, "throttle_stuck", {}) for after in (5.0, 20.0, 35.0)},
    "dead 20 s": (20.0, "engine_dead", {}),
}
#: The law that the others are compared with, and the ones that solve an optimisation problem in flight.
REFERENCE, OPTIMISERS = "polynomial", ("convex",)
#: The law that plans nothing, and by how much (m/s) another may come down faster after a late release.
UNPLANNED, FASTER_M_S = "gravity_turn", 0.5
#: Largest miss (m), speed (m/s) and error of height (m) at the beginning of hover of a law that has reached
#: the target; longest saturation (s) of a law within its limits.
MISS_M, SPEED_M_S, HEIGHT_M, SATURATED_S = 5.0, 5.0, 10.0, 10.0
#: Targets of this study: miss of the longest divert (m), time of a call (us), share of landings (%).
DIVERT_MISS_M, CALL_US, OPTIMISER_CALL_US, LANDED_PCT = 2.0, 5.0, 5000.0, 99.0
#: Distances from the limit of tilt (deg) and from the end of the thrust band (N) that count as saturated.
_AT_LIMIT_DEG, _AT_LIMIT_N = 0.1, 1.0
#: Half the width of a 95 % interval, in standard errors.
_TWO_SIDED = 1.96
REMARKS = (
    "The bounds are this project's own targets.",
    f"Reached: hover begins within {MISS_M:g} m of the target, {SPEED_M_S:g} m/s and {HEIGHT_M:g} m of "
    f"height; saturated: thrust at the upper end of the band or beyond, or tilt at its limit, for more than "
    f"{SATURATED_S:g} s after the start.",
    "The miss as navigated leaves out what the error of navigation changes from ignition to hover.",
    "gravity_turn has no target: its miss is where the gravity turn ends.",
)


def run(session: Session) -> Report:
    """Fly dispersed landings, diverts, late releases and faults of the engine by every law."""
    rows: list[Row] = []
    calls: dict[str, float] = {}
    truths = dispersed(session.flights)
    for law in session.parts:
        loaded = with_law(law)
        planned = cases(loaded.scenario, truths, law)
        session.total = len(session.parts) * len(planned)
        rows += session.fly(loaded, planned, of_flight)
        calls[law] = call_time(loaded)
    found, grids = list(_findings(rows, calls)), list(_grids(rows, calls))
    return Report(found, rows, session.total, grids, REMARKS, _pictures(rows))


# ---- what is flown -------------------------------------------------------------------------------------


def divert(metres: float) -> str:
    """Name of the condition of a divert."""
    return f"divert {metres:g} m"


def _release(height: float) -> str:
    return f"released at {height:g} m"


def with_law(law: str) -> LoadedScenario:
    """The scenario of the landing, flown by a law."""
    return edl6dof.load(SCENARIO, ["simulation.log_every=5", f"{POWERED}.law={law}"])


def dispersed(flights: int) -> list[Case]:
    """The first cases of the campaign, which are the same for all laws."""
    return list(load_plan(SCENARIO).cases(0, flights))


def cases(scenario: Scenario, flights: Sequence[Case], law: str) -> list[Case]:
    """All cases of a law."""
    names = {phase.role: phase.name for phase in reversed(scenario.mission.phases)}
    some = flights[: max(len(flights) // _PER_DIVERT, 1)]
    diverts = [(divert(m), one, {f"{POWERED}.target.divert_m": m}) for m in DIVERTS for one in some]
    planned = []
    for condition, one, told in [*((DISPERSED, one, {}) for one in flights), *diverts]:
        planned.append((condition, one.index, one.truth, {**one.belief, **told}, one.profile))
    ends = f"mission.phases.{names[PARACHUTE]}.until.value"
    planned += [(_release(h), i, {}, {ends: h}, 0) for i, h in enumerate(LATE_RELEASES)]
    for i, (name, (after, kind, values)) in enumerate(ENGINE_FAULTS.items()):
        at = {"phase": names[POWERED_DECELERATION], "plus_s": after}
        fault = {"engine": "main", "at": at, "kind": kind, **({kind: values} if values else {})}
        planned.append((name, i, {"faults": [fault]}, {}, 0))
    return [
        Case(i, truth, belief, profile, {"law": law, "condition": condition, "flight": flight})
        for i, (condition, flight, truth, belief, profile) in enumerate(planned)
    ]


# ---- one landing ---------------------------------------------------------------------------------------


def of_flight(flight: Flight) -> dict[str, float]:
    """Figures from ignition to hover, and to the ground.

    ``came_down``: landed, within limits or not.  ``ignition_*``: true state at ignition.  ``hover_fuel_kg``,
    ``ground_fuel_kg``: propellant from ignition to hover, and to the ground.  ``target_miss_m``: true
    horizontal distance at the beginning of hover from the target, which guidance has put relative to the
    lander's place at ignition; ``navigated_miss_m``: the same as navigated.  ``hover_off_m``: height above
    the height of the target.  ``peak_tilt_deg``: largest tilt of the thrust axis while decelerating.
    ``saturated_s``: time with thrust at or above the upper end of its band, or commanded tilt at its limit;
    the start at full thrust is left out.
    """
    rows, braking = flight.telemetry, np.flatnonzero(flight.during(POWERED_DECELERATION))
    burning = braking[rows["guide.thrust_n"][braking] > 0.0]
    found: dict[str, float] = {"came_down": flight.landed}
    if not len(burning):
        return found
    start, hover = burning[0], np.flatnonzero(flight.during(HOVER_IMAGING))
    found |= {
        "ignition_height_m": float(rows["truth.height_m"][start]),
        "ignition_descent_m_s": float(rows["truth.v_down_m_s"][start]),
        "ignition_drift_m_s": hypot(rows["truth.v_north_m_s"][start], rows["truth.v_east_m_s"][start]),
        "peak_tilt_deg": float(np.max(rows["truth.tilt_deg"][burning])),
        "saturated_s": _saturated(flight, burning),
    }
    propellant = rows["truth.propellant_kg"]
    if len(hover):
        found["hover_fuel_kg"] = float(propellant[start] - propellant[hover[0]])
        found.update(_arrival(flight, int(start), int(hover[0])))
    if flight.landed:
        found["ground_fuel_kg"] = float(propellant[start] - propellant[-1])
    return found


def _saturated(flight: Flight, burning: np.ndarray) -> float:
    rows, powered = flight.telemetry, flight.scenario.flight_software.guidance.powered
    t, engine = rows["t_s"][burning], flight.scenario.vehicle.engines[0]
    limit = getattr(getattr(powered, powered.law), "tilt_limit_deg", nan)
    tilt = np.degrees(np.arccos(np.clip(-rows["guide.thrust_direction_down"][burning], -1.0, 1.0)))
    full = rows["guide.thrust_n"][burning] > engine.throttle_max_n - _AT_LIMIT_N
    at_limit = full | (tilt > limit - _AT_LIMIT_DEG)
    return float(np.sum(np.gradient(t)[at_limit & (t > t[0] + powered.full_time_s)]))


def _arrival(flight: Flight, start: int, hover: int) -> dict[str, float]:
    """Miss (m), height (m) and speed (m/s) at the beginning of hover, relative to the target."""
    rows, target = flight.telemetry, flight.fsw[0]["guidance"]["target"]

    def level(stem: str, row: int) -> np.ndarray:
        return np.array([rows[f"{stem}_{axis}_m"][row] for axis in ("east", "north")])

    off = level("truth.site", hover) - target["point_L"]
    chosen, now = (level("nav.error", row) for row in (start, hover))
    return {
        # guidance chose the target in navigated axes, so the navigation error of that time displaces it
        "target_miss_m": float(np.hypot(*(off + chosen))),
        "navigated_miss_m": float(np.hypot(*(off + now))),
        "hover_off_m": float(rows["truth.height_m"][hover] - target["height"]),
        "hover_speed_m_s": float(rows["truth.speed_m_s"][hover]),
    }


# ---- time of a call: the compiled law alone, over states of the nominal descent ------------------------

#: Times (s) of the states after backshell release; time (s) from a state to the call, to plan again.
SAVED_AFTER_S, LATER_S = (3.0, 11.0, 19.0, 27.0), 1.0
REPEATS, BLOCKS = 20, 10


@kernel
def _repeat(law, onboards, states, navs, targets, memories, work, outs, repeats):
    """Call a powered law repeatedly on one state, each time with the memory as it was at first."""
    powered = onboards[0].guidance.powered
    for _ in range(repeats):
        work[0] = memories[0]
        law(
            powered.law,
            powered,
            onboards[0].vehicle,
            state=states[0],
            nav=navs[0],
            target=targets[0],
            memory=work[0],
            out=outs[0],
        )


def call_time(loaded: LoadedScenario) -> float:
    """Longest processor time (us) of a guidance call over states of the nominal descent; the memory of the
    law is one second old, so that a law that plans at intervals plans in every call.
    """
    onboard = build_records(loaded).onboard
    released = edl6dof.fly(loaded).figures["backshell_s"]
    times = [released + after + later for after in SAVED_AFTER_S for later in (0.0, LATER_S)]
    moments = snapshots_at(loaded, times)
    if len(moments) < len(times):
        raise ValueError(f"the nominal flight is over before {times[len(moments)]:g} s")
    longest = 0.0
    for before, after in zip(moments[::2], moments[1::2], strict=True):
        guidance = before.fsw["guidance"]
        records = (after.fsw["vehicle"], after.fsw["nav"], guidance["target"], guidance["powered"])
        dtypes = (VEHICLE_STATE, NAV, POWERED_TARGET, POWERED_LAWS.memory)
        given = [np.array([one[0]], dtype) for one, dtype in zip(records, dtypes, strict=True)]
        given += [np.zeros(1, POWERED_LAWS.memory), np.zeros(1, GUIDE)]
        call = partial(_repeat, chosen("powered_law", onboard[0]), onboard, *given, REPEATS)
        longest = max(longest, quickest_us(call, BLOCKS))
    return longest / REPEATS


# ---- what came out -------------------------------------------------------------------------------------


def of(rows: Sequence[Row], law: str, condition: str = DISPERSED) -> list[Row]:
    """The rows of a law in a condition."""
    return pick(rows, law=law, condition=condition)


def reached(row: Row) -> bool:
    """Return whether hover began at the target."""
    return (
        row.get("target_miss_m", inf) <= MISS_M
        and row["hover_speed_m_s"] <= SPEED_M_S
        and abs(row["hover_off_m"]) <= HEIGHT_M
    )


def _came_down(rows: Sequence[Row]) -> list[bool]:
    return [row.get("came_down", False) for row in rows]


def difference(rows: Sequence[Row], law: str, name: str) -> tuple[float, float]:
    """Mean of a figure less that of the reference law in the same flights, and half of its 95 % interval."""
    ours, theirs = ({row["flight"]: row.get(name, nan) for row in of(rows, one)} for one in (law, REFERENCE))
    pairs = np.array([ours[flight] - theirs[flight] for flight in ours.keys() & theirs.keys()], float)
    pairs = pairs[np.isfinite(pairs)]
    if len(pairs) < 2:
        return nan, nan
    return float(np.mean(pairs)), _TWO_SIDED * float(np.std(pairs, ddof=1)) / sqrt(len(pairs))


def _worst(rows: Sequence[Row], name: str, missing: float) -> float:
    return float(np.max(column(rows, name, missing)))


def _grids(rows: Sequence[Row], calls: Mapping[str, float]) -> Iterator[Grid]:
    """Dispersed landings, diverts, late releases, failing engines."""
    laws = kinds(rows, "law")
    flights = f"{len(of(rows, laws[0]))} dispersed landings"
    fuels = ("hover_fuel_kg", "ground_fuel_kg")
    heads = ("law", *(f"{to}: {what}" for to in ("hover", "ground") for what in ("kg", "less kg", "95 % +-")))
    lines: list[Line] = []
    for law in laws:
        used = [(mean(of(rows, law), fuel), *difference(rows, law, fuel)) for fuel in fuels]
        lines.append((law, *used[0], *used[1]))
    yield Grid(f"{flights}: propellant to hover and to the ground, less {REFERENCE}", heads, lines)
    for name, words in (("target_miss_m", "of the target"), ("navigated_miss_m", "as navigated")):
        title = f"{flights}: quantiles of the miss {words}, m"
        yield quantile_grid(title, "law", {law: column(of(rows, law), name, inf) for law in laws})
    heads = ("law", "tilt deg: mean", "peak", "not reached %", "saturated %", "landed %", "call us")
    lines = [(law, *_kept(of(rows, law)), calls[law]) for law in laws]
    yield Grid(f"{flights}: target and limits", heads, lines)
    heads = ("law", *(f"{m:g} m: {what}" for m in DIVERTS for what in ("kg", "miss m", "not %")))
    lines = [(law, *(x for m in DIVERTS for x in _diverted(of(rows, law, divert(m))))) for law in laws]
    each = counted(len(of(rows, laws[0], divert(DIVERTS[0]))), "flight")
    words = "propellant to hover, largest miss as navigated, share not reached"
    yield Grid(f"diverts, {each} each: {words}", heads, lines)
    speed, late = "descent rate at the ground, m/s", {f"{h:g} m": _release(h) for h in LATE_RELEASES}
    for title, conditions in (
        (f"backshell released late: {speed}", late),
        (f"engine fails, s after backshell release: {speed}; -: lost before", {n: n for n in ENGINE_FAULTS}),
    ):
        lines = [(law, *(_ground_speed(rows, law, one) for one in conditions.values())) for law in laws]
        yield Grid(title, ("law", *conditions), lines)


def _kept(flown: Sequence[Row]) -> tuple[float, ...]:
    saturated = percentage(row.get("saturated_s", inf) > SATURATED_S for row in flown)
    tilts = mean(flown, "peak_tilt_deg"), _worst(flown, "peak_tilt_deg", 0.0)
    return *tilts, _missed(flown), saturated, percentage(_came_down(flown))


def _diverted(flown: Sequence[Row]) -> tuple[float, float, float]:
    return mean(flown, "hover_fuel_kg"), _worst(flown, "navigated_miss_m", inf), _missed(flown)


def _missed(flown: Sequence[Row]) -> float:
    return percentage(not reached(row) for row in flown)


def _ground_speed(rows: Sequence[Row], law: str, condition: str) -> float:
    return mean(of(rows, law, condition), "touchdown_vertical_m_s")


def _findings(rows: Sequence[Row], calls: Mapping[str, float]) -> Iterator[Finding]:
    """Landings, the longest divert, late releases, fuel against the reference, times of a call."""
    laws, longest = kinds(rows, "law"), divert(DIVERTS[-1])
    for law in laws:
        share = percentage(_came_down(of(rows, law)))
        yield Finding(f"{law}: dispersed landings", "%", share, LANDED_PCT, ">=")
    misses = {law: _worst(of(rows, law, longest), "navigated_miss_m", inf) for law in laws}
    best = min(misses, key=lambda law: misses[law])
    yield Finding(f"largest miss, {longest}, best law", "m", misses[best], DIVERT_MISS_M, "<=", best)
    for law in laws:
        if law != UNPLANNED and UNPLANNED in laws:
            low = [_release(height) for height in LATE_RELEASES]
            faster = max(_ground_speed(rows, law, one) - _ground_speed(rows, UNPLANNED, one) for one in low)
            name = f"{law}: faster than {UNPLANNED} at the ground, late releases"
            yield Finding(name, "m/s", faster, FASTER_M_S, "<=")
    for name in ENGINE_FAULTS:
        flown = pick(rows, condition=name)
        causes = dict.fromkeys(row["cause"] for row in flown if not row.get("came_down", False))
        down = float(sum(_came_down(flown)))
        yield Finding(f"{name}: laws that land, of {len(flown)}", "", down, note="; ".join(causes))
    for law in laws:
        saved, half = difference(rows, law, "hover_fuel_kg")
        if law != REFERENCE and isfinite(saved):
            yield Finding(f"{law}: fuel to hover less {REFERENCE}", "kg", saved, note=f"+- {half:.2f}, 95 %")
    for law, us in calls.items():
        bound = OPTIMISER_CALL_US if law in OPTIMISERS else CALL_US
        yield Finding(f"{law}: longest guidance call", "us", us, bound, "<=")


def _pictures(rows: Sequence[Row]) -> dict[str, list[Panel]]:
    """Fuel, miss, tilt, and cost of a divert."""
    laws, panels = kinds(rows, "law"), []
    for name, title, label, options in (
        ("hover_fuel_kg", "fuel", "propellant from ignition to hover (kg)", {}),
        ("target_miss_m", "miss", "distance from the target where hover begins (m)", {"xscale": "log"}),
        ("peak_tilt_deg", "tilt of the thrust axis", "largest tilt (deg)", {}),
    ):
        curves = [Curve.distribution(column(of(rows, law), name), law) for law in laws]
        panels.append(Panel(title, label, "flights within (%)", curves, options))
    fuel = {law: [mean(of(rows, law, divert(m)), "hover_fuel_kg") for m in DIVERTS] for law in laws}
    cost = [Curve(DIVERTS, values, law) for law, values in fuel.items()]
    panels.append(Panel("cost of a divert", "divert (m)", "propellant to hover (kg)", cost))
    return {"comparison": panels}


TITLE = "Powered guidance laws from the same dispersed ignitions: fuel, miss, tilt, diverts, engine faults"
STUDY = Study("landing", TITLE, "this simulator, 2026", run, runs=200, quick_runs=20, parts=LAWS)
