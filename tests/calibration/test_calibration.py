"""Calibration: the linear case in closed form, a twin whose parameters are known, and what the command
says.
"""

from __future__ import annotations

import json

import numpy as np
import pytest

import edl6dof
from edl6dof import cli
from edl6dof.calibration.fit import fit
from edl6dof.calibration.problem import load_calibration

#: Truth of the twin, which flies the figures below; the calibration is not told of it.
DENSITY, HEAVIER = 1.06, 1.02
#: No bank reversals, whose number changes: what follows from the parameters is smooth.
LAW = "flight_software.guidance.entry.law=constant_bank"
SECTION = """extends: msl
name: twin
flight_software: {{guidance: {{entry: {{law: constant_bank}}}}}}
published: {published}
calibration:
  flights: 3
  figures: {figures}
  parameters:
    atmosphere.density_factor: {{mean: 1.0, sigma: 0.08}}
    vehicle.mass.entry_kg: {{mean: {mass}, sigma: {sigma}}}
"""


def test_linear_case_is_the_normal_equations():
    """Posterior mean and covariance of a linear model with normal priors, Tarantola (2005), eq. 3.37."""
    rng = np.random.default_rng(3)
    slopes, data = rng.normal(size=(5, 3)), rng.normal(size=5)
    far = np.full(3, 50.0)
    found = fit(lambda x: slopes @ x - data, -far, far)
    covariance = np.linalg.inv(np.eye(3) + slopes.T @ slopes)
    assert found.x == pytest.approx(covariance @ slopes.T @ data, abs=1e-6)
    assert found.covariance == pytest.approx(covariance, rel=1e-9)
    assert found.told_apart == pytest.approx(3.0 - np.trace(covariance))
    assert found.before == pytest.approx(-data)
    assert not found.at_bound.any()


def test_a_parameter_that_no_figure_knows_keeps_its_prior_and_two_that_act_alike_are_found_out():
    far = np.full(3, 50.0)
    found = fit(lambda x: np.array([20.0 * (x[0] + x[1]) - 10.0]), -far, far)
    assert found.resolution[2] == pytest.approx(0.0) and found.x[2] == pytest.approx(0.0, abs=1e-9)
    assert found.x[0] == pytest.approx(found.x[1]) and found.correlation[0, 1] < -0.99
    assert found.told_apart == pytest.approx(1.0, abs=2e-3)


def test_a_bound_holds():
    found = fit(lambda x: np.array([10.0 * (x[0] - 3.0)]), np.array([-1.0]), np.array([0.5]))
    assert found.x[0] == pytest.approx(0.5, abs=1e-2) and found.at_bound.all()


@pytest.fixture(scope="module")
def twin(tmp_path_factory):
    """A scenario whose published figures were flown by a vehicle and an air that it does not know."""
    mass = edl6dof.load("msl").scenario.vehicle.mass.entry_kg
    truth = [f"atmosphere.density_factor={DENSITY}", f"vehicle.mass.entry_kg={HEAVIER * mass}"]
    flown = edl6dof.fly("msl", [LAW, *truth])
    names = ("lift_start_s", "parachute_s", "trim_wing_s", "parachute_altitude_m", "peak_load_g0")
    sigma = {"s": 0.3, "m": 50.0, "g0": 0.05}
    published = {
        name: {"value": flown.metrics[name], "sigma": sigma[name.rpartition("_")[2]]} for name in names
    }
    path = tmp_path_factory.mktemp("twin") / "twin.yaml"
    path.write_text(
        SECTION.format(
            published=json.dumps(published), figures=json.dumps(names), mass=mass, sigma=0.02 * mass
        )
    )
    return path, HEAVIER * mass


def test_twin_is_found_again(twin):
    path, mass = twin
    calibration = load_calibration(str(path))
    found = fit(calibration.misfit, *calibration.bounds)
    values, sigmas = calibration.values(found.x), found.deviation * [0.08, 0.02 * mass / HEAVIER]
    for (name, value), sigma, true in zip(values.items(), sigmas, (DENSITY, mass), strict=True):
        assert value == pytest.approx(true, abs=3.0 * sigma), name
    assert found.resolution[0] > 0.9
    assert np.abs(found.after).max() < 2.0 < np.abs(found.before).max()


def test_command_writes_a_scenario_that_flies_with_the_values_it_found(twin, tmp_path, monkeypatch, capsys):
    path, _ = twin
    out = tmp_path / "found"
    monkeypatch.chdir(path.parent)  # named by a relative path, and found again from another folder
    monkeypatch.setattr("sys.argv", ["edl6dof", "calibrate", path.name, "--out", str(out)])
    monkeypatch.setenv("COLUMNS", "100")
    with pytest.raises(SystemExit) as end:
        cli.main()
    shown = capsys.readouterr().out
    assert end.value.code == 0 and "told by figures" in shown and "5 figures tell" in shown
    found = json.loads((out / "summary.json").read_text())["parameters"]
    loaded = edl6dof.load(out / "calibrated.yaml")
    density = found["atmosphere.density_factor"]
    assert loaded.scenario.atmosphere.density_factor == pytest.approx(
        density["mean"], abs=0.02 * density["sigma"]
    )
    assert loaded.document.status["vehicle.mass.entry_kg"] == "calibrated"


@pytest.mark.parametrize(
    "section, messages",
    [
        ("{parameters: {vehicle.mass.entry: {mean: 1, sigma: 1}}}", ["parameters.vehicle.mass.entry"]),
        (
            "{parameters: {vehicle.mass.entry_kg: {mean: 1, sigma: 1, low: 2}}}",
            ["must lie between low and high"],
        ),
        ("{parameters: {vehicle.mass.entry_kg: {mean: 3000, sigma: -1}}}", ["sigma: must be > 0"]),
        ("{parameters: {atmosphere.density_factor: {mean: 1, sigma: 0.5}}}", ["atmosphere.density_factor"]),
        (
            "{parameters: {vehicle.mass.entry_centre_m.0: {mean: -1, sigma: 0.01}}}",
            ["vehicle.mass.entry_centre_m.0: must be a value of its own"],
        ),
        (
            "{figures: [touchdwn_s], parameters: {initial.alpha_deg: {mean: -15, sigma: 1}}}",
            ["figures.0: is no flown value with a sigma under published (allowed "],
        ),
        ("{figures: [parachute_s]}", ["parameters: required key is missing"]),
    ],
)
def test_bad_sections_are_refused_with_file_line_and_key(section, messages, tmp_path, monkeypatch, capsys):
    path = tmp_path / "bad.yaml"
    published = "published: {parachute_s: {value: 255, sigma: 1}}"
    path.write_text(f"extends: msl\nname: bad\n{published}\ncalibration: {section}\n")
    monkeypatch.setattr("sys.argv", ["edl6dof", "calibrate", str(path)])
    with pytest.raises(SystemExit) as end:
        cli.main()
    err = capsys.readouterr().err
    assert end.value.code == 2 and f"{path}:4:" in err
    for message in messages:
        assert message in err
