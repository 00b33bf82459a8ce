"""Verifies: steady descent under the open canopy.

gravity uniform | atmosphere uniform | winds none | vehicle Tianwen-1 without heat shield under the open
canopy | source: weight of both bodies equals drag of both, V = sqrt(2 m g / rho (sum of CD A)) | tolerance
2e-5: gravity changes by 2e-5 over the 8 km of the descent, and a start 20 % too fast has died out to 1e-7
after 120 s.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from edl6dof.scenario.loading import load_scenario
from edl6dof.verify.case import SCENARIO, History, Outcome, Result
from edl6dof.verify.cases.pendulum import SCENE, Planar, descend


def run(planted: Sequence[str] = ()) -> Outcome:
    """Start 20 % too fast and compare the speed after two minutes."""
    model = Planar(load_scenario(SCENARIO, SCENE).scenario)
    start = model.equilibrium()
    start[[4, 9]] *= 1.2
    t, _, flight = descend(start, 120.0, planted)
    speed, expected = flight.telemetry["truth.speed_m_s"], model.terminal_speed()
    error, curve = abs(float(speed[-1]) / expected - 1.0), np.full_like(t, expected)
    about = ("drag of vehicle and canopy", "weight = drag", "gravity varies by 2e-5 on the way")
    results = (Result("speed after 120 s", error, 2e-5, "-", *about),)
    return Outcome(results, History("Terminal velocity", "time (s)", "speed (m/s)", t, speed, curve))
