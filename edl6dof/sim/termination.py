"""How a flight ended and why: its cause in words with figures for one flight, and without them so that
flights with one cause count together.

The causes are worked out after the flight, from the truth: the flight computer never learns of them.  A fault
contributed if it began before the flight was decided (when a limit was broken, at contact with the ground, or
at the end) and its component was still in use; its consequences are named before it: ``propellant exhausted
at 288.0 s after A1 and A3 stuck on at 200.0 and 210.0 s``.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import inf, isfinite, radians
from typing import NamedTuple

import numpy as np

from edl6dof.config.base import stated
from edl6dof.environment.terrain import place_of
from edl6dof.fsw.guidance import guidance_command
from edl6dof.metrics.evaluation import Check
from edl6dof.metrics.figures import figure_of_merit
from edl6dof.sim.flight_records import FlightRecords
from edl6dof.sim.outcome import CRASHED, LANDED, LAST_EVENT, NOT_FINITE, OUTCOMES, TIME_LIMIT, TIPPED_OVER
from edl6dof.spatial.elementary import hypot
from edl6dof.telemetry.timeline import in_words, ran_empty
from edl6dof.vehicle.faults.fault import FaultParams, about
from edl6dof.vehicle.landing_gear import ground_speed

#: Goal of the mission: outcome that reaches it, its words (if empty, those of the event itself), and words
#: added when all limits are met.
_GOALS = {
    "landing": (LANDED, "landed", " within limits"),
    "deployment": (LAST_EVENT, "deployed", " within limits"),
    "event": (LAST_EVENT, "", " within limits"),
    "time": (TIME_LIMIT, "flown to the time limit", ""),
}


@dataclass(frozen=True)
class Termination:
    """How a flight ended."""

    success: bool  # whether it reached the goal of the mission within all limits
    reached: bool  # whether it reached the goal, within limits or not
    outcome: str  # how it ended
    cause: str  # why it is not a success, as a text without numerical values; empty for a success


def goal_code(goal: str) -> int:
    """Outcome code that reaches the goal of a mission."""
    return _GOALS[goal][0]


def termination(flight: FlightRecords, figures: Mapping[str, float], checks: Sequence[Check]) -> Termination:
    """Work out how a flight ended, from its figures and its limits."""
    mission = flight.scenario.mission
    reached, words, within = _GOALS[mission.goal]
    if mission.goal == "event":
        words = in_words(mission.events[stated(mission.goal_event)])
    missed = [check for check in checks if not check.ok] if flight.code == reached else []
    if flight.code == reached and not missed:
        return Termination(True, True, words + (within if checks else ""), "")
    of_mission = [check for check in missed if not check.of_balance]
    # nothing that happened to the vehicle unbalances its flight
    told, plain = ("", "") if missed and not of_mission else reasons(flight, figures, of_mission)
    if missed:
        limits, labels = (
            ", ".join(each) for each in zip(*((one.statement, one.label) for one in missed), strict=True)
        )
        return Termination(
            False, True, f"{words} outside limits ({limits}){told}", f"outside limits: {labels}{plain}"
        )
    head, figure = _what(flight, figures)
    where = f" in phase {_phase(flight)}"
    # a vehicle without flight software has no phases: its outcome names the free flight with numbers only, as
    # of a crash; its cause always
    here = where if flight.phase_names or figure else ""
    legs = _legs(flight, figures)
    return Termination(False, False, f"{head}{figure}{here}{legs}{told}", f"{head}{where}{legs}{plain}")


def _what(flight: FlightRecords, figures: Mapping[str, float]) -> tuple[str, str]:
    """Outcome in words, and its numbers in words."""
    if flight.code == NOT_FINITE:
        return f"not finite: {flight.not_finite}", f" at t = {flight.time_s:.2f} s"
    if flight.code == CRASHED:
        down, over = (figures[f"touchdown_{way}_m_s"] for way in ("vertical", "horizontal"))
        return "crashed", f" at {down:.1f} m/s vertical and {over:.1f} m/s horizontal speed"
    moving = float(flight.plant["moved_time"][0]) == flight.time_s  # in the last state
    if flight.code == TIME_LIMIT and flight.plant["touched"][0] and moving:
        speed = ground_speed(flight.case["planet"]["rotation_rate"][0], flight.plant["y"][0])
        return "time limit: still moving on the ground", f" at {speed:.2f} m/s"
    return OUTCOMES[flight.code], ""


def _phase(flight: FlightRecords) -> str:
    """Phase of the end; of a crash or a tip-over, the phase at ground contact."""
    names = flight.phase_names
    if not names:
        return "free flight"
    if flight.code not in (CRASHED, TIPPED_OVER):
        return flight.phase
    met = float(flight.plant["touchdown_time"][0])
    flown = [
        name
        for name, entered in zip(names, flight.fsw["mission"]["entered"][0], strict=False)
        if entered < met
    ]
    return flown[-1] if flown else names[0]


def _legs(flight: FlightRecords, figures: Mapping[str, float]) -> str:
    """Note on a crash that the legs would have withstood, had they been let out."""
    if flight.code != CRASHED:
        return ""
    speed = hypot(figures["touchdown_vertical_m_s"], figures["touchdown_horizontal_m_s"])
    return " with its legs folded" if speed <= flight.loaded.truth.limits.crash_speed_m_s else ""


#: Figures that are the peak of a quantity, and the field of ``PEAKS`` with its time.
_PEAK_TIMES = {
    "peak_load_g0": "entry_load_time",
    "peak_dynamic_pressure_pa": "dynamic_pressure_time",
    "peak_heat_flux_w_cm2": "heat_flux_time",
}


class Consequence(NamedTuple):
    """Event on the way to the end: time (s), words without numbers, and words with its numbers."""

    t_s: float
    without_numbers: str
    with_numbers: str


def reasons(flight: FlightRecords, figures: Mapping[str, float], missed: Sequence[Check]) -> tuple[str, str]:
    """Causes of the end of a flight that is no success, as text with numbers and without, to append to the
    outcome; empty without a cause.  ``missed``: broken limits, if the flight reached its goal.
    """
    until = _decided_at(flight, figures, missed)
    led_to = sorted(one for one in _consequences(flight) if one.t_s <= until)
    told, plain = _contributing(flight, until)
    return _sentence([one.with_numbers for one in led_to], told), _sentence(
        [one.without_numbers for one in led_to], plain
    )


def _sentence(led_to: list[str], faults: list[str]) -> str:
    return (f": {_joined(led_to)}" if led_to else "") + (f" after {_joined(faults)}" if faults else "")


def _joined(words: Sequence[str]) -> str:
    """``a``, ``a and b``, ``a, b and c``."""
    return " and ".join([", ".join(words[:-1]), words[-1]] if len(words) > 1 else words)


def _decided_at(flight: FlightRecords, figures: Mapping[str, float], missed: Sequence[Check]) -> float:
    """Time (s) after which no event is a cause: the last broken limit, or ground contact, or the end."""
    met = float(flight.plant["touchdown_time"][0])
    end = met if isfinite(met) else flight.time_s
    return max((_broken_at(flight, figures, check, end) for check in missed), default=end)


def _broken_at(flight: FlightRecords, figures: Mapping[str, float], check: Check, end: float) -> float:
    """Time (s) at which a limit was broken: time of the peak, or of the event at which the figure is taken;
    for the landing distance, the time from which the limit was out of reach.
    """
    if check.figure in _PEAK_TIMES:
        return float(flight.peaks[_PEAK_TIMES[check.figure]][0])
    if check.figure == "landing_distance_m":
        return _out_of_reach(flight, figures, check.limit, end)
    if figure_of_merit(check.figure).source in ("contact", "footing"):
        return end
    return figures.get(f"{check.figure.partition('_')[0]}_s", end)


def _out_of_reach(flight: FlightRecords, figures: Mapping[str, float], limit: float, end: float) -> float:
    """Time (s) from which the distance to the landing site exceeded ``limit`` (m) by more than the height
    above ground, which no descent can correct; mortar fire at the earliest, ground contact at the latest.
    """
    names = ("t_s", "truth.latitude_deg", "truth.longitude_deg", "truth.height_m")
    mortar, terrain = figures.get("parachute_s", end), flight.case["terrain"][0]
    table = np.column_stack([flight.telemetry[name] for name in names])
    descent = table[(table[:, 0] >= mortar) & (table[:, 0] < end)]
    for t, latitude, longitude, height in descent[::-1].tolist():
        if hypot(*place_of(terrain, radians(latitude), radians(longitude))) <= limit + height:
            return t
    return mortar


# ---- faults ------------------------------------------------------------------------------------------------


def _contributing(flight: FlightRecords, until: float) -> tuple[list[str], list[str]]:
    """Faults that contributed until a time (s), grouped by kind: texts with the times they began, and
    without.
    """
    truth = flight.loaded.truth
    begun = sorted(
        (float(since), number)
        for number, since in enumerate(flight.plant["fault_since"][0][: len(truth.faults)])
        if since < until and _counts(flight, truth.faults[number], float(since), until)
    )
    kinds: dict[str, list[tuple[str, float]]] = {}
    for since, number in begun:
        fault = truth.faults[number]
        kinds.setdefault(fault.kind.replace("_", " "), []).append((fault.acts_on(truth.components), since))
    plain = [f"{_joined([name for name, _ in ones])} {kind}" for kind, ones in kinds.items()]
    times = [_joined([*dict.fromkeys(f"{since:.1f}" for _, since in ones)]) for ones in kinds.values()]
    return [f"{words} at {t} s" for words, t in zip(plain, times, strict=True)], plain


def _counts(flight: FlightRecords, fault: FaultParams, since: float, until: float) -> bool:
    """True if a fault that began at ``since`` contributed to an end decided at ``until`` (s): its component
    was still in use when it began; a fault of a wing contributes only up to the deployment that the wing
    prepares.
    """
    scenario, name = flight.scenario, fault.acts_on(flight.loaded.truth.components)
    chutes = scenario.vehicle.parachutes
    if fault.component == "surface":
        return until <= _done(flight, ("deploy",), [chute.name for chute in chutes])
    carriers = [chute.carried_by for chute in chutes if chute.name == name and chute.carried_by]
    return since < _done(flight, about(fault.kind).over_after, [name, *carriers])


def _done(flight: FlightRecords, actions: Sequence[str], components: Sequence[str]) -> float:
    """Time (s) at which one of some actions was first done to one of some components; never: infinity."""
    events = flight.scenario.mission.events.values()
    return min(
        (
            float(t)
            for event, t in zip(events, flight.plant["done"][0], strict=False)
            if event.action in actions and event.component in components and isfinite(t)
        ),
        default=inf,
    )


# ---- consequences ------------------------------------------------------------------------------------------


def _consequences(flight: FlightRecords) -> list[Consequence]:
    """Consequences on the way to the end of a flight, of propellant, engines, parachutes and guidance."""
    found = [*_empty_tanks(flight), *_cut_off(flight)]
    if flight.code == CRASHED:
        found += [*_left_undone(flight), *_relaxed(flight)]
    return found


def _empty_tanks(flight: FlightRecords) -> list[Consequence]:
    vehicle, times = flight.loaded.truth.vehicle, flight.plant["exhausted_time"][0]
    empty = {
        ran_empty(tank, vehicle): float(t)
        for tank, t in zip(vehicle.tanks, times, strict=False)
        if isfinite(t)
    }
    if len(empty) == len(vehicle.tanks) and empty:
        empty = {"propellant exhausted": max(empty.values())}
    return [Consequence(t, words, f"{words} at {t:.1f} s") for words, t in empty.items()]


def _cut_off(flight: FlightRecords) -> list[Consequence]:
    """The first cut-off above the ground."""
    names = _engines(flight)
    t, met = _done(flight, ("cut_off",), names), float(flight.plant["touchdown_time"][0])
    if not isfinite(t) or t >= met:
        return []
    (height,) = flight.telemetry.at(t, "truth.height_m")
    words = "engine cut off {}above the ground"
    return [Consequence(t, words.format(""), words.format(f"{height:.1f} m ") + f" at {t:.1f} s")]


def _relaxed(flight: FlightRecords) -> list[Consequence]:
    """Largest relaxation of constraints by powered guidance, which it needs only when it cannot land."""
    times = flight.fsw[0]["guidance"]["relaxed"]["t"]
    noted = np.flatnonzero(times > 0.0)
    if not len(noted):
        return []
    t, words = float(times[noted[-1]]), guidance_command.in_words(int(noted[-1]) + 1)
    (height,) = flight.telemetry.at(t, "truth.height_m")
    return [Consequence(t, words, f"{words} from {height:.0f} m at {t:.1f} s")]


def _engines(flight: FlightRecords) -> list[str]:
    """Names of engines, and of groups of them."""
    vehicle = flight.scenario.vehicle
    return [*(engine.name for engine in vehicle.engines), *vehicle.engine_groups]


def _left_undone(flight: FlightRecords) -> list[Consequence]:
    """Planned actions that a mission did not carry out before it crashed."""
    met, vehicle = float(flight.plant["touchdown_time"][0]), flight.scenario.vehicle
    planned = {(event.action, event.component) for event in flight.scenario.mission.events.values()}
    wanted = (
        ("deploy", [chute.name for chute in vehicle.parachutes], "no parachute deployed"),
        ("ignite", _engines(flight), "no engine lit"),
    )
    return [
        Consequence(met, words, words)
        for action, components, words in wanted
        if any((action, component) in planned for component in components)
        and not isfinite(_done(flight, (action,), components))
    ]
