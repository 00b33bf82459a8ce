"""Why a flight ended as it did: what its true faults and its history brought about.

It is worked out after the flight, from the truth: the flight computer never learns of it.  A fault
contributed if it began before what decided the flight (a point at which a limit is broken, or contact with
the ground, or the end) and had to do with it; its consequences stand before it: ``propellant exhausted at
288.0 s after A1 and A3 stuck on at 200.0 and 210.0 s``.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import inf, isfinite, radians
from typing import NamedTuple

import numpy as np

from edl6dof.environment.landing_area.plane import place_of
from edl6dof.fsw.guidance.guidance_command import in_words
from edl6dof.metrics.evaluation import Check
from edl6dof.metrics.figures import figure_of_merit
from edl6dof.sim.flight_records import FlightRecords
from edl6dof.sim.outcome import CRASHED
from edl6dof.spatial.elementary import hypot
from edl6dof.telemetry.timeline import ran_empty
from edl6dof.vehicle.faults.fault import FaultParams
from edl6dof.vehicle.faults.registry import over_after

#: Figures that are the largest value of a flight, and when it was met.
_PEAK_TIMES = {
    "peak_load_g0": "entry_load_time",
    "peak_dynamic_pressure_pa": "dynamic_pressure_time",
    "peak_heat_flux_w_cm2": "heat_flux_time",
}


class Consequence(NamedTuple):
    """What happened on the way to the end: when (s), in words, and in words with its figures."""

    t_s: float
    plain: str
    told: str


def reasons(flight: FlightRecords, figures: Mapping[str, float], missed: Sequence[Check]) -> tuple[str, str]:
    """What brought a flight to its end, with figures and without them, to follow the words for that end;
    empty where nothing did.

    Args:
        flight: one that is no success.
        figures: its figures.
        missed: limits that it broke, if it reached its goal.
    """
    until = _decided_at(flight, figures, missed)
    led_to = sorted(one for one in _consequences(flight) if one.t_s <= until)
    told, plain = _contributing(flight, until)
    return _sentence([one.told for one in led_to], told), _sentence([one.plain for one in led_to], plain)


def _sentence(led_to: list[str], faults: list[str]) -> str:
    return (f": {_joined(led_to)}" if led_to else "") + (f" after {_joined(faults)}" if faults else "")


def _joined(words: Sequence[str]) -> str:
    """``a``, ``a and b``, ``a, b and c``."""
    return " and ".join([", ".join(words[:-1]), words[-1]] if len(words) > 1 else words)


def _decided_at(flight: FlightRecords, figures: Mapping[str, float], missed: Sequence[Check]) -> float:
    """Time (s) after which nothing counts: the last point at which a limit was broken, or ground contact, or
    the end.
    """
    met = float(flight.plant["touchdown_time"][0])
    end = met if isfinite(met) else flight.time_s
    return max((_broken_at(flight, figures, check, end) for check in missed), default=end)


def _broken_at(flight: FlightRecords, figures: Mapping[str, float], check: Check, end: float) -> float:
    """Time (s) at which a limit was broken: that of the peak, or of the event that the figure is taken at;
    for the distance of a landing the time from which it could not be kept.
    """
    if check.figure in _PEAK_TIMES:
        return float(flight.peaks[_PEAK_TIMES[check.figure]][0])
    if check.figure == "landing_distance_m":
        return _out_of_reach(flight, figures, check.limit, end)
    if figure_of_merit(check.figure).source in ("contact", "footing"):
        return end
    return figures.get(f"{check.figure.partition('_')[0]}_s", end)


def _out_of_reach(flight: FlightRecords, figures: Mapping[str, float], limit: float, end: float) -> float:
    """Time (s) from which the vehicle was farther beyond a distance of ``limit`` (m) from the landing site
    than it was high, which no descent makes good; mortar fire at the earliest, contact at the latest.
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
    """Faults that were there before a time (s), those of one kind together, in the order of time: with and
    without the times at which they began.
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
    """Whether a fault that began at ``since`` has to do with what was decided at ``until`` (s): it was not
    over when it began, and a wing's only up to the deployment that the wing prepares.
    """
    scenario, name = flight.scenario, fault.acts_on(flight.loaded.truth.components)
    chutes = scenario.vehicle.parachutes
    if fault.component == "surface":
        return until <= _done(flight, ("deploy",), [chute.name for chute in chutes])
    carriers = [chute.carried_by for chute in chutes if chute.name == name and chute.carried_by]
    return since < _done(flight, over_after(fault.kind), [name, *carriers])


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
    """Propellant used up, an engine cut off in the air, and before a crash no parachute, no engine, or no
    landing that keeps the constraints of powered guidance.
    """
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
    """The most constraints that powered guidance relaxed, which it does not do while it can land."""
    times = flight.fsw[0]["guidance"]["relaxed"]["t"]
    noted = np.flatnonzero(times > 0.0)
    if not len(noted):
        return []
    t, words = float(times[noted[-1]]), in_words(int(noted[-1]) + 1)
    (height,) = flight.telemetry.at(t, "truth.height_m")
    return [Consequence(t, words, f"{words} from {height:.0f} m at {t:.1f} s")]


def _engines(flight: FlightRecords) -> list[str]:
    """Names of engines, and of groups of them."""
    vehicle = flight.scenario.vehicle
    return [*(engine.name for engine in vehicle.engines), *vehicle.engine_groups]


def _left_undone(flight: FlightRecords) -> list[Consequence]:
    """What a mission that crashed has not done of what it was to do."""
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
