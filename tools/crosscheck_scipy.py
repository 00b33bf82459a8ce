"""Integrate the simulator's right-hand side with scipy and print the difference to its own Runge-Kutta steps,
phase by phase.

    python tools/crosscheck_scipy.py [--window 60] [--tolerance 1e-11] [--compiled]

From a state saved in each phase of the nominal flight both fly on with the flight software off: valves shut,
engine command held, nothing due.  The simulator flies compiled, with 10 ms Runge-Kutta steps; scipy's DOP853
works at tight tolerance on the same source as plain Python (numba off, a process of its own).  Windows of
phases that end in tumbling or at the ground without flight software are shorter; ``--compiled`` gives scipy
the compiled right-hand side, which is much quicker.
"""

from __future__ import annotations

import argparse
import sys
import time

import numpy as np
from plain_python import Setting, in_plain_python, integrate, setting

import edl6dof
from edl6dof.interface.roles import (
    HAZARD_AVOIDANCE,
    HOVER_IMAGING,
    LIFT,
    PARACHUTE,
    POWERED_DECELERATION,
    SLOW_DESCENT,
    TRIM,
)
from edl6dof.sim.checkpoint import State
from edl6dof.sim.flight import fly
from edl6dof.vehicle.motion.integrate import advance
from edl6dof.vehicle.motion.runge_kutta import evaluate
from edl6dof.vehicle.plant import CANOPY_POSITION, CANOPY_VELOCITY

#: Seconds after the start of a phase at which its window begins, by its role: past deployments, on a smooth
#: stretch.
BEGIN = {TRIM: 5.0, LIFT: 20.0, PARACHUTE: 5.0, POWERED_DECELERATION: 3.0}
#: Longest window (s) without flight software, by role: beyond it the vehicle tumbles or meets the ground.
LONGEST = {POWERED_DECELERATION: 8.0, HOVER_IMAGING: 5.0, HAZARD_AVOIDANCE: 5.0, SLOW_DESCENT: 2.0}
#: What is compared: name and place in the state.
PARTS = {
    "position m": slice(0, 3), "velocity m/s": slice(3, 6), "attitude": slice(6, 10),
    "rate rad/s": slice(10, 13), "canopy m": slice(CANOPY_POSITION, CANOPY_VELOCITY)
}  # fmt: skip


def quiet(state: State) -> State:
    """The state with valves shut and nothing due."""
    plant = state.plant.copy()
    for name in ("open_time", "close_time", "level"):
        plant["valves"][name] = 0.0
    for name in ("rcs_force", "rcs_moment", "rcs_flow"):
        plant["inputs"][name] = 0.0
    plant["due"] = 1e99
    return State(state.cycle, plant, state.peaks, state.sensors, state.fsw, "")


def runge_kutta(given: Setting, seconds: float) -> np.ndarray:
    """State after the window in the simulator's own steps."""
    plant = given.arrays["plant"].copy()
    start = float(plant["t"][0])
    records = {**given.arrays, "plant": plant}
    flown = [records[name][0] for name in ("case", "tables", "plant", "outputs", "work")]
    evaluate(*flown)
    for k in range(round(seconds / 0.01)):
        advance(*flown, start + 0.01 * (k + 1))
    if plant["touched"][0]:
        raise RuntimeError("the window reaches the ground")
    return plant["y"][0]


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--window", type=float, default=60.0, help="longest window, s")
    parser.add_argument("--tolerance", type=float, default=1e-11, help="relative tolerance of DOP853")
    parser.add_argument("--compiled", action="store_true", help="scipy on the compiled right-hand side")
    options = parser.parse_args()
    loaded = edl6dof.load("tianwen1")
    nominal = fly(loaded)
    print(
        f"{'phase':20} {'t s':>6} {'window s':>8} {' '.join(f'{name:>12}' for name in PARTS)} {'calls':>7} "
        f"{'took s':>7}"
    )
    for index, phase in enumerate(nominal.scenario.mission.phases[:-1]):
        begin = float(nominal.fsw["mission"]["entered"][0, index]) + BEGIN.get(phase.role, 0.5)
        seconds = min(options.window, LONGEST.get(phase.role, 60.0))
        state = fly(loaded, save_at_s=begin).saved
        if state is None:
            continue
        given = setting(loaded, quiet(state))
        own = runge_kutta(given, seconds)
        clock = time.perf_counter()
        arguments = (given, seconds, options.tolerance)
        found = (
            integrate(*arguments)
            if options.compiled
            else in_plain_python(given, "integrate", seconds, options.tolerance)
        )
        took = time.perf_counter() - clock
        y = found["y"].copy()
        y[6:10] /= np.linalg.norm(y[6:10])
        gaps = [
            f"{np.linalg.norm(own[p] - y[p]):12.1e}" if p.stop <= len(y) else " " * 12 for p in PARTS.values()
        ]
        print(
            f"{phase.name:20} {begin:6.1f} {seconds:8.1f} {' '.join(gaps)} "
            f"{int(found['evaluations']):7d} {took:7.1f}",
            flush=True,
        )
    return 0


if __name__ == "__main__":
    sys.exit(main())
