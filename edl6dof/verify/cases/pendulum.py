"""Verifies: the swing of vehicle and canopy about each other (pendulum) and of the vehicle about its bridle
(wrist mode).

gravity uniform | atmosphere uniform | winds none | vehicle Tianwen-1 without heat shield under the open
canopy | source: eigenvalues of an independent planar two-body model, linearised numerically
(:mod:`edl6dof.verify.hanging`) | tolerance 1e-4 of the
eigenvalue, period and damping together: swings of 2 mrad are linear to 1e-5 and gravity varies by 1e-5 on the
way; the differences are good to 1e-8.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from edl6dof.scenario.loading import load_scenario
from edl6dof.verify.hanging import SCENE, Planar, descend
from edl6dof.verify.outcome import History, Outcome, Result
from edl6dof.verify.scene import SCENARIO
from edl6dof.verify.swing import fit

SIZE = 2e-3
ABOUT, SOURCE, WHY = (
    "vehicle, riser and canopy",
    "eigenvalues of a planar model",
    "swings of 2 mrad are linear to 1e-5",
)


def run(planted: Sequence[str] = ()) -> Outcome:
    """Start each mode alone and measure its frequency and damping."""
    model = Planar(load_scenario(SCENARIO, SCENE).scenario)
    values, shapes = model.modes()
    rest = model.equilibrium()
    results = []
    for name, index in (("pendulum", 0), ("wrist", -1)):
        value = complex(values[index])
        seconds = round(3.0 * 2.0 * np.pi / value.imag)
        t, tilt, _ = descend(rest + SIZE * shapes[:, index].real, seconds, planted)
        found, _ = fit(t, tilt, value)
        quantity = f"{name} mode (period {2.0 * np.pi / value.imag:.2f} s)"
        results.append(Result(quantity, ABOUT, SOURCE, abs(found - value) / abs(value), 1e-4, "-", WHY))
    expected = SIZE * np.real(np.exp(value * t))
    return Outcome(
        tuple(results),
        History(
            "Wrist mode under the parachute",
            "time (s)",
            "tilt (rad)",
            t,
            {"flown": tilt, "expected": expected},
        ),
    )
