"""The timeline of a flight: phases, deployments, faults, bank reversals, touchdown, outcome."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import isfinite
from typing import Any

import numpy as np

#: Plain names of what the vehicle does once, or is told to do: that the wing opens is another event.  In the order of
#: ``edl6dof.vehicle.plant.EVENTS``.
DEPLOYMENTS = (
    "trim wing commanded",
    "mortar fires",
    "heat shield jettisoned",
    "landing legs out",
    "backshell released",
    "engine ignition",
    "engine cut-off",
)
KEYS = ("trim_wing", "mortar", "heat_shield", "landing_legs", "backshell", "ignition", "cut_off")

#: Time (s), key and plain name of something that happened.
Moment = tuple[float, str, str]


def timeline(
    telemetry: Mapping[str, np.ndarray],
    plant: np.void,
    fsw: np.void,
    phases: list[str],
    ending: str,
    others: Sequence[Moment] = (),
) -> list[dict[str, Any]]:
    """Events in order of time, each with ``t_s``, ``key``, ``name`` and the state of the vehicle then.

    ``others`` are more of them, as time, key and name: the trim wing open, faults and what was found out about them.
    """
    reversals = [(t, "bank_reversal", f"bank reversal to {side}") for t, side in bank_reversals(telemetry)]
    found = [*others, *moments(plant, fsw, phases), *reversals, (float(plant["t"]), "end", ending)]
    return [_with_state(telemetry, *event) for event in sorted(found, key=lambda event: event[0])]


def moments(plant: np.void, fsw: np.void, phases: list[str]) -> list[Moment]:
    """What plant and flight computer note themselves when it happens, each at most once; no telemetry is needed for it."""
    found = [(float(t), f"phase.{name}", f"phase {name}") for name, t in zip(phases, fsw["entered"], strict=False)]
    found += [(float(t), key, name) for key, name, t in zip(KEYS, DEPLOYMENTS, plant["done"], strict=True)]
    if plant["line_stretch_time"] < 1e9:
        found.append((float(plant["line_stretch_time"]), "line_stretch", "line stretch, inflation begins"))
    found.append((float(plant["exhausted_time"]), "propellant_exhausted", "propellant exhausted"))
    found.append((float(plant["touchdown_time"]), "touchdown", "touchdown, first footpad"))
    return [moment for moment in found if isfinite(moment[0])]


def bank_reversals(telemetry: Mapping[str, np.ndarray]) -> list[tuple[float, str]]:
    """Times (s) at which the commanded bank angle changes sign, and the new side."""
    t, bank = telemetry["t_s"], telemetry["guide.bank_deg"]
    steps = np.flatnonzero(bank[1:] * bank[:-1] < 0.0) + 1
    return [(float(t[i]), "right" if bank[i] > 0.0 else "left") for i in steps]


def _with_state(telemetry: Mapping[str, np.ndarray], t: float, key: str, name: str) -> dict[str, Any]:
    i = min(int(np.searchsorted(telemetry["t_s"], t - 1e-9)), len(telemetry["t_s"]) - 1)
    row = {
        "altitude_m": telemetry["truth.altitude_m"][i],
        "height_m": telemetry["truth.height_m"][i],
        "speed_m_s": telemetry["truth.speed_m_s"][i],
        "mach": telemetry["truth.mach"][i],
    }
    known = t >= telemetry["t_s"][0] - 1e-9  # a flight that goes on from a saved state has no telemetry of what was before
    values = {column: float(value) if known and abs(value) < 1e9 else None for column, value in row.items()}
    return {"t_s": t, "key": key, "name": name, "detail": _in_words(values), **values}


def _in_words(values: Mapping[str, float | None]) -> str:
    """Altitude, speed and Mach number, as far as they are known."""
    forms = (("altitude_m", 1e-3, "{:.1f} km"), ("speed_m_s", 1.0, "{:.0f} m/s"), ("mach", 1.0, "Mach {:.2f}"))
    return ", ".join(form.format(factor * value) for name, factor, form in forms if (value := values[name]) is not None)
