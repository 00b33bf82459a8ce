"""Least distance from backshell and canopy in winds that the flight computer does not expect.

    python tools/separation.py [--flights 500]

Flights of ``tianwen1_mc`` in a constant wind of 0 to 25 m/s from any direction, by the plain divert rule
(``given``) and by the choice of hazard detection (``lidar``) over the same ground.  Exit status 1 where fewer
than 99.5 % of the flights keep 60 m.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import replace
from math import cos, pi, sin, sqrt

import numpy as np

import edl6dof
from edl6dof.campaign.design.plan import load_plan
from edl6dof.campaign.executor import fly_rows

STRONGEST_M_S, CLEAR_M, SHARE = 25.0, 60.0, 0.995
AIR = ("atmosphere.perturbation.enabled=true", "wind.gust.enabled=true", "wind.model=constant")
GOLDEN_ANGLE = pi * (3.0 - sqrt(5.0))


def main() -> int:
    """Fly and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--flights", type=int, default=500)
    flights, met = parser.parse_args().flights, True
    print("detection   flights   m: least   0.5 %     5 %  median   below 60 m")
    for way in ("given", "lidar"):
        settings = [*AIR, "simulation.log_every=5", f"flight_software.hazard.detection={way}"]
        loaded = edl6dof.load("tianwen1_hazards", settings)
        cases = []
        for k, case in enumerate(load_plan("tianwen1_mc").cases(0, flights)):
            speed, angle = STRONGEST_M_S * (k + 0.5) / flights, k * GOLDEN_ANGLE
            wind = {"east": speed * sin(angle), "north": speed * cos(angle)}
            blows = {f"wind.constant.{axis}_m_s": value for axis, value in wind.items()}
            cases.append(replace(case, truth={**case.truth, **blows, "wind.scale": 1.0}))
        rows = fly_rows(loaded, cases)
        least = np.array([row["min_drift_distance_m"] for row in rows if "min_drift_distance_m" in row])
        near = int((least < CLEAR_M).sum())
        met &= near <= (1.0 - SHARE) * len(least)
        quantiles = "".join(f"{value:8.1f}" for value in np.percentile(least, (0.5, 5.0, 50.0)))
        print(f"{way:9} {len(least):9} {least.min():10.1f}{quantiles} {near:12}", flush=True)
    return 0 if met else 1


if __name__ == "__main__":
    sys.exit(main())
