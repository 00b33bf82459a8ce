"""Least distance from backshell and canopy in winds that the flight computer does not expect.

    python tools/separation.py [--flights 500] [--seed 7]

Flights of ``tianwen1_mc`` in a constant wind of 0 to 25 m/s from any direction, by the plain divert rule
(``given``) and by the choice of hazard detection (``lidar``) over the same ground; and the error of the path
that the flight computer predicts with the wind at the release (standard deviation of each axis on the ground,
over the time of fall).  Exit status 1 where fewer than 99.5 % of the flights keep 60 m.
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
from edl6dof.sim.flight import Flight

STRONGEST_M_S, CLEAR_M, SHARE = 25.0, 60.0, 0.995
AIR = ("atmosphere.perturbation.enabled=true", "wind.gust.enabled=true", "wind.model=constant")
GOLDEN_ANGLE = pi * (3.0 - sqrt(5.0))


def main() -> int:
    """Fly and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--flights", type=int, default=500)
    parser.add_argument("--seed", type=int, help="of the dispersions (default: that of tianwen1_mc)")
    options = parser.parse_args()
    flights, met = options.flights, True
    print("detection   flights   m: least   0.5 %     5 %  median   below 60 m   choice   path error, m/s")
    for way in ("given", "lidar"):
        settings = [*AIR, "simulation.log_every=5", f"flight_software.hazard.detection={way}"]
        loaded = edl6dof.load("tianwen1_hazards", settings)
        cases = []
        for k, case in enumerate(load_plan("tianwen1_mc", seed=options.seed).cases(0, flights)):
            speed, angle = STRONGEST_M_S * (k + 0.5) / flights, k * GOLDEN_ANGLE
            wind = {"east": speed * sin(angle), "north": speed * cos(angle)}
            blows = {f"wind.constant.{axis}_m_s": value for axis, value in wind.items()}
            cases.append(replace(case, truth={**case.truth, **blows, "wind.scale": 1.0}))
        rows = list(fly_rows(loaded, cases, collect=_path_error))
        least = np.array([row["min_drift_distance_m"] for row in rows if "min_drift_distance_m" in row])
        chosen, error = (
            np.array([row[name] for row in rows if name in row])
            for name in ("coarse_clear_m", "path_error_m_s")
        )
        near = int((least < CLEAR_M).sum())
        met &= near <= (1.0 - SHARE) * len(least)
        quantiles = "".join(f"{value:8.1f}" for value in np.percentile(least, (0.5, 5.0, 50.0)))
        text = f"{np.sqrt(0.5 * np.mean(error**2)):17.2f}" if len(error) else ""
        print(
            f"{way:9} {len(least):9} {least.min():10.1f}{quantiles} {near:12}{len(chosen):9}{text}",
            flush=True,
        )
    return 0 if met else 1


def _path_error(flight: Flight) -> dict[str, float]:
    """Distance of the backshell on the ground from its predicted place there, over the time of fall."""
    path, places = flight.fsw[0]["hazard"]["coarse"]["drift"][-1], flight.telemetry
    last = int(path["count"]) - 1
    if last < 1:
        return {}
    fell = np.column_stack([places[f"truth.backshell_{axis}_m"] for axis in ("east", "north")])
    released = np.column_stack([places[f"truth.site_{axis}_m"] for axis in ("east", "north")])
    there = np.flatnonzero(np.isfinite(fell[:, 0]))
    way = fell[there[-1]] - released[there[0]]
    predicted = path["place_L"][last, :2] - path["place_L"][0, :2]
    return {"path_error_m_s": float(np.hypot(*(way - predicted)) / last)}


if __name__ == "__main__":
    sys.exit(main())
