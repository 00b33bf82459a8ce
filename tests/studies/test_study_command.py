"""``edl6dof study``: list, refusals, exit status, files; a study of two rows stands in for the papers."""

from __future__ import annotations

import json
import sys
from dataclasses import replace

import in_process
import numpy as np
import pyarrow.parquet as pq
import pytest

from edl6dof.cli.evidence import study as run_study
from edl6dof.config.errors import ConfigError
from edl6dof.studies import STUDIES
from edl6dof.studies.frame import SQUARE, Curve, Finding, Grid, Panel, Report, Study


def small(session):
    x = np.linspace(0.0, 1.0, 5)
    curves = [Curve(x, x), Curve(x, x, "goal", "reference"), Curve(x, x, "runs", "dots")]
    panels = [Panel(f"panel {k}", "x", "y", [curve], SQUARE) for k, curve in enumerate(curves)]
    session.total = session.flights
    session.step(session.flights)
    findings = (
        Finding("kept", "m", 1.0, 2.0, "<="),
        Finding("side by side", "m", 3.0, 2.0),
        Finding("bound", "", float(session.flights), 5.0, ">="),
    )
    rows = [{"truth.mass_kg": 1.0}] * session.flights
    return Report(findings, rows, session.flights, (), ("A remark.",), {"figure": panels})


SMALL = Study("small", "A small study", "Nobody 2000", small, runs=9, quick_runs=6)


def of(*findings, grids=()):
    """A study of these findings."""
    return Study("small", "t", "s", lambda session: Report(findings, [{"x_m": 1.0}], 1, grids))


@pytest.fixture(autouse=True)
def registered(monkeypatch):
    monkeypatch.setitem(STUDIES, "small", SMALL)


def test_every_study_names_itself_its_source_and_its_runs():
    for name, study in STUDIES.items():
        assert study.name == name and study.title and study.source
        assert 1 <= study.quick_runs <= study.runs


def test_without_a_name_studies_are_listed(capsys):
    assert run_study(None) == 0
    shown = capsys.readouterr().out
    assert all(name in shown for name in STUDIES)


def test_unknown_study_is_refused_with_a_hint(capsys):
    assert run_study("smal") == 2  # codespell:ignore smal
    assert "did you mean 'small'" in capsys.readouterr().err


@pytest.mark.parametrize("runs", [0, -3])
def test_no_runs_are_refused(runs, tmp_path, capsys):
    assert run_study("small", runs=runs, out=tmp_path / "s") == 2
    assert "must be 1 to 1000000" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_a_fixed_set_of_flights_has_no_number(monkeypatch, capsys):
    monkeypatch.setitem(STUDIES, "small", Study("small", "t", "s", small))
    assert run_study("small", runs=4) == 2
    assert "fixed set" in capsys.readouterr().err


def test_files_are_written_and_what_is_there_is_kept(tmp_path, capsys):
    out = tmp_path / "deep" / "s"
    assert run_study("small", out=out) == 0
    assert sorted(path.name for path in out.iterdir()) == [
        "figure.png",
        "manifest.json",
        "runs.parquet",
        "summary.json",
    ]
    table = pq.read_table(out / "runs.parquet")
    assert table.num_rows == 9
    assert table.schema.field("truth.mass_kg").metadata[b"unit"] == b"kg"
    assert table.schema.metadata[b"study"] == b"small"
    with pytest.raises(ConfigError, match="exists; choose another folder"):
        run_study("small", out=out)
    assert run_study("small", out=out, quick=True, force=True) == 0
    assert pq.read_table(out / "runs.parquet").num_rows == 6
    shown = capsys.readouterr().out
    assert "A remark." in shown and "every requirement is met" in shown


