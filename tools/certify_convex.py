"""Certify convex guidance against Clarabel: random ignition states, planned by the kernels of the flight
computer with free time, then solved again for that time by an interior-point method.

    python tools/certify_convex.py [STATES] [SEED]
"""

from __future__ import annotations

import sys
import time
from dataclasses import replace
from math import radians

import numpy as np
from point_mass_landing import Landing, first_guess, held_controls, landing_record, plan_onboard, solve

from edl6dof.fsw.guidance.powered.convex import pipg
from edl6dof.fsw.guidance.powered.convex.landing_plan import CONTROLS

#: Error of the end of a plan (m, m/s) up to which it lands.
LANDS = 1.0


def random_landing(rng: np.random.Generator) -> Landing:
    """An ignition state of a Tianwen-1 lander, far wider than the dispersed flights have them."""
    return Landing(
        mass=rng.uniform(880.0, 1000.0),
        thrust=(1500.0, 4500.0),
        exhaust_speed=300.0 * 9.80665,
        gravity=3.72,
        position=(rng.uniform(-600.0, 600.0), rng.uniform(-600.0, 600.0), rng.uniform(900.0, 1800.0)),
        velocity=(rng.normal(0.0, 12.0), rng.normal(0.0, 12.0), rng.uniform(-95.0, -40.0)),
        glide_slope=radians(10.0),
        tilt=radians(25.0),
        end_tilt=radians(3.0),
        full_thrust=7500.0,
    )


def end_error(plan: np.void) -> float:
    """How far from rest at the target a plan ends, m and m/s."""
    return float(plan["miss"] + plan["height_error"] + np.linalg.norm(plan["end_velocity"]))


def compare(landing: Landing, flight: float, seconds: list[float]) -> tuple[str, float]:
    """Which of the two lands in ``flight`` s, and the fuel of the kernels over that of Clarabel, less 1."""
    record, plan = landing_record(landing), first_guess(landing, flight)
    begin = time.thread_time()
    pipg.solve(record[0], 3000, plan[0])
    seconds.append(time.thread_time() - begin)
    lands = end_error(plan[0]) <= LANDS
    reference = solve(landing, held_controls(flight, CONTROLS, landing.full_time))
    if reference is None:
        return ("kernels alone, within 1 m" if lands else "none"), 0.0
    return ("both" if lands else "Clarabel alone"), float(plan[0]["fuel"]) / reference.fuel - 1.0


def report(title: str, rows: list[tuple[str, float]]) -> None:
    """Print who lands how often, and the differences of fuel."""
    kinds = {kind: sum(row[0] == kind for row in rows) for kind in dict(rows)}
    percent = 100.0 * np.abs([difference for kind, difference in rows if kind == "both"])
    print(f"{title}: lands {kinds}; fuel against Clarabel, %: ", end="")
    print(f"median {np.median(percent):.4f}, 99 % {np.quantile(percent, 0.99):.4f}, most {percent.max():.4f}")


def main() -> None:
    """Print what comes out."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 500
    rng = np.random.default_rng(int(sys.argv[2]) if len(sys.argv) > 2 else 1)
    best, later, planning, solving, flagged = [], [], [], [], 0
    plan_onboard(random_landing(np.random.default_rng(0)), 8.0, 30.0)
    for _ in range(count):
        landing = random_landing(rng)
        begin = time.thread_time()
        plan = plan_onboard(landing, 8.0, -2.0 * landing.position[2] / landing.velocity[2])[0]
        planning.append(time.thread_time() - begin)
        flagged += end_error(plan) > LANDS
        flight, full = float(plan["time"]), float(plan["full_time"])
        best.append(compare(replace(landing, full_time=full), flight, solving))
        later.append(compare(replace(landing, full_time=full), 1.01 * flight, solving))
    print(f"{count} states, {flagged} of them flagged: no plan lands")
    report("best time", best)
    report("1 % later", later)
    for name, values in (("solution from nothing", solving), ("first plan", planning)):
        median, high, most = np.quantile(values, (0.5, 0.99, 1.0)) * 1e3
        print(f"{name}, ms of one core: median {median:.2f}, 99 % {high:.2f}, most {most:.2f}")


if __name__ == "__main__":
    main()
