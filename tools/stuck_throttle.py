"""Dispersed landings whose throttle stands from some time after backshell release on, and healthy ones.

python tools/stuck_throttle.py LAW FLIGHTS [SECONDS ...] [--hazards]

Without a time the engine is healthy, and the flights are counted in which the throttle is nevertheless judged
stuck.  With ``--hazards`` the landings look for a safe spot among rocks.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterable, Sequence
from math import nan
from typing import Any

from edl6dof.campaign.design.case import Case
from edl6dof.campaign.executor import Row, fly_rows
from edl6dof.interface.roles import POWERED_DECELERATION
from edl6dof.scenario.loaded import LoadedScenario
from edl6dof.scenario.loading import load_scenario
from edl6dof.sim.flight import Flight
from edl6dof.studies.hazards import SCENARIO as AMONG_ROCKS
from edl6dof.studies.landing import POWERED, dispersed, with_law

#: Figures of which the largest is told.
FIGURES = ("touchdown_vertical_m_s", "touchdown_horizontal_m_s", "touchdown_tilt_deg", "propellant_used_kg")


def of_flight(flight: Flight) -> dict[str, float]:
    """Thrust (N) that the throttle stands at, and is believed to."""
    return {
        "thrust_held_n": float(flight.plant["thrust_held"][0, 0]),
        "thrust_believed_held_n": float(flight.fsw[0]["vehicle"]["held_thrust"]),
    }


def fly(loaded: LoadedScenario, truths: Sequence[Case], faults: list[dict[str, Any]]) -> list[Row]:
    """The flights with these faults."""
    cases = [
        Case(i, {**one.truth, "faults": faults}, one.belief, one.profile, {}) for i, one in enumerate(truths)
    ]
    return list(fly_rows(loaded, cases, collect=of_flight))


def most(rows: list[Row], name: str) -> float:
    """Largest value of a figure."""
    return max(float(row.get(name, nan)) for row in rows)


def held(rows: Iterable[Row]) -> str:
    """Least and largest thrust that the throttles stand at."""
    thrust = [float(row["thrust_held_n"]) for row in rows]
    return f"{min(thrust):.0f} to {max(thrust):.0f}" if thrust else "none"


def tell(title: str, rows: list[Row]) -> None:
    """Print what came out."""
    within = sum(bool(row["success"]) for row in rows)
    believed = sum(row["thrust_believed_held_n"] > 0.0 for row in rows)
    figures = ", ".join(f"{name} {most(rows, name):.2f}" for name in FIGURES)
    print(f"{title}: {within} of {len(rows)} within limits, {believed} believed to stand; {figures}")


def main() -> None:
    """Print what comes out."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("law")
    parser.add_argument("flights", type=int)
    parser.add_argument(
        "seconds", type=float, nargs="*", help="after backshell release; none: healthy engines"
    )
    parser.add_argument("--hazards", action="store_true", help=f"over the ground of {AMONG_ROCKS}")
    given = parser.parse_args()
    loaded, truths = with_law(given.law), dispersed(given.flights)
    if given.hazards:
        loaded = load_scenario(AMONG_ROCKS, ["simulation.log_every=5", f"{POWERED}.law={given.law}"])
    if not given.seconds:
        tell(f"{given.law}, healthy", fly(loaded, truths, []))
    braking = next(one.name for one in loaded.scenario.mission.phases if one.role == POWERED_DECELERATION)
    for after in given.seconds:
        at = {"phase": braking, "plus_s": after}
        rows = fly(loaded, truths, [{"engine": "main", "at": at, "kind": "throttle_stuck"}])
        tell(f"{given.law}, {after:g} s", rows)
        lost = [row for row in rows if not row["success"]]
        print(f"    thrust, N: {held(rows)}; of those that are lost: {held(lost)}")


if __name__ == "__main__":
    main()
