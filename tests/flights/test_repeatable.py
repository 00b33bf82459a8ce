"""Verifies: same scenario, same bits - again, from the resolved scenario, after a break, and with finer
telemetry.
"""

from __future__ import annotations

import numpy as np
import pytest

import edl6dof
from edl6dof.config.document.source import parse_document
from edl6dof.scenario.loading import check_document
from edl6dof.sim.checkpoint import State
from edl6dof.sim.flight import continue_from, fly

PERTURBED = ["seed=7", "atmosphere.perturbation.enabled=true", "wind.gust.enabled=true"]


@pytest.fixture(scope="module")
def perturbed():
    return edl6dof.fly("tianwen1", PERTURBED)


def test_two_flights_are_equal_bit_for_bit(perturbed):
    again = edl6dof.fly("tianwen1", PERTURBED)
    assert again.log.tobytes() == perturbed.log.tobytes()
    assert again.plant.tobytes() == perturbed.plant.tobytes()


def test_resolved_scenario_repeats_the_flight(perturbed):
    resolved = check_document(parse_document(perturbed.resolved_scenario, "resolved"))
    assert fly(resolved).log.tobytes() == perturbed.log.tobytes()


@pytest.mark.parametrize(
    "t", [281.9, *(pytest.param(t, marks=pytest.mark.long) for t in (33.34, 200.0, 300.0, 450.0, 512.02))]
)
def test_continued_flight_has_the_same_bits(perturbed, tmp_path, t):
    """Broken off in vacuum, in lift, while the parachute inflates, under it, under power and just before
    touchdown.
    """
    first = fly(perturbed.loaded, save_at_s=t)
    first.saved.save(tmp_path / "state.npz")
    state = State.load(tmp_path / "state.npz")
    second = fly(continue_from(state), start=state)
    assert second.plant.tobytes() == perturbed.plant.tobytes()
    assert second.fsw.tobytes() == perturbed.fsw.tobytes()
    rows = len(second.log)
    assert second.log.tobytes() == perturbed.log[-rows:].tobytes()
    assert second.log["t"][0] == pytest.approx(t)


def test_another_seed_is_another_flight(perturbed):
    other = edl6dof.fly("tianwen1", ["seed=8", *PERTURBED[1:]])
    assert not np.array_equal(other.plant["y"], perturbed.plant["y"])


def test_telemetry_rate_does_not_change_the_flight(perturbed):
    sparse = edl6dof.fly("tianwen1", [*PERTURBED, "simulation.log_every=5"])
    assert sparse.plant["y"].tobytes() == perturbed.plant["y"].tobytes()
    assert len(sparse.log) == pytest.approx(len(perturbed.log) / 5, abs=2)
