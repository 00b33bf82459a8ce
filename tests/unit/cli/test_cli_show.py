"""``edl6dof show``: the values of a scenario, and where they come from."""

from __future__ import annotations

import json

import pytest
from cli_run import ROOT, run, spawn
from pydantic_core import to_jsonable_python

import edl6dof
from edl6dof.config.document.yamltree import parse_yaml
from edl6dof.config.model_paths import value_at
from edl6dof.config.parameter_table import Value, rows, values
from edl6dof.report.parameters import select
from edl6dof.scenario.schema import Scenario


def shown(capsys, monkeypatch, *words):
    code, out, err = run(capsys, monkeypatch, "show", *words, "--json")
    assert (code, err) == (0, "")
    return json.loads(out)


def test_value_has_everything_about_its_parameter_and_its_place(capsys, monkeypatch):
    code, out, err = run(capsys, monkeypatch, "show", "tianwen1", "vehicle.mass.entry_kg")
    assert (code, err) == (0, "")
    head, line, *words = out.splitlines()
    assert head == "vehicle.mass" and line.split() == ["entry_kg", "1284.0", "kg", ">", "0,", "<=", "1e+09"]
    said = " ".join(word.strip() for word in words)
    assert said.startswith("mass of the whole vehicle at entry interface") and "(calibrated: " in said
    place, _, number = said.removesuffix("]").rpartition(" [")[2].rpartition(":")
    (written,) = ROOT.joinpath(place).read_text().splitlines()[int(number) - 1 : int(number)]
    assert written.strip().startswith("entry_kg: 1284")
    assert max(map(len, out.splitlines())) <= 80


@pytest.mark.parametrize(
    "words, value, origin",
    [
        (["tianwen1", "vehicle.mass.entry_products_kg_m2"], "[0.0, 0.0, 0.0]", "default"),
        (["tianwen1", "seed", "--set", "seed=4"], "4", "--set seed=4"),
        (
            ["tianwen1_hazards", "terrain.landing_area.model"],
            "generated",
            "scenarios/tianwen1_hazards.yaml:10",
        ),
    ],
)
def test_origin_is_the_last_that_gave_the_value(words, value, origin, capsys, monkeypatch):
    (row,) = [row for row in shown(capsys, monkeypatch, *words) if row["path"] == words[1]]
    assert (row["value"], row["origin"]) == (value, origin)


@pytest.mark.parametrize("item", ["D4", "3"])
def test_items_go_by_name_and_by_index(item, capsys, monkeypatch):
    (row,) = shown(capsys, monkeypatch, "tianwen1", f"vehicle.rcs.thrusters.{item}.thrust_n")
    assert row["path"] == "vehicle.rcs.thrusters.D4.thrust_n" and row["value"] == "250.0"


def test_every_value_of_the_scenario_is_shown_as_it_is_and_params_knows_its_path():
    loaded = edl6dof.load("tianwen1")
    found = list(values(loaded.scenario, loaded.document))
    assert len(found) > 1500 and len({one.place for one in found}) == len(found)
    for one in found:
        whole = to_jsonable_python(value_at(loaded.scenario, one.place))
        assert parse_yaml(f"x: {one.value}", "").data["x"] == whole
    table = [Value(row, "", row.path, "") for row in rows(Scenario)]
    missing = [one.row.path for one in found[::25] if not select(table, one.row.path)]
    assert missing == []


def test_parameters_of_a_plugin_are_shown(tmp_path):
    """In a process of its own, whose families take it in."""
    done = spawn(["show", "plugin/energy_law", "energy_law.gain", "--json"], tmp_path)
    out, err = done.communicate()
    assert (done.returncode, err) == (0, "")
    (row,) = json.loads(out)
    assert row["path"] == "flight_software.guidance.entry.energy_law.gain"
    assert row["value"] == "2.0" and row["meaning"] == "change of that cosine per relative drag error"


