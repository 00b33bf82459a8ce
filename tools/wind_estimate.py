"""Angle of attack at mortar fire, and error of the estimated wind there, in winds that nobody expects.

    python tools/wind_estimate.py [--flights 1000] [--seed 7311] [--mission tianwen1] [--set PATH=VALUE ...]

Flights of the mission's campaign in a constant wind of 0 to 60 m/s from any direction, with gusts and density
waves.
The wind error contains the gust at that moment.  Exit status 1 where more than 1 % of the flights exceed
3 deg, or the error of a component exceeds 8 m/s (root mean square).
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import replace
from math import cos, sin

import numpy as np
from separation import AIR, GOLDEN_ANGLE

import edl6dof
from edl6dof.campaign.design.plan import load_plan
from edl6dof.campaign.executor import fly_rows
from edl6dof.campaign.statistics import quantile
from edl6dof.sim.flight import Flight

STRONGEST_M_S, ANGLE_DEG, SHARE, WIND_M_S = 60.0, 3.0, 0.99, 8.0


def wind_error(flight: Flight) -> dict[str, float]:
    """Error of the estimated wind at mortar fire along and across the flight, m/s."""
    mortar = flight.figures.get("parachute_s")
    if mortar is None:
        return {}
    at = flight.telemetry.at
    names = ("nav.wind_north_m_s", "nav.wind_east_m_s", "truth.wind_north_m_s", "truth.wind_east_m_s")
    north, east, true_north, true_east = at(mortar - 0.1, *names)
    (azimuth,) = np.radians(at(mortar - 0.1, "truth.azimuth_deg"))
    north, east = north - true_north, east - true_east
    along = north * cos(azimuth) + east * sin(azimuth)
    return {"along_m_s": along, "across_m_s": east * cos(azimuth) - north * sin(azimuth)}


def main() -> int:
    """Fly and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--flights", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=7311)
    parser.add_argument("--mission", default="tianwen1", help="scenario; its campaign has the suffix _mc")
    parser.add_argument(
        "--set", action="append", default=[], metavar="PATH=VALUE", help="as edl6dof fly --set"
    )
    given = parser.parse_args()
    loaded, cases = edl6dof.load(given.mission, [*AIR, *given.set]), []
    for k, case in enumerate(load_plan(f"{given.mission}_mc", seed=given.seed).cases(0, given.flights)):
        speed, angle = STRONGEST_M_S * (k + 0.5) / given.flights, k * GOLDEN_ANGLE
        blows = {"east": speed * sin(angle), "north": speed * cos(angle)}
        wind = {f"wind.constant.{axis}_m_s": value for axis, value in blows.items()}
        cases.append(replace(case, truth={**case.truth, **wind, "wind.scale": 1.0}))
    rows = [row for row in fly_rows(loaded, cases, collect=wind_error) if "along_m_s" in row]
    alpha, along, across = (
        np.array([row[name] for row in rows])
        for name in ("parachute_total_alpha_deg", "along_m_s", "across_m_s")
    )
    print(f"{len(rows)} of {given.flights} flights reach mortar fire")
    for share in (0.5, 0.95, SHARE):
        if (found := quantile(alpha, share)) is not None:
            bounds = f"({found.low:.2f} .. {found.high:.2f})"
            print(f"total angle of attack, {share:.0%}: {found.value:.2f} {bounds} deg")
    sizes = [float(np.sqrt(np.mean(error**2))) for error in (along, across)]
    both = float(np.sqrt(0.5 * (sizes[0] ** 2 + sizes[1] ** 2)))
    print(f"largest: {alpha.max():.2f} deg; above {ANGLE_DEG:g} deg: {int((alpha > ANGLE_DEG).sum())}")
    print(f"wind error, rms: along {sizes[0]:.1f}, across {sizes[1]:.1f}, of a component {both:.1f} m/s")
    return 0 if np.mean(alpha > ANGLE_DEG) <= 1.0 - SHARE and both <= WIND_M_S else 1


if __name__ == "__main__":
    sys.exit(main())