def test_missed_bound_is_named_and_fails_the_command(tmp_path, capsys):
    assert run_study("small", runs=2, out=tmp_path / "s") == 1
    assert "violated: bound" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("finding", "ok", "result"),
    [
        (Finding("a", "km", 2.2, 2.4), True, ""),
        (Finding("a", "km", 2.2, 2.4, within=0.1), True, "within 9 %"),
        (Finding("a", "km", 2.6, 2.4, within=0.1), True, "within 9 %"),
        (Finding("a", "km", 2.7, 2.4, within=0.1), False, "not reproduced"),
        (Finding("a", "km", 2.1, 2.4, within=0.1), False, "not reproduced"),
        (Finding("a", "km", 2.7, 2.4, within=0.1, why="shown below"), True, "not reproduced"),
        (Finding("a", "km", 2.5, 2.4, within=0.1, why="shown below"), False, "within 5 %"),
        (Finding("a", "km", 2.5, 2.4, "<=", why="shown below"), True, "not met"),
        (Finding("a", "km", 2.3, 2.4, "<=", why="shown below"), False, "met"),
        (Finding("a", "km", float("nan"), 2.4, "<=", why="shown below"), False, "not met"),
    ],
)
def test_a_value_is_compared_on_both_sides_and_what_is_explained_must_not_hold(finding, ok, result):
    assert (finding.ok, finding.result) == (ok, result)


def test_outcome_counts_what_is_reproduced_and_shows_why_the_rest_is_not(monkeypatch, tmp_path, capsys):
    near = Finding("near", "km", 2.5, 2.4, within=0.1)
    far = Finding("far", "km", 9.0, 2.4, within=0.1, why="thinner air")
    monkeypatch.setitem(STUDIES, "small", of(near, far))
    monkeypatch.setenv("COLUMNS", "120")
    assert run_study("small", out=tmp_path / "s") == 0
    shown = capsys.readouterr().out
    assert "every figure that does not hold is explained; 1 of 2 published values reproduced" in shown
    assert "within 5 %" in shown and "not reproduced" in shown and "thinner air" in shown


def test_experiments_stand_apart(monkeypatch, tmp_path, capsys):
    printed = Finding("miss", "km", 9.5, 10.0, within=0.1, experiment="as printed")
    other = Finding("miss", "km", 3.0, experiment="with gains on [rate, error]")
    monkeypatch.setitem(STUDIES, "small", of(printed, other))
    assert run_study("small", out=tmp_path / "s") == 0
    shown = capsys.readouterr().out
    assert shown.index("as printed") < shown.index("within") < shown.index("with gains on [rate, error]")


def test_json_is_json_also_where_a_figure_could_not_be_formed(monkeypatch, tmp_path, capsys):
    monkeypatch.setitem(STUDIES, "small", of(Finding("lost", "m", float("nan"), 2.0, "<=")))
    assert run_study("small", out=tmp_path / "s", as_json=True) == 1
    answer = json.loads(capsys.readouterr().out, parse_constant=pytest.fail)
    assert answer["findings"][0]["computed"] is None and not answer["ok"]


def test_interrupted_study_leaves_nothing(monkeypatch, tmp_path, capsys):
    def interrupted(session):
        raise KeyboardInterrupt

    monkeypatch.setitem(STUDIES, "small", Study("small", "t", "s", interrupted))
    monkeypatch.setattr(sys, "argv", ["edl6dof", "study", "small", "--out", str(tmp_path / "s")])
    with pytest.raises(SystemExit) as end:
        in_process.main()
    assert end.value.code == 130
    assert capsys.readouterr().err == "interrupted; nothing was written\n"
    assert not list(tmp_path.iterdir())


def test_table_of_twelve_columns_is_whole_on_a_narrow_terminal(monkeypatch, tmp_path, capsys):
    """Headings stand in words below each other, a column has one number of decimals, and no number is cut."""
    heads = ("law", *(f"fig. {i} m/s2" for i in range(10)), "call us")
    rows = (
        ("long_name_law", *[12.345] * 10, 0.1234),
        ("npc", float("inf"), *[123.46] * 8, float("nan"), 53.4),
        ("other", *[9.8765] * 10, 0.2),
    )
    grid = Grid("A comparison", heads, rows)
    monkeypatch.setitem(
        STUDIES,
        "small",
        Study("small", "t", "s", lambda session: replace(small(session), grids=(grid,))),
    )
    monkeypatch.setenv("COLUMNS", "80")
    assert run_study("small", out=tmp_path / "s") == 1
    lines = capsys.readouterr().out.splitlines()[:7]
    assert max(map(len, lines)) <= 80
    assert lines[4].split() == ["long_name_law", *["12.3"] * 10, "0.12"]
    assert lines[5].split() == ["npc", "fails", *["123.5"] * 8, "-", "53.40"]
    assert [len(line) for line in lines[4:]] == [len(lines[4])] * 3


