"""Consistency of navigation: squared error over estimated variance, mean of dispersed flights.

    python tools/consistency.py [--flights 200] [--seed 7] [--scenario tianwen1_mc] [SETTING ...]

The flights land on generated ground with the relief of tianwen1_hazards, since the filter allows for relief;
over the smooth relief of MOLA alone, the height is more accurate than it believes.

One is right; below one the filter believes its errors larger than they are, above one smaller.  A row is a
phase, or the moment ten seconds after mortar fire.  A column is the mean over its axes, over all rows of the
phase in which the covariance is known, and over the flights.  Exit status 1 where a value is outside 0.6 to
1.5.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Mapping

import numpy as np

from edl6dof.campaign.design.plan import load_plan
from edl6dof.campaign.executor import fly_rows
from edl6dof.sim.flight import Flight

LEAST, MOST = 0.6, 1.5
AFTER_MORTAR_S = 10.0
#: Errors and their standard deviations in the telemetry, by column.
QUANTITIES = {
    "position": ("north_m", "east_m", "down_m"),
    "velocity": ("v_north_m_s", "v_east_m_s", "v_down_m_s"),
    "attitude": ("attitude_north_deg", "attitude_east_deg", "attitude_down_deg"),
    "height": ("height_m",),
}
MOMENT = "10 s after mortar fire"
GROUND = (
    *("terrain.landing_area.model=generated", "terrain.landing_area.hurst=0.75"),
    *("terrain.landing_area.rms_slope_deg=2.0", "terrain.landing_area.slope_baseline_m=5.0"),
    *("terrain.landing_area.crater_density_per_km2=20.0", "terrain.landing_area.crater_exponent=2.0"),
)


def consistency(flight: Flight) -> Mapping[str, float]:
    """Squared error over variance of each quantity, mean over the rows of each phase before touchdown."""
    table = flight.telemetry
    t, phase = np.asarray(table["t_s"]), np.asarray(table["guide.phase"])
    known = np.asarray(table["nav.sigma_height_m"]) > 0.0
    known &= t < flight.figures.get("touchdown_s", np.inf)
    parts = {name: known & (phase == index) for index, name in enumerate(flight.scenario.phase_names)}
    at = np.searchsorted(t, flight.figures.get("parachute_s", np.inf) + AFTER_MORTAR_S)
    parts[MOMENT] = np.arange(len(t)) == at
    found = {}
    for quantity, channels in QUANTITIES.items():
        error = np.array([table[f"nav.error_{one}"] for one in channels])
        sigma = np.array([table[f"nav.sigma_{one}"] for one in channels])
        for part, rows in parts.items():
            if rows.any():
                found[f"{part}/{quantity}"] = float(((error[:, rows] / sigma[:, rows]) ** 2).mean())
    return found


def main() -> int:
    """Fly and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--flights", type=int, default=200)
    parser.add_argument("--seed", type=int)
    parser.add_argument("--scenario", default="tianwen1_mc")
    parser.add_argument("settings", nargs="*")
    given = parser.parse_args()
    plan = load_plan(given.scenario, (*GROUND, *given.settings), seed=given.seed)
    rows = list(fly_rows(plan.loaded, plan.cases(0, given.flights), collect=consistency))
    names = [name for name in dict.fromkeys(key for row in rows for key in row) if "/" in name]
    met = True
    print(f"{'':28}" + "".join(f"{quantity:>10}" for quantity in QUANTITIES) + "   flights")
    parts = list(dict.fromkeys(name.split("/")[0] for name in names))
    for part in parts:
        values = [[row[f"{part}/{q}"] for row in rows if f"{part}/{q}" in row] for q in QUANTITIES]
        means = [float(np.mean(value)) for value in values]
        met &= all(LEAST <= mean <= MOST for mean in means)
        print(f"{part:28}" + "".join(f"{mean:10.2f}" for mean in means) + f"{len(values[0]):10}")
    return 0 if met else 1


if __name__ == "__main__":
    sys.exit(main())