def test_differences_have_both_values_and_both_places(capsys, monkeypatch):
    words = ("show", "tianwen1", "--set", "vehicle.mass.entry_kg=1350", "--diff", "tianwen1")
    code, out, _ = run(capsys, monkeypatch, *words)
    assert code == 0 and out.splitlines()[:2] == [
        "tianwen1 | tianwen1",
        "vehicle.mass.entry_kg: 1350.0 kg | 1284.0 kg",
    ]
    (row,) = shown(capsys, monkeypatch, *words[1:])
    assert [value["value"] for value in row["values"]] == ["1350.0", "1284.0"]
    code, out, _ = run(capsys, monkeypatch, "show", "tianwen1", "vehicle", "--diff", "tianwen1")
    assert (code, out) == (0, "The scenarios are the same.\n")
    engines = shown(capsys, monkeypatch, "tianwen1", "vehicle.engines", "--diff", "msl")
    assert engines and all(None in row["values"] for row in engines), "the entry of MSL has no engine"


def test_unknown_path_names_the_nearest(capsys, monkeypatch):
    code, out, err = run(capsys, monkeypatch, "show", "tianwen1", "vehicle.parashutes")
    assert (code, out) == (2, "") and "did you mean 'vehicle.parachutes'?" in err


def test_vehicle_is_drawn_and_its_authority_printed(capsys, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    code, out, err = run(capsys, monkeypatch, "show", "tianwen1", "--vehicle")
    assert (code, err) == (0, "") and out.splitlines()[-1] == "vehicle.svg"
    assert max(map(len, out.splitlines())) <= 82
    svg = (tmp_path / "vehicle.svg").read_text()
    assert all(f">{name}</text>" in svg for name in ("D1", "A4", "P1", "F6", "main", "diameter 3.40 m"))
    code, _, err = run(capsys, monkeypatch, "show", "tianwen1", "--vehicle")
    assert code == 2 and "vehicle.svg: exists" in err and "--force" in err
    code, out, _ = run(capsys, monkeypatch, "show", "tianwen1", "--vehicle", "-o", "x.png", "--json")
    assert code == 0 and (tmp_path / "x.png").read_bytes().startswith(b"\x89PNG")
    entry, inside = json.loads(out)
    assert entry["centre_m"] == pytest.approx([-0.85, 0.0, -0.034], abs=1e-3)
    low, high = entry["groups"]["horizontal"]["pure_torque_nm"][0]
    assert high == pytest.approx(4 * 250.0 * 1.06) and low == -high  # two couples, arms of 1.06 m
    assert list(inside["groups"]) == ["horizontal", "axial", "attitude", "fine", "all"]


@pytest.mark.parametrize(
    "words, message",
    [
        (["wu2013", "--vehicle"], "wu2013: has no shape to draw: its dynamics are those of a point mass"),
        (["msl", "vehicle", "--vehicle"], "--vehicle: draws the whole vehicle"),
        (["msl", "--vehicle", "-o", "x.bmp"], "x.bmp: must end in .svg, .png, .pdf"),
    ],
)
def test_vehicle_that_cannot_be_drawn(words, message, capsys, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    code, out, err = run(capsys, monkeypatch, "show", *words)
    assert (code, out, [*tmp_path.iterdir()]) == (2, "", []) and message in err


def test_vehicle_without_thrusters_says_so(capsys, monkeypatch, tmp_path):
    picture = tmp_path / "probe.svg"
    code, out, _ = run(capsys, monkeypatch, "show", "titan_probe", "--vehicle", "-o", str(picture))
    assert code == 0 and "has no thrusters" in out and picture.is_file()


def test_sections_of_many_flights_are_shown_where_the_scenario_has_them(capsys, monkeypatch):
    (cases,) = shown(capsys, monkeypatch, "tianwen1_mc", "campaign.cases")
    assert (cases["value"], cases["origin"].rpartition(":")[0]) == ("1000", "scenarios/tianwen1_mc.yaml")
    paths = [one["path"] for one in shown(capsys, monkeypatch, "tianwen1_mc", "campaign")]
    assert "campaign.truth.vehicle.mass.entry_kg.three_sigma" in paths
    assert shown(capsys, monkeypatch, "tianwen1", "calibration.flights")
    code, _, err = run(capsys, monkeypatch, "show", "tianwen1", "campaign")
    assert code == 2 and "tianwen1 has no such section; edl6dof new campaign tianwen1 writes" in err
    assert run(capsys, monkeypatch, "params", "campaign.sampling")[0] == 0


def test_an_end_of_a_path_is_answered_by_the_whole_path(capsys, monkeypatch):
    code, _, err = run(capsys, monkeypatch, "show", "tianwen1", "mass.entry_kgs")
    assert code == 2 and "did you mean 'vehicle.mass.entry_kg'?" in err
