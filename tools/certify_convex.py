"""Certify convex guidance against Clarabel: random ignition states, planned by the kernels of the flight
computer with free time, then solved again for that time by an interior-point method.

    python tools/certify_convex.py [STATES] [SEED]
"""

from __future__ import annotations

import sys
import time
from math import radians

import numpy as np

from edl6dof.design.landing.conic import solve
from edl6dof.design.landing.onboard import first_guess, landing_record, plan_onboard
from edl6dof.design.landing.problem import Landing, held_controls
from edl6dof.fsw.guidance.powered.convex import pipg
from edl6dof.fsw.guidance.powered.convex.problem import CONTROLS

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


def main() -> None:
    """Print what comes out."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 500
    rng = np.random.default_rng(int(sys.argv[2]) if len(sys.argv) > 2 else 1)
    differences, planning, solving, iterations, flagged, wrong = [], [], [], [], 0, 0
    plan_onboard(random_landing(np.random.default_rng(0)), 8.0, 30.0)
    for _ in range(count):
        landing = random_landing(rng)
        begin = time.thread_time()
        plan = plan_onboard(landing, 8.0, -2.0 * landing.position[2] / landing.velocity[2])[0]
        planning.append(time.thread_time() - begin)
        flight, full = float(plan["time"]), float(plan["full_time"])
        own = Landing(**{**landing.__dict__, "full_time": full})
        record, cold = landing_record(own), first_guess(own, flight)
        begin = time.thread_time()
        pipg.solve(record[0], 3000, cold[0])
        solving.append(time.thread_time() - begin)
        iterations.append(int(cold[0]["iterations"]))
        error = cold[0]["miss"] + cold[0]["height_error"] + float(np.linalg.norm(cold[0]["end_velocity"]))
        reference = solve(own, held_controls(flight, CONTROLS, full))
        if error > LANDS:
            flagged += 1
            wrong += reference is not None
        elif reference is not None:
            differences.append(float(cold[0]["fuel"]) / reference.fuel - 1.0)
        else:
            wrong += 1
    percent = 100.0 * np.abs(differences)
    print(f"{count} states: {len(differences)} land, {flagged} flagged, {wrong} where Clarabel disagrees")
    print(f"fuel against Clarabel, %: median {np.median(percent):.4f}, largest {np.max(percent):.4f}")
    for name, values in (("solution", solving), ("first plan", planning)):
        median, high, most = np.quantile(values, (0.5, 0.99, 1.0)) * 1e3
        print(f"{name}, ms of one core: median {median:.2f}, 99 % {high:.2f}, most {most:.2f}")
    print(f"iterations from nothing: median {np.median(iterations):.0f}, most {max(iterations)}")


if __name__ == "__main__":
    main()
