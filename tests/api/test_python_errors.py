"""What goes wrong in Python is told in its words: type, argument, what is allowed, what was meant."""

import re
import shutil

import numpy as np
import pytest

import edl6dof

SHORT = {"simulation.time_limit_s": 5.0}
PATH = "vehicle.mass.entry_kg"


@pytest.fixture(scope="module")
def flight(tmp_path_factory):
    return edl6dof.fly("tianwen1", SHORT, out=tmp_path_factory.mktemp("api") / "run", replay=False)


@pytest.fixture(scope="module")
def simulation():
    return edl6dof.Simulation("tianwen1", SHORT)


@pytest.mark.parametrize(
    "overrides, error, words",
    [
        ({"vehicle": {"mass": {"entry_mass_kg": 1}}}, "ConfigError", "overrides: .*did you mean 'entry_kg'"),
        ([f"{PATH}=-1"], "ConfigError", f"^overrides: {PATH}: must be > 0 kg .got -1.$"),
        ({PATH: float("nan")}, "ConfigError", f"^overrides: {PATH}: must be finite .got nan.$"),
        ({PATH: [1.0, np.inf]}, "ConfigError", f"^overrides: {PATH}: must be finite"),
        ({PATH: None}, "ConfigError", f"^overrides: {PATH}: must be a number in kg .got nothing.$"),
        ([PATH], "ConfigError", "must have the form path.to.key=value"),
        ({"plugins": ["x.py"]}, "ConfigError", "^overrides: plugins: must be named"),
        ({PATH: object()}, "TypeError", f"^{PATH}: <object .* cannot stand in a scenario"),
        (None, "TypeError", "list of texts 'path=value' or a mapping .got None"),
        ([3], "TypeError", "texts 'path=value', or a mapping .* .got 3"),
    ],
)
def test_an_override_is_told_by_its_key_and_not_as_an_option(overrides, error, words):
    kind = {"ConfigError": edl6dof.ConfigError, "TypeError": TypeError}[error]
    for call in (edl6dof.load, edl6dof.Simulation):
        with pytest.raises(kind, match=words) as caught:
            call("tianwen1", overrides)
        assert "--" not in str(caught.value)


@pytest.mark.parametrize("call", [edl6dof.load, edl6dof.campaign, edl6dof.faults, edl6dof.Simulation])
def test_what_names_no_scenario_is_a_wrong_type(call):
    with pytest.raises(TypeError, match="file or a name, such as 'tianwen1'"):
        call(None)
    with pytest.raises(edl6dof.ConfigError, match="did you mean tianwen1"):
        call("tianwen11")


def test_overrides_of_a_scenario_without_its_source_are_refused(simulation):
    for call in (edl6dof.fly, edl6dof.Simulation):
        with pytest.raises(TypeError, match=r"or edl6dof.Scenario \(got <LoadedScenario tianwen1"):
            call(simulation.loaded, {"seed": 3})


@pytest.mark.parametrize(
    "call, words",
    [
        (lambda: edl6dof.campaign("tianwen1_mc", cases=0), "^cases: .*must be >= 1"),
        (lambda: edl6dof.campaign("tianwen1_mc", workers=0), "^workers: must be 1 .. 1024 .got 0"),
        (lambda: edl6dof.campaign("tianwen1_mc", sampling="sobbol"), "^sampling: .*did you mean 'sobol'"),
        (lambda: edl6dof.campaign("tianwen1_mc", {"sed": 1}, cases=2), "^overrides: sed: .*'seed'"),
        (lambda: edl6dof.faults("tianwen1", kinds="stuck_of"), "^kinds: .*did you mean 'stuck_off'"),
        (lambda: edl6dof.faults("tianwen1", workers=0), "^workers: "),
        (lambda: edl6dof.calibrate("msl"), "no calibration: section"),
        (lambda: edl6dof.open_run("nowhere"), "^nowhere: no such folder"),
        (lambda: edl6dof.refly("nowhere", 1), "^nowhere: is not the folder of a campaign"),
    ],
)
def test_bad_input_names_the_argument(call, words):
    with pytest.raises(edl6dof.ConfigError, match=words):
        call()


