"""What ``truth:`` may change is what the truth of a flight follows from."""

from __future__ import annotations

import json

import pytest

import edl6dof
from edl6dof.config.errors import ConfigError
from edl6dof.scenario import records
from edl6dof.scenario.loading import TRUE_SECTIONS, truth_problem
from edl6dof.scenario.schema import Scenario

#: A true value of each section that differs from what tianwen1 says.
DIFFERENT = {
    "planet.rotation_rate_rad_s": 7.0e-5,
    "atmosphere.density_factor": 0.9,
    "wind.scale": 1.5,
    "terrain.slope_deg": 3.0,
    "vehicle.mass.entry_kg": 1300.0,
    "initial.altitude_m": 124900.0,
    "point_mass.bank_rate_deg_s": 11.0,
    "sensors.imu.delay_cycles": 0,
    "faults": [{"kind": "stuck_off", "thruster": "D7", "at": {"time_s": 5.0}}],
    "seed": 2,
    "profile": 2,
}
RANDOM = ["atmosphere.perturbation.enabled=true"]


def parts(*overrides: str) -> tuple[bytes, bytes]:
    """Truth (with the state it begins in) and belief of the nominal scenario."""
    loaded = edl6dof.load("tianwen1", [*RANDOM, *overrides])
    case, _, onboard = records.build_records(loaded)
    return case.tobytes() + records.initial_plant(loaded.truth, case).tobytes(), onboard.tobytes()


@pytest.fixture(scope="module")
def nominal_parts() -> tuple[bytes, bytes]:
    return parts()


def test_every_section_is_tried():
    assert {path.partition(".")[0] for path in DIFFERENT} == set(TRUE_SECTIONS)


@pytest.mark.parametrize("path", DIFFERENT)
def test_truth_changes_the_truth_alone(path, nominal_parts):
    truth, belief = parts(f"truth={json.dumps({path: DIFFERENT[path]})}")
    assert truth != nominal_parts[0]
    assert belief == nominal_parts[1]


@pytest.mark.parametrize("section", sorted(set(Scenario.model_fields) - set(TRUE_SECTIONS)))
def test_other_sections_are_refused(section):
    with pytest.raises(ConfigError) as caught:
        edl6dof.load("tianwen1", [f"truth={{{section}: 1}}"])
    (problem,) = caught.value.problems
    assert problem.path == f"truth.{section}"
    assert "truth may change planet, atmosphere" in problem.message


def test_a_path_that_does_not_exist_gets_its_own_message():
    assert truth_problem("vehicl.mass") == ""
    with pytest.raises(ConfigError, match="did you mean 'vehicle'"):
        edl6dof.load("tianwen1", ["truth={vehicl.mass: 1}"])
