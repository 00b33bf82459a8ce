"""Calibration: the linear case in closed form, a twin whose parameters are known, and what the command
says.
"""

from __future__ import annotations

import json
from functools import partial

import in_process
import numpy as np
import pytest

import edl6dof
from edl6dof.calibration import problem
from edl6dof.calibration.findings import find
from edl6dof.calibration.fit import Data, TooFew, fit
from edl6dof.calibration.problem import load_calibration

#: Truth of the twin, which flies the figures below; the calibration is not told of it.
DENSITY, HEAVIER = 1.06, 1.02
#: A bank angle that is held, and a point mass, which is flown in a moment.
LAW = "flight_software.guidance.entry.law=constant_bank"
SECTION = """extends: wu2013
name: twin
flight_software: {{guidance: {{entry: {{law: constant_bank}}}}}}
published: {published}
calibration:
  flights: 16
  figures: {figures}
  parameters:
    atmosphere.density_factor: {{mean: 1.0, sigma: 0.08}}
    vehicle.mass.entry_kg: {{mean: {mass}, sigma: {sigma}}}
"""


@pytest.fixture(scope="module", autouse=True)
def few_neighbours():
    """A tenth of the flights that the mean of a document rests on."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(problem, "fly_neighbours", partial(problem.fly_neighbours, count=3))
        yield


#: Flights of a design of the models below.
FLIGHTS = 64
FAR = np.full(3, 50.0)


def rough(slopes, height, seed=0):
    """Figures with slopes and with a scatter that no difference between two points sees through."""
    phases = np.random.default_rng(seed).uniform(0.0, 6.0, slopes.shape)
    return lambda points: points @ slopes.T + height * np.sin(1e4 * points @ phases.T)


def test_linear_case_is_the_normal_equations():
    """Posterior mean and covariance of a linear model with normal priors, Tarantola (2005), eq. 3.37."""
    rng = np.random.default_rng(3)
    slopes, constant, sigma = rng.normal(size=(5, 3)), rng.normal(size=5), rng.uniform(0.5, 1.0, 5)
    gap = slopes @ [0.5, -0.3, 0.2] + 0.3 * sigma
    found = fit(lambda x: constant + x @ slopes.T, Data(constant + gap, sigma), -FAR, FAR, FLIGHTS, seed=1)
    covariance = np.linalg.inv(np.eye(3) + slopes.T @ np.diag(sigma**-2) @ slopes)
    assert found.x == pytest.approx(covariance @ slopes.T @ (gap / sigma**2), abs=1e-9)
    assert found.covariance == pytest.approx(covariance, rel=1e-9)
    assert found.determined == pytest.approx(3.0 - np.trace(covariance))
    misfit = (slopes @ found.x - gap) / sigma
    assert found.squares == pytest.approx(misfit @ misfit + found.x @ found.x)
    assert found.widening == 1.0 and found.moved == pytest.approx(0.0, abs=1e-9) and not found.at_bound.any()


def test_scatter_of_a_flight_counts_as_noise():
    """Independent noise of variance h^2 / 2, that of a sine, beside the published sigma."""
    slopes, sigma, height = np.array([[3.0], [-2.0]]), np.array([0.1, 0.1]), 0.4
    found = fit(rough(slopes, height), Data(np.array([1.5, -1.0]), sigma), -FAR[:1], FAR[:1], 4096, seed=1)
    assert found.sigma == pytest.approx(np.hypot(sigma, height / np.sqrt(2.0)), rel=0.05)
    assert found.covariance[0, 0] == pytest.approx(1.0 / (1.0 + 13.0 / (0.01 + height**2 / 2.0)), rel=0.1)


def test_designs_agree_where_differences_between_two_points_would_follow_the_noise():
    slopes = np.random.default_rng(5).normal(size=(6, 3))
    data = Data(slopes @ [0.5, -1.0, 0.7], np.full(6, 0.05))
    one, other = (fit(rough(slopes, 0.1), data, -FAR, FAR, 256, seed) for seed in (1, 2))
    assert one.x != pytest.approx(other.x, abs=1e-9)
    assert np.abs((one.x - other.x) / one.deviation).max() < 0.3 and one.moved < 0.3
    again = fit(rough(slopes, 0.1), data, -FAR, FAR, 256, seed=1)
    assert np.array_equal(one.x, again.x) and np.array_equal(one.covariance, again.covariance)


def test_figures_that_contradict_each_other_count_less():
    """No parameter moves them: the factor is the root mean square of the differences in sigma."""
    gaps = np.array([3.0, -4.0, 5.0])
    found = fit(lambda x: np.zeros((len(x), 3)), Data(gaps, np.ones(3)), -FAR[:1], FAR[:1], FLIGHTS, seed=1)
    assert found.squares == pytest.approx(50.0)
    assert found.widening == pytest.approx(np.sqrt(50.0 / 3.0))


def test_a_parameter_that_no_figure_knows_keeps_its_prior_and_two_that_act_alike_are_found_out():
    data = Data(np.array([0.5]), np.array([0.05]))
    found = fit(lambda x: x[:, :1] + x[:, 1:2], data, -FAR, FAR, FLIGHTS, seed=1)
    assert found.resolution[2] == pytest.approx(0.0) and found.x[2] == pytest.approx(0.0, abs=1e-9)
    assert found.x[0] == pytest.approx(found.x[1]) and found.correlation[0, 1] < -0.99
    assert found.determined == pytest.approx(1.0, abs=2e-3)


def test_a_bound_holds():
    data = Data(np.array([3.0]), np.array([3.0]))
    found = fit(lambda x: 10.0 * x, data, np.array([-1.0]), np.array([0.2]), FLIGHTS, seed=1)
    assert found.x[0] == pytest.approx(0.2) and found.at_bound.all()


def test_flights_that_do_not_reach_a_figure_are_left_out_unless_too_many():
    data = Data(np.array([0.5]), np.array([0.5]))

    def fly(cut):
        return lambda x: np.where(x[:, :1] < cut, 2.0 * x[:, :1], np.nan)

    found = fit(fly(0.8), data, -FAR[:1], FAR[:1], FLIGHTS, seed=1)
    assert found.x[0] == pytest.approx(2.0 / (4.0 + 0.25) * 0.5)
    with pytest.raises(TooFew, match="of 64 flights reached every figure to explain, and 8 are needed"):
        fit(fly(-2.0), data, -FAR[:1], FAR[:1], FLIGHTS, seed=1)


@pytest.fixture(scope="module")
def twin(tmp_path_factory):
    """A scenario whose published figures were flown by a vehicle and an air that it does not know."""
    mass = edl6dof.load("wu2013").scenario.vehicle.mass.entry_kg
    truth = [f"atmosphere.density_factor={DENSITY}", f"vehicle.mass.entry_kg={HEAVIER * mass}"]
    flown = edl6dof.fly("wu2013", [LAW, *truth])
    sigma = {
        "parachute_s": 0.1,
        "parachute_altitude_m": 50.0,
        "parachute_downrange_m": 300.0,
        "peak_load_g0": 0.05,
        "heat_load_j_cm2": 5.0,
    }
    published = {
        name: {"value": flown.figures[name], "sigma": deviation} for name, deviation in sigma.items()
    }
    path = tmp_path_factory.mktemp("twin") / "twin.yaml"
    path.write_text(
        SECTION.format(
            published=json.dumps(published), figures=json.dumps(list(sigma)), mass=mass, sigma=0.02 * mass
        )
    )
    return path, HEAVIER * mass


@pytest.fixture(scope="module")
def found(twin):
    """What is found of it."""
    return find(load_calibration(str(twin[0])))


def test_twin_is_found_again(twin, found):
    for (name, value), true in zip(found.values.items(), (DENSITY, twin[1]), strict=True):
        assert value == pytest.approx(true, abs=3.0 * found.sigmas[name]), name
    assert found.fit.resolution[0] > 0.9
    before = (found.before - found.calibration.data.number) / found.fit.sigma
    assert np.abs(found.residuals).max() < 2.0 < np.abs(before).max() and not found.unexplained


def test_command_finds_the_same_with_another_design_and_writes_a_scenario_that_flies_with_it(
    twin, found, tmp_path, monkeypatch, capsys
):
    path, _ = twin
    out = tmp_path / "found"
    monkeypatch.chdir(path.parent)  # named by a relative path, and found again from another folder
    options = ["--set", "seed=2", "-n", "14", "--out", str(out)]
    monkeypatch.setattr("sys.argv", ["edl6dof", "calibrate", path.name, *options])
    monkeypatch.setenv("COLUMNS", "100")
    with pytest.raises(SystemExit) as end:
        in_process.main()
    shown = capsys.readouterr().out
    assert end.value.code == 0 and "share from data" in shown and "5 figures determine" in shown
    assert "   vehicle.mass.entry_kg\n" in shown, "a path is never broken"
    other = json.loads((out / "summary.json").read_text())
    assert other["seed"] == 2 and other["flights"] == 14
    loaded = edl6dof.load(out / "calibrated.yaml")
    for name, sigma in found.sigmas.items():
        mean = other["parameters"][name]["mean"]
        assert mean != found.values[name] and mean == pytest.approx(found.values[name], abs=0.3 * sigma), name
    density = other["parameters"]["atmosphere.density_factor"]
    assert loaded.scenario.atmosphere.density_factor == pytest.approx(
        density["mean"], abs=0.02 * density["sigma"]
    )
    assert loaded.document.status["vehicle.mass.entry_kg"] == "calibrated"


def test_a_figure_that_is_not_reached_and_too_few_flights_are_refused(twin, tmp_path, monkeypatch, capsys):
    path, _ = twin
    out = tmp_path / "found"
    ended = "simulation.time_limit_s=100"
    for options, message in (
        (["-n", "11"], "calibration.flights: must be >= 12 with 2 parameters (got 11)"),
        (["--set", ended], "0 of 16 flights reached every figure to explain, and 12 are needed"),
    ):
        monkeypatch.setattr("sys.argv", ["edl6dof", "calibrate", str(path), *options, "--out", str(out)])
        with pytest.raises(SystemExit) as end:
            in_process.main()
        assert end.value.code == 2 and message in capsys.readouterr().err and not out.exists()


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
        (
            "{flights: 7, parameters: {atmosphere.density_factor: {mean: 1, sigma: 0.1}}}",
            ["calibration.flights: must be >= 8 with 1 parameter (got 7)"],
        ),
    ],
)
def test_bad_sections_are_refused_with_file_line_and_key(section, messages, tmp_path, monkeypatch, capsys):
    path = tmp_path / "bad.yaml"
    published = "published: {parachute_s: {value: 255, sigma: 1}}"
    path.write_text(f"extends: msl\nname: bad\n{published}\ncalibration: {section}\n")
    monkeypatch.setattr("sys.argv", ["edl6dof", "calibrate", str(path)])
    with pytest.raises(SystemExit) as end:
        in_process.main()
    err = capsys.readouterr().err
    assert end.value.code == 2 and f"{path}:4:" in err
    for message in messages:
        assert message in err
