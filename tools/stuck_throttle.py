"""Dispersed landings whose throttle stands from some time after backshell release on.

python tools/stuck_throttle.py LAW FLIGHTS SECONDS [SECONDS ...]
"""

from __future__ import annotations

import sys
from math import nan

from edl6dof.campaign.design.case import Case
from edl6dof.campaign.executor import fly_rows
from edl6dof.campaign.rows import Row
from edl6dof.fsw.mission.roles import POWERED_DECELERATION
from edl6dof.sim.flight import Flight
from edl6dof.studies.landing.conditions import dispersed, with_law

#: Figures of which the largest is told.
FIGURES = ("touchdown_vertical_m_s", "touchdown_horizontal_m_s", "touchdown_tilt_deg", "propellant_used_kg")


def of_flight(flight: Flight) -> dict[str, float]:
    """Thrust (N) that the throttle stands at."""
    return {"thrust_held_n": float(flight.plant["thrust_held"][0, 0])}


def most(rows: list[Row], name: str) -> float:
    """Largest value of a figure."""
    return max(float(row.get(name, nan)) for row in rows)


def main() -> None:
    """Print what comes out."""
    law, flights = sys.argv[1], int(sys.argv[2])
    loaded, truths = with_law(law), dispersed(flights)
    braking = next(one.name for one in loaded.scenario.mission.phases if one.role == POWERED_DECELERATION)
    for after in map(float, sys.argv[3:]):
        at = {"phase": braking, "plus_s": after}
        fault = {"engine": "main", "at": at, "kind": "throttle_stuck"}
        cases = [
            Case(i, {**one.truth, "faults": [fault]}, one.belief, one.profile, {})
            for i, one in enumerate(truths)
        ]
        rows = list(fly_rows(loaded, cases, collect=of_flight))
        within = sum(bool(row["success"]) for row in rows)
        held = sorted(float(row["thrust_held_n"]) for row in rows)
        figures = ", ".join(f"{name} {most(rows, name):.2f}" for name in FIGURES)
        print(f"{law}, {after:g} s: {within} of {len(rows)} within limits; {figures}")
        print(f"    thrust {held[0]:.0f} to {held[-1]:.0f} N")


if __name__ == "__main__":
    main()
