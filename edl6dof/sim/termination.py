"""How a flight ended, in words: with its figures for one flight, and without them so that flights with one
cause count together.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import hypot, inf, isfinite
from typing import TYPE_CHECKING

from edl6dof.sim.outcome import CRASHED, DEPLOYED, LANDED, NOT_FINITE, OUTCOMES, TIME_LIMIT, TIPPED_OVER

if TYPE_CHECKING:
    from edl6dof.sim.flight import Flight

#: Goal of the mission: outcome that reaches it, its words, and what follows them when all limits are kept.
_GOALS = {
    "landing": (LANDED, "landed", " within limits"),
    "deployment": (DEPLOYED, "deployed", " within limits"),
    "time": (TIME_LIMIT, "flown to the time limit", ""),
}


@dataclass(frozen=True)
class Termination:
    """How a flight ended.

    Attributes:
        success: whether it reached the goal of the mission within all limits.
        reached: whether it reached the goal, within limits or not.
        outcome: how it ended.
        cause: why it is no success, without numbers; empty for a success.
    """

    success: bool
    reached: bool
    outcome: str
    cause: str


def goal_code(goal: str) -> int:
    """Outcome code that reaches the goal of a mission."""
    return _GOALS[goal][0]


def termination(flight: Flight) -> Termination:
    """How ``flight`` ended."""
    reached, words, within = _GOALS[flight.scenario.mission.goal]
    missed = ", ".join(check.label for check in flight.checks if not check.ok)
    if flight.code == reached and not missed:
        return Termination(True, True, words + within, "")
    told, plain = _circumstances(flight)
    if flight.code == reached:
        return Termination(
            False, True, f"{words} outside limits ({missed}){told}", f"outside limits: {missed}{plain}"
        )
    head, figure = _what(flight)
    where = f" in phase {_phase(flight)}"
    # a vehicle without flight software has no phases: said where it matters, as of a crash, and of what
    # counts together
    here = where if flight.phase_names or figure else ""
    return Termination(False, False, f"{head}{figure}{here}{told}", f"{head}{where}{plain}")


def _what(flight: Flight) -> tuple[str, str]:
    """What happened, and its figure."""
    if flight.code == NOT_FINITE:
        return f"not finite: {flight.not_finite}", f" at t = {flight.time_s:.2f} s"
    if flight.code == CRASHED:
        return "crashed", f" at {flight.metrics['touchdown_vertical_m_s']:.1f} m/s descent rate"
    return OUTCOMES[flight.code], ""


def _phase(flight: Flight) -> str:
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


def _circumstances(flight: Flight) -> tuple[str, str]:
    """What went wrong before, in words with and without figures: propellant used up, engine cut off in the
    air, legs not let out.
    """
    plant = flight.plant[0]
    told, plain = [], []
    for words, t in _empty_tanks(flight).items():
        plain.append(words)
        told.append(f"{words} at t = {t:.1f} s")
    events, met = flight.scenario.mission.events.values(), float(plant["touchdown_time"])
    done = zip(events, plant["done"], strict=False)
    cut_off = float(min((t for event, t in done if event.action == "cut_off" and isfinite(t)), default=inf))
    if isfinite(cut_off) and not cut_off >= met:
        plain.append("the engine was cut off above the ground")
        (height,) = flight.telemetry.at(cut_off, "truth.height_m")
        told.append(f"the engine was cut off {height:.1f} m above the ground at t = {cut_off:.1f} s")
    legs = " with its legs folded" if flight.code == CRASHED and _slow_enough(flight) else ""
    after_told, after_plain = (f" after {' and '.join(words)}" if words else "" for words in (told, plain))
    return legs + after_told, legs + after_plain


def _empty_tanks(flight: Flight) -> dict[str, float]:
    """What ran empty, in words, and when (s): each tank, or all propellant."""
    tanks, times = flight.loaded.truth.vehicle.tanks, flight.plant["exhausted_time"][0]
    empty = {tank.name: float(t) for tank, t in zip(tanks, times, strict=False) if isfinite(t)}
    if empty and len(empty) == len(tanks):
        return {"the propellant was exhausted": max(empty.values())}
    return {f"tank {name} ran empty": t for name, t in empty.items()}


def _slow_enough(flight: Flight) -> bool:
    """Whether the speed at first contact was one that legs stand."""
    speed = hypot(flight.metrics["touchdown_vertical_m_s"], flight.metrics["touchdown_horizontal_m_s"])
    return speed <= flight.loaded.truth.limits.crash_speed_m_s