def test_parts_may_be_chosen_and_unknown_ones_are_refused(monkeypatch, tmp_path, capsys):
    flown = []

    def of_parts(session):
        flown.append(session.parts)
        return small(session)

    monkeypatch.setitem(STUDIES, "small", Study("small", "t", "s", of_parts, parts=("a", "b", "c")))
    run_study("small", out=tmp_path / "s", only=("c", "a"))
    assert flown == [["a", "c"]]
    assert run_study("small", out=tmp_path / "t", only=("a", "d")) == 2
    assert "--only d: must be one of a, b, c" in capsys.readouterr().err
    monkeypatch.setitem(STUDIES, "small", SMALL)
    assert run_study("small", out=tmp_path / "t", only=("a",)) == 2
    assert "--only a: must be left out: this study is one whole" in capsys.readouterr().err
    assert not (tmp_path / "t").exists()


def shown_by(study, monkeypatch, tmp_path, capsys):
    monkeypatch.setitem(STUDIES, "small", study)
    monkeypatch.setenv("COLUMNS", "80")
    run_study("small", out=tmp_path / "s")
    return capsys.readouterr().out.splitlines()


def test_headings_keep_numbers_with_their_units_and_whole_numbers_are_whole(monkeypatch, tmp_path, capsys):
    heads = ("law", "n", "L/D -20 %", "density +40 %", "stuck 5 s", "load g")
    rows = (("npc", 20.0, 0.5, 3.25, 7.5, 6.0), ("fnpeg", 4.0, 0.25, 3.5, 2.5, 6.25))
    grid = Grid("of all at 95 %", heads, rows)
    lines = shown_by(of(grids=(grid,)), monkeypatch, tmp_path, capsys)
    assert [line.split() for line in lines[1:5]] == [
        ["L/D", "density", "stuck", "load"],
        ["law", "n", "-20", "%", "+40", "%", "5", "s", "g"],
        ["npc", "20", "0.50", "3.25", "7.50", "6.00"],
        ["fnpeg", "4", "0.25", "3.50", "2.50", "6.25"],
    ]


def test_a_wide_table_parts_numbers_from_units_and_not_from_percent_signs(monkeypatch, tmp_path, capsys):
    heads = ("law", *(f"bank {k} m/s" for k in range(1, 12)), "L/D -20 %")
    grid = Grid("wide", heads, (("constant_thrust", *([0.5] * 12)),))
    lines = shown_by(of(grids=(grid,)), monkeypatch, tmp_path, capsys)
    assert lines[3].split() == ["law", *["m/s"] * 11, "-20", "%"] and max(map(len, lines[:5])) <= 80


def test_no_word_of_a_finding_is_broken_at_eighty_columns(monkeypatch, tmp_path, capsys):
    findings = (
        Finding("tianwen1_range_trigger: 99 % of misses, best law", "km", float("nan"), note="n = 20"),
        Finding("polynomial: dispersed landings", "%", 100.0, 99.0, ">="),
    )
    lines = shown_by(of(*findings), monkeypatch, tmp_path, capsys)
    table = lines[: next(k for k, line in enumerate(lines) if "/s: " in line)]
    assert max(map(len, table)) <= 80
    words = " ".join(table).split()
    assert {"tianwen1_range_trigger:", "polynomial:", "dispersed", "landings", "met"} <= set(words)
    assert any(line.strip() == "n = 20" for line in table), "what is to be known stands below its figure"
