"""Radar beams and navigation over planes of 0 to 20 deg and over hills, with all beams and with a failed one.

    python tools/slopes.py [--flights 12]

Each row flies so many cases, each with its own seed and direction of the slope.  Wrong exclusions are beams
that had not failed; the error of velocity is the largest of the last 40 s.  The chosen spot is that of
tianwen1_hazards on the same planes.  Exit status 1 where a healthy beam is excluded, a failed one is not, the
error of velocity exceeds 0.05 m/s, or the spot is missed by more than 1.5 m.
"""

from __future__ import annotations

import argparse
import sys
from typing import NamedTuple

import numpy as np

import edl6dof
from edl6dof.campaign.executor import in_threads

PLANES_DEG = (0, 4, 8, 12, 16, 20)
HILLS_DEG = (4, 8)  # RMS slope over 100 m
LIMIT_M_S, MISS_M = 0.05, 1.5
FAULT = "faults=[{kind: false_lock, beam: b2, at: {time_s: 100}}]"


class Row(NamedTuple):
    """What the cases of one kind of ground came to."""

    landed: int
    within: int
    wrong: int
    found: int
    velocity_m_s: float
    height_m: float
    miss_m: float


def plane(slope_deg: float, case: int) -> list[str]:
    """Settings of a plane that falls in the direction of this case."""
    return [
        f"terrain.slope_deg={slope_deg}",
        f"terrain.slope_azimuth_deg={(case * 137.5) % 360.0}",
        "terrain.slope_radius_m=20000",
    ]


def hills(rms_slope_deg: float, case: int) -> list[str]:
    """Settings of rolling ground: wavelengths up to 800 m."""
    relief = f"hurst: 0.95, rms_slope_deg: {rms_slope_deg}, slope_baseline_m: 100"
    return [f"terrain.landing_area={{model: generated, {relief}, crater_density_per_km2: 0}}"]


def fly(ground: list[str], case: int, faulty: bool) -> edl6dof.Flight:
    """One flight of Tianwen-1."""
    return edl6dof.fly("tianwen1", [*ground, f"seed={case}", *([FAULT] if faulty else [])])


def miss(ground: list[str], case: int) -> float:
    """Distance (m) of the touchdown from the spot that hazard detection chose; 0 over hills."""
    if ground[0].startswith("terrain.landing_area"):
        return 0.0
    return float(edl6dof.fly("tianwen1_hazards", [*ground, f"seed={case}"]).figures["spot_miss_m"])


def measure(settings: list[list[str]], faulty: bool) -> Row:
    """Fly the cases of one row."""
    landed = within = wrong = found = 0
    velocity, height = [], []
    numbers = list(enumerate(settings, start=1))
    for flight in in_threads(lambda one: fly(one[1], one[0], faulty), numbers):
        beams = {one.instrument for one in flight.exclusions if one.component == "beam"}
        wrong += len(beams - ({"b2"} if faulty else set()))
        found += "b2" in beams
        landed += flight.landed
        within += flight.success
        table, end = flight.telemetry, flight.figures["touchdown_s"]
        t = np.asarray(table["t_s"])
        errors = np.array([table[f"nav.error_v_{axis}_m_s"] for axis in ("north", "east", "down")])
        last = (t > end - 40.0) & (t < end)
        velocity.append(np.sqrt((errors**2).sum(axis=0))[last].max())
        height.append(np.abs(np.asarray(table["nav.error_height_m"]))[last & (t > end - 10.0)].max())
    missed = 0.0 if faulty else max(in_threads(lambda one: miss(one[1], one[0]), numbers))
    return Row(landed, within, wrong, found, max(velocity), max(height), missed)


def main() -> int:
    """Fly the rows and print them."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--flights", type=int, default=12, help="cases of each row")
    cases = range(1, parser.parse_args().flights + 1)
    rows = [(f"plane, {slope} deg", [plane(slope, case) for case in cases]) for slope in PLANES_DEG]
    rows += [(f"hills, {slope} deg RMS", [hills(slope, case) for case in cases]) for slope in HILLS_DEG]
    print(f"{'beams excluded   largest error, last       chosen spot':>99}")
    print(
        "ground            b2      landed  within     failed    healthy   40 s, m/s       10 s, m   missed, m"
    )
    met = True
    for name, settings in rows:
        for faulty in (False, True):
            row = measure(settings, faulty)
            met &= row.wrong == 0 and row.velocity_m_s < LIMIT_M_S and row.found == faulty * len(settings)
            met &= row.miss_m <= MISS_M
            print(
                f"{name:17} {'locked' if faulty else 'intact':6} {row.landed:7} {row.within:7}"
                f" {row.found if faulty else '-':>11} {row.wrong:11}"
                f" {row.velocity_m_s:11.3f} {row.height_m:13.2f}"
                f" {f'{row.miss_m:13.2f}' if row.miss_m else '            -'}",
                flush=True,
            )
    return 0 if met else 1


if __name__ == "__main__":
    sys.exit(main())