@pytest.mark.parametrize(
    "ask, kind, words",
    [
        (lambda one: one["truth.mac"], KeyError, "did you mean 'truth.mach'"),
        (lambda one: one.unit("truth.mac"), KeyError, "did you mean 'truth.mach'"),
        (lambda one: one.meaning("truth.mac"), KeyError, "did you mean 'truth.mach'"),
        (lambda one: one.figures["peak_load_g"], KeyError, "^no figure 'peak_load_g'; .*'peak_load_g0'"),
        (lambda one: one.figures["zzz"], KeyError, "^no figure 'zzz'$"),
        (lambda one: one.plot("truth.mac"), edl6dof.ConfigError, "did you mean 'truth.mach'"),
        (lambda one: one.plot(["truth.mach"]), TypeError, "channels are names"),
        (lambda one: one.attitude(99.0), ValueError, "must lie in 0 .. 5 s"),
        (lambda one: edl6dof.replay(one, page="Flite", html="x.html"), edl6dof.ConfigError, "'Flight'"),
        (lambda one: edl6dof.replay(one, at_s=1.0), edl6dof.ConfigError, "^at_s: "),
    ],
)
def test_a_flight_says_what_was_meant_flown_or_read(flight, ask, kind, words):
    for one in (flight, edl6dof.open_run(flight.folder)):
        with pytest.raises(kind, match=words):
            ask(one)


def test_attitude_is_the_same_flown_or_read(flight):
    assert edl6dof.open_run(flight.folder).attitude(2.345) == flight.attitude(2.345)


@pytest.mark.parametrize("name", ["summary.json", "telemetry.parquet", "events.json", "scenario.yaml"])
def test_a_run_with_a_file_missing_or_changed_is_refused(flight, tmp_path, name):
    broken = shutil.copytree(flight.folder, tmp_path / "run")
    (broken / name).write_bytes(b"x")
    with pytest.raises(edl6dof.ConfigError, match="has changed since"):
        run = edl6dof.open_run(broken)
        _ = run.outcome, run["t_s"], run.events, run.scenario_text
    (broken / name).unlink()
    with pytest.raises(edl6dof.ConfigError, match=f"{name}: is missing"):
        edl6dof.open_run(broken)


def test_what_was_flown_in_memory_has_no_folder():
    with pytest.raises(ValueError, match="this flight is in memory only; fly it with out=FOLDER"):
        edl6dof.report(edl6dof.fly("tianwen1", SHORT))
    with pytest.raises(TypeError, match="a run is its folder"):
        edl6dof.report(3)
    with pytest.raises(TypeError, match="name a run"):
        edl6dof.replay()


@pytest.mark.parametrize(
    "ask, kind, words",
    [
        (lambda one: one.step({"bank_dg": 1.0}), ValueError, "did you mean 'bank_deg'"),
        (lambda one: one.step(cycles=0), ValueError, "cycles must be >= 1 .got 0"),
        (lambda one: one.observe("altitude"), ValueError, "did you mean 'altitude_m'"),
        (lambda one: one.restore(3), TypeError, "a state is what"),
    ],
)
def test_a_simulation_says_what_was_meant(simulation, ask, kind, words):
    with pytest.raises(kind, match=words):
        ask(simulation)


def test_one_name_is_observed(simulation):
    assert list(simulation.observe("altitude_m")) == ["altitude_m"]


def test_every_object_is_told_in_a_line(flight, simulation):
    descent = edl6dof.Simulation("tianwen1", telemetry=False)
    descent.step(cycles=23500)
    objects = [
        *(flight, flight.telemetry, edl6dof.open_run(flight.folder), simulation),
        *(
            simulation.state(),
            simulation.linear_plant(),
            descent.attitude_margins()["y"],
            flight.plot("truth.mach"),
            *edl6dof.verify("kepler"),
        ),
    ]
    for one in objects:
        assert re.fullmatch(r"(?!.*np\.)\S.{10,118}\S", repr(one)), repr(one)
