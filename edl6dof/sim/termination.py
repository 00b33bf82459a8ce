"""How a flight ended, in words: with its figures for one flight, and without them so that flights with one
cause count together.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from edl6dof.config.base import stated
from edl6dof.metrics.evaluation import Check
from edl6dof.sim.causes import reasons
from edl6dof.sim.flight_records import FlightRecords
from edl6dof.sim.outcome import CRASHED, LANDED, LAST_EVENT, NOT_FINITE, OUTCOMES, TIME_LIMIT, TIPPED_OVER
from edl6dof.spatial.elementary import hypot
from edl6dof.telemetry.timeline import in_words
from edl6dof.vehicle.motion.rest import ground_speed

#: Goal of the mission: outcome that reaches it, its words (those of the event itself where none stand here),
#: and what follows them when all limits are kept.
_GOALS = {
    "landing": (LANDED, "landed", " within limits"),
    "deployment": (LAST_EVENT, "deployed", " within limits"),
    "event": (LAST_EVENT, "", " within limits"),
    "time": (TIME_LIMIT, "flown to the time limit", ""),
}


@dataclass(frozen=True)
class Termination:
    """How a flight ended.

    Attributes:
        success: whether it reached the goal of the mission within all limits.
        reached: whether it reached the goal, within limits or not.
        outcome: how it ended.
        cause: why it is not a success, as a text without numerical values; empty for a success.
    """

    success: bool
    reached: bool
    outcome: str
    cause: str


def goal_code(goal: str) -> int:
    """Outcome code that reaches the goal of a mission."""
    return _GOALS[goal][0]


def termination(flight: FlightRecords, figures: Mapping[str, float], checks: Sequence[Check]) -> Termination:
    """Say how a flight ended, from its figures and its limits."""
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
            ", ".join(each) for each in zip(*((one.told, one.label) for one in missed), strict=True)
        )
        return Termination(
            False, True, f"{words} outside limits ({limits}){told}", f"outside limits: {labels}{plain}"
        )
    head, figure = _what(flight, figures)
    where = f" in phase {_phase(flight)}"
    # a vehicle without flight software has no phases: said where it matters, as of a crash, and of what
    # counts together
    here = where if flight.phase_names or figure else ""
    legs = _legs(flight, figures)
    return Termination(False, False, f"{head}{figure}{here}{legs}{told}", f"{head}{where}{legs}{plain}")


def _what(flight: FlightRecords, figures: Mapping[str, float]) -> tuple[str, str]:
    """What happened, and its figure."""
    if flight.code == NOT_FINITE:
        return f"not finite: {flight.not_finite}", f" at t = {flight.time_s:.2f} s"
    if flight.code == CRASHED:
        down, over = (figures[f"touchdown_{way}_m_s"] for way in ("vertical", "horizontal"))
        return "crashed", f" at {down:.1f} m/s vertical and {over:.1f} m/s horizontal speed"
    if flight.code == TIME_LIMIT and flight.plant["touched"][0] and _moving(flight):
        speed = ground_speed(flight.case["planet"]["rotation_rate"][0], flight.plant["y"][0])
        return "time limit: still moving on the ground", f" at {speed:.2f} m/s"
    return OUTCOMES[flight.code], ""


def _moving(flight: FlightRecords) -> bool:
    """True if the vehicle is not at rest in the last state."""
    return float(flight.plant["moved_time"][0]) == flight.time_s


def _phase(flight: FlightRecords) -> str:
    """Phase in which it happened: for what the ground did, the one in which the ground was met, and not what
    contact brought about.
    """
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
    """That legs were not let out, of a crash that they would have stood."""
    return " with its legs folded" if flight.code == CRASHED and _slow_enough(flight, figures) else ""


def _slow_enough(flight: FlightRecords, figures: Mapping[str, float]) -> bool:
    """Whether the speed at first contact was one that legs stand."""
    speed = hypot(figures["touchdown_vertical_m_s"], figures["touchdown_horizontal_m_s"])
    return speed <= flight.loaded.truth.limits.crash_speed_m_s
