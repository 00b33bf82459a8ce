"""What is flown: the landing with its nutation in any phase, for different persistences of the flag, and with
one guard at a time.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from math import degrees, nan
from typing import NamedTuple

import numpy as np

from edl6dof.campaign.design.case import Case
from edl6dof.scenario.loading import LoadedScenario, load_scenario
from edl6dof.sim.flight import Flight
from edl6dof.sim.outcome import LANDED, TIPPED_OVER

SCENARIO = "schiaparelli"
_NAVIGATION = "flight_software.navigation"
_GYROS = "sensors.inertial_unit.gyros"
PERSISTENCE = f"{_GYROS}.persistence_s"
#: Time for which the flag of saturation stays on, s: what was believed, what was flown, and around them.
PERSISTENCES = (0.015, 0.1, 0.2, 0.3, 0.5, 1.0, 1.5)
#: Seconds after the mortar in which the canopy opens and the capsule swings.
SWINGING_S = 15.0
#: Of the phases that are drawn.
_SEED = 20161019


class Guard(NamedTuple):
    """One way out: its name, what it is, and the overrides that switch it on."""

    name: str
    meaning: str
    overrides: tuple[str, ...] = ()


#: Two gyros between pitch and yaw beside the three.
_SKEW = (("gd", (0.0, 0.5**0.5, 0.5**0.5)), ("ge", (0.0, 0.5**0.5, -(0.5**0.5))))


def _five_gyros() -> str:
    """Three gyros along the axes and two between pitch and yaw: of five, one that is wrong can be named."""
    axes = [*zip(("gx", "gy", "gz"), np.eye(3).tolist(), strict=True), *_SKEW]
    return f"{_GYROS}.axes={json.dumps([{'name': name, 'axis': list(axis)} for name, axis in axes])}"


GUARDS = (
    Guard("nothing", "as flown"),
    Guard("sign", "a height below the ground", (f"{_NAVIGATION}.guards.below_ground=true",)),
    Guard("parity", "five gyros that check each other", (_five_gyros(),)),
    Guard("consistency", "speed against the beams", (f"{_NAVIGATION}.guards.speed=true",)),
    Guard("persistence", "flag on for 15 ms", (f"{PERSISTENCE}=0.015",)),
    Guard("vertical", "echo from above the horizon", (f"{_NAVIGATION}.guards.vertical=true",)),
    Guard("left out", "flagged gyro not used", (f"{_NAVIGATION}.saturation.left_out=true",)),
    Guard("jump", "height that jumps", (f"{_NAVIGATION}.guards.jump=true",)),
)


def loaded(*overrides: str) -> LoadedScenario:
    """The landing with some overrides."""
    return load_scenario(SCENARIO, overrides)


def phases(flights: int, **label: str | float) -> list[Case]:
    """Flights whose nutation has any phase at entry, each in gusts of its own; the first of a longer series
    are those of a shorter one.
    """
    bank = np.random.default_rng(_SEED).uniform(-180.0, 180.0, flights)
    return [
        Case(k, truth={"initial.bank_deg": round(float(b), 3)}, profile=k, label=label)
        for k, b in enumerate(bank)
    ]


def swing(flight: Flight) -> dict[str, float]:
    """How the capsule swung under the opening canopy, what the gyros said, how the vertical was off after it,
    and whether the flight neither landed nor only tipped over.
    """
    crashed = float(flight.code not in (LANDED, TIPPED_OVER))
    t, fired = flight.telemetry["t_s"], flight.metrics.get("parachute_s", nan)
    after = (t > fired) & (t < fired + SWINGING_S)
    crashed = float(flight.code not in (LANDED, TIPPED_OVER))
    if not after.any():
        return {
            "swing_deg_s": nan,
            "flagged_s": nan,
            "vertical_deg": nan,
            "check_fails_s": nan,
            "crashed": crashed,
        }
    rates = [np.abs(flight.telemetry[f"truth.rate_{axis}_deg_s"][after]) for axis in "qr"]
    flagged = flight.telemetry["sensed.gyros_saturated"][after] > 0
    step = float(np.median(np.diff(t)))
    return {
        "swing_deg_s": float(np.max(rates)),
        "flagged_s": float(np.count_nonzero(flagged)) * step,
        "vertical_deg": vertical_error(flight, int(np.flatnonzero(after)[-1])),
        "check_fails_s": _first_failed_check(flight) - fired,
        "crashed": crashed,
    }


def vertical_error(flight: Flight, row: int) -> float:
    """Angle (deg) between the true vertical and the one on board, of the rotation between both attitudes."""
    north, east, down = (
        np.radians(flight.telemetry[f"nav.error_attitude_{axis}_deg"][row])
        for axis in ("north", "east", "down")
    )
    angle = np.sqrt(north**2 + east**2 + down**2)
    if angle < 1e-9:
        return 0.0
    across = np.hypot(north, east) / angle
    return degrees(2.0 * np.arcsin(min(across * np.sin(0.5 * min(angle, np.pi)), 1.0)))


def _first_failed_check(flight: Flight) -> float:
    """Flight time (s) of the first failed check of a guard; ``nan`` without one."""
    times = [event["t_s"] for event in flight.events if event["key"] == "guard"]
    return min(times, default=nan)


def all_cases(flights: int) -> Iterator[tuple[tuple[str, ...], list[Case]]]:
    """Overrides and flights of every row of the two tables: the persistences, then the guards."""
    for persistence in PERSISTENCES:
        yield (
            (f"{PERSISTENCE}={persistence}",),
            phases(flights, sweep="persistence", guard="nothing", persistence_s=persistence),
        )
    for guard in GUARDS:
        yield guard.overrides, phases(flights, sweep="guard", guard=guard.name, persistence_s=nan)
