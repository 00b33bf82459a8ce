"""``edl6dof params`` and ``schema``."""

from __future__ import annotations

import json

import pytest
from cli_run import run

from edl6dof.api.schema_files import scenario_schema


def test_section_shows_everything_about_its_parameters(capsys, monkeypatch):
    code, out, err = run(capsys, monkeypatch, "params", "vehicle.parachutes")
    assert (code, err) == (0, "")
    lines = out.splitlines()
    assert "vehicle.parachutes[]" in lines
    first = next(i for i, line in enumerate(lines) if line.startswith("  pack_drag_area_m2 "))
    assert lines[first].split() == ["pack_drag_area_m2", "0.3", "m2", ">=", "0,", "<=", "50000"]
    said = " ".join(line.strip() for line in lines[first + 1 : first + 3])
    assert said.startswith("drag area of the pack before line stretch; usually 0.001 to 3: packs of drogues")
    assert said.endswith("(estimate)")
    assert "initial" not in out


def test_every_parameter_is_legible_on_80_columns(capsys, monkeypatch):
    code, out, _ = run(capsys, monkeypatch, "params")
    assert code == 0
    too_wide = [line for line in out.splitlines() if len(line) > 80 and " " in line.strip()]
    assert not too_wide
    assert "\x1b" not in out


@pytest.mark.parametrize(
    "path",
    [
        pytest.param("vehicle.rcs.thrusters", marks=pytest.mark.long),
        pytest.param("vehicle.rcs.thrusters[]", marks=pytest.mark.long),
        "vehicle.rcs.thrusters.0",
        "vehicle.rcs.thrusters[].thrust_n",
    ],
)
def test_list_items_are_found_by_any_spelling(path, capsys, monkeypatch):
    code, out, _ = run(capsys, monkeypatch, "params", path)
    assert code == 0
    assert "thrust_n" in out


def test_one_parameter(capsys, monkeypatch):
    code, out, _ = run(capsys, monkeypatch, "params", "simulation.step_s")
    assert code == 0
    assert out.splitlines()[0] == "simulation"
    assert out.splitlines()[1].split() == ["step_s", "0.02", "s", ">=", "0.0001,", "<=", "0.1"]
    assert len(out.splitlines()) == 3


def test_part_of_a_name_finds_it_anywhere(capsys, monkeypatch):
    code, out, _ = run(capsys, monkeypatch, "params", "MORTAR_speed")
    assert code == 0
    assert "vehicle.parachutes[]" in out
    assert "mortar_speed_m_s" in out


def test_unknown_path_names_the_nearest(capsys, monkeypatch):
    code, out, err = run(capsys, monkeypatch, "params", "vehicle.parashute")
    assert (code, out) == (2, "")
    assert "did you mean 'vehicle.parachutes'?" in err
    assert len(err.splitlines()) == 1


def test_json_has_the_same_rows(capsys, monkeypatch):
    code, out, _ = run(capsys, monkeypatch, "params", "vehicle.parachutes", "--json")
    assert code == 0
    found = {row["path"]: row for row in json.loads(out)}
    assert found["vehicle.parachutes[].mortar_speed_m_s"] == {
        "path": "vehicle.parachutes[].mortar_speed_m_s",
        "type": "number",
        "unit": "m/s",
        "bounds": "> 0 and <= 100000",
        "default": "required",
        "meaning": "speed of the pack relative to the vehicle at mortar fire",
        "status": "design",
        "source": "",
        "printed": "",
        "usual": "5 to 60: mortars that have flown",
    }
    assert all(path.startswith("vehicle.parachutes[]") for path in found)


def test_schema_describes_units_for_editors():
    text = json.dumps(scenario_schema())
    assert "integration step [s]" in text
    assert '"record"' not in text
