"""Flies saved settings in plain Python with one mistake planted in the kernels, and prints the figures of the
balance as JSON; a process of its own, with numba switched off.
"""

from __future__ import annotations

import json
import sys
from contextlib import ExitStack, nullcontext
from unittest.mock import patch

import numpy as np
from plain_python import LAYOUT, Records, Setting, fly_cycles

from edl6dof.metrics.record_figures import balance_figures
from edl6dof.spatial.vector import put3, scale, take3
from edl6dof.vehicle.motion import body, runge_kutta, staging
from edl6dof.vehicle.plant import VELOCITY

gravity, separate, rk4 = body.gravity, staging.separate, runge_kutta.rk4


def upward(*given):
    """Gravitation of the wrong sign."""
    return scale(-1.0, gravity(*given))


def without_recoil(case, plant, *given):
    """A separation that leaves the vehicle its velocity."""
    before = take3(plant.y, VELOCITY)
    separate(case, plant, *given)
    put3(plant.y, VELOCITY, before)


def heavy(case, plant, *given):
    """A separation after which the vehicle is as heavy as before."""
    before = plant.dry.mass
    separate(case, plant, *given)
    plant.dry.mass = before


def half_a_step(case, tables, plant, outputs, work, middle, end, t_end):
    """An integrator that adds half of what it should to the velocity."""
    before = take3(plant.y, VELOCITY)
    rk4(case, tables, plant, outputs, work, middle, end, t_end)
    for k in range(3):
        plant.y[VELOCITY + k] = 0.5 * (before[k] + plant.y[VELOCITY + k])


def free(*given, **named):
    """Propellant that no tank gives."""


MISTAKES = {
    "none": nullcontext(),
    "gravity": patch.object(body, "gravity", upward),
    "recoil": patch.object(staging, "separate", without_recoil),
    "heavy": patch.object(staging, "separate", heavy),
    "integrator": patch.object(runge_kutta, "rk4", half_a_step),
    "propellant": patch.object(body, "draw", free),
}


def main(given: str, cycles: str, *mistakes: str) -> None:
    """Fly some cycles from the setting in the file ``given`` once for each mistake."""
    found = {}
    for name in mistakes:
        with np.load(given) as file:
            arrays = {k: np.frombuffer(file[k].tobytes(), dtype).copy() for k, dtype in LAYOUT.items()}
            s = Setting(arrays, int(file["cycle"]), int(file["steps"]))
        with ExitStack() as stack:
            stack.enter_context(MISTAKES[name])
            stack.enter_context(np.errstate(all="ignore"))
            fly_cycles(s, int(cycles))
        figures = balance_figures(Records(arrays["case"]), Records(arrays["plant"]))
        found[name] = {key: float(value) for key, value in figures.items()}
    print(json.dumps(found))


if __name__ == "__main__":
    main(*sys.argv[1:])
