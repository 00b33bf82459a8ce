"""Dispersed flights of one scenario: Gaussian draws of its parameters, and a row of figures from each flight."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from edl6dof.sim.flight import Flight, fly
from edl6dof.sim.scenario import load_scenario
from edl6dof.studies.study import Progress


@dataclass(frozen=True)
class Spread:
    """Gaussian dispersion of the true value of one parameter, named by its dotted path."""

    path: str
    mean: float
    three_sigma: float


def draw(spreads: Sequence[Spread], runs: int, seed: int) -> list[dict[str, float]]:
    """True values of ``runs`` flights by dotted path; the first flights of a longer series are those of a shorter one."""
    normal = np.random.default_rng(seed).standard_normal((runs, len(spreads)))
    return [{s.path: s.mean + s.three_sigma / 3.0 * float(x) for s, x in zip(spreads, row, strict=True)} for row in normal]


def fly_true(scenario: str, truth: Mapping[str, float], overrides: Sequence[str] = ()) -> Flight:
    """Fly a shipped scenario whose true values the flight computer is not told."""
    return fly(load_scenario(scenario, [*overrides, f"truth={json.dumps(dict(truth))}"]))


def fly_each(
    scenario: str,
    truths: Sequence[Mapping[str, float]],
    figures: Callable[[Flight], dict[str, float]],
    progress: Progress,
    overrides: Sequence[str] = (),
) -> dict[str, np.ndarray]:
    """Fly every draw and keep ``figures`` of each: columns of equal length, the true values first.

    Telemetry is dropped flight by flight, so memory does not grow with the number of runs.
    """
    rows = []
    for done, truth in enumerate(truths, 1):
        rows.append({**{path.rpartition(".")[2]: value for path, value in truth.items()}, **figures(fly_true(scenario, truth, overrides))})
        progress(done, len(truths))
    return {name: np.array([row[name] for row in rows]) for name in rows[0]}
