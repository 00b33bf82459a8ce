"""``edl6dof new``: what it writes flies as it is."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import numpy as np
import pytest
from cli_run import run, spawn

import edl6dof
from edl6dof.campaign.design.plan import load_plan
from edl6dof.config.document.source import resolve_scenario
from edl6dof.config.plugin_files import is_accepted


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


SIZES = [(300, 1.8, 8), (80, 1.1, 4), pytest.param(2400, 4.5, 16, marks=pytest.mark.long)]


@pytest.mark.parametrize("mass, diameter, count", SIZES)
def test_a_capsule_of_any_size_flies_within_limits(mass, diameter, count, here, capsys, monkeypatch):
    words = ("--mass", str(mass), "--diameter", str(diameter), "--rcs", str(count))
    code, out, err = run(capsys, monkeypatch, "new", "capsule", "mine", *words)
    assert (code, err) == (0, "") and out.splitlines()[0] == "mine.yaml"
    loaded = edl6dof.load("mine.yaml")
    assert loaded.warnings == []
    vehicle = loaded.scenario.vehicle
    assert (vehicle.mass.entry_kg, vehicle.aero.capsule.diameter_m) == (mass, diameter)
    assert vehicle.mass.entry_centre_m[0] == pytest.approx(-0.27 * diameter, rel=1e-3)
    assert len(vehicle.rcs.thrusters) == count
    torques = [np.cross(np.subtract(jet.position_m, vehicle.mass.entry_centre_m), jet.direction)
               for jet in vehicle.rcs.thrusters]  # fmt: skip
    assert np.linalg.matrix_rank(np.array(torques)) == 3, "about every axis"
    assert np.allclose(np.sum(torques, axis=0), 0.0, atol=1e-3)
    assert edl6dof.fly(loaded).outcome == "heat shield jettisoned within limits"


def test_a_capsule_too_heavy_for_its_parachute_is_called_so(here, capsys, monkeypatch):
    words = ("new", "capsule", "heavy", "--mass", "900", "--diameter", "2")
    code, _, err = run(capsys, monkeypatch, *words)
    assert code == 0 and err.startswith("warning: heavy for its size")
    assert not edl6dof.fly("heavy.yaml").success


@pytest.mark.parametrize("kind", ["law", "controller"])
def test_a_plugin_may_run_and_lands(kind, here):
    """In processes of their own, whose families take it in."""
    made = spawn(["new", kind, "my_own"], here, XDG_CONFIG_HOME=str(here))
    out, err = made.communicate()
    assert (made.returncode, err) == (0, "") and out.splitlines()[:2] == ["my_own.py", "my_own.yaml"]
    text = (here / "my_own.py").read_text()
    assert "class MyOwnParams(Params)" in text and 'Member("my_own"' in text
    shutil.copytree(
        here, here / "moved", ignore=lambda folder, names: set(names) - {"my_own.py", "my_own.yaml"}
    )
    for folder, mass in (
        (here, 1284),
        (here / "moved", 1350),
    ):  # the machine code of the second is that of the first
        words = ["fly", "my_own.yaml", "--no-replay", "--json", "--set", f"vehicle.mass.entry_kg={mass}"]
        flown = spawn(words, folder, XDG_CONFIG_HOME=str(here))
        out, err = flown.communicate()
        assert flown.returncode == 0, err
        assert json.loads(out)["outcome"] == "landed within limits"
    compared = spawn(["compare", "runs/my_own", "moved/runs/my_own"], here, XDG_CONFIG_HOME=str(here))
    out, err = compared.communicate()
    assert (compared.returncode, err) == (0, "") and "Largest differences" in out
    assert not is_accepted((here / "my_own.py").read_bytes()), "in the settings of the test alone"


def test_a_campaign_disperses_what_the_scenario_has(here, capsys, monkeypatch):
    assert run(capsys, monkeypatch, "new", "campaign", "titan_probe")[0] == 0
    assert run(capsys, monkeypatch, "new", "campaign", "tianwen1")[0] == 0
    probe, tianwen1 = load_plan("titan_probe_mc.yaml"), load_plan("my_tianwen1_mc.yaml")
    assert probe.count == tianwen1.count == 200
    (case,) = tianwen1.cases(0, 1)
    assert any(path.endswith("thrust_n") for path in case.truth)
    assert not any("parachutes" in path or "wind" in path for path in next(iter(probe.cases(0, 1))).truth)
    assert resolve_scenario("tianwen1_mc").is_absolute(), "it still means the shipped one"
    shipped = next(iter(load_plan("tianwen1_mc").cases(0, 1))).truth
    assert case.truth.keys() <= shipped.keys()


@pytest.mark.parametrize(
    "words, said",
    [
        (["capsule", "a/b"], "names a folder"),
        (["capsule", "mine", "--rcs", "7"], "come in pairs"),
        (["law", "Mine"], "must be a lower-case identifier"),
        (["capsule", "msl"], "msl: is the name of a shipped scenario"),
        (["campaign", "nowhere"], "nowhere"),
    ],
)
def test_wrong_requests_write_nothing(words, said, here, capsys, monkeypatch):
    code, out, err = run(capsys, monkeypatch, "new", *words)
    assert (code, out) == (2, "") and said in err
    assert not list(Path().iterdir())


def test_existing_files_are_kept(here, capsys, monkeypatch):
    Path("mine.yaml").write_text("mine")
    code, _, err = run(capsys, monkeypatch, "new", "law", "mine")
    assert code == 2 and "mine.yaml: exists" in err
    assert [path.name for path in here.iterdir()] == ["mine.yaml"] and Path("mine.yaml").read_text() == "mine"
