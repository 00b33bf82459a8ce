"""``edl6dof verify``: exit status, JSON, plots and names; the cases themselves are proved one by one beside
this file.
"""

from __future__ import annotations

import json
import math

import pytest

from edl6dof.cli.evidence_tables import run_cases
from edl6dof.verify import check
from edl6dof.verify.case import NotInstalledError, Report, Result

FAILING = Report((Result("quantity", math.nan, 1.0, "m", "model", "source", "why"),))


def broken():
    raise RuntimeError("boom")


def absent():
    raise NotInstalledError("no data")


def test_json_of_two_cases(capsys):
    assert run_cases(["kepler", "rotations"], True, None) == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer["passed"] and [case["case"] for case in answer["cases"]] == ["kepler", "rotations"]
    result = answer["cases"][0]["results"][0]
    assert 0.0 < result["error"] < result["tolerance"] and result["passed"]
    assert all(result[key] for key in ("quantity", "verifies", "source", "why", "unit"))


@pytest.mark.parametrize(
    ("case", "text"), [(lambda: FAILING, "FAIL"), (broken, "boom"), (lambda: Report(()), "FAILED")]
)
def test_a_case_that_fails_or_breaks_or_proves_nothing_fails_the_command(monkeypatch, capsys, case, text):
    monkeypatch.setitem(check.CASES, "kepler", case)
    assert run_cases(["kepler", "us76_table"], False, None) == 1
    assert text in capsys.readouterr().out
    assert run_cases(["kepler"], True, None) == 1
    json.loads(capsys.readouterr().out, parse_constant=pytest.fail)


def test_missing_reference_data_skip_the_case_with_a_line(monkeypatch, capsys):
    monkeypatch.setitem(check.CASES, "nesc", absent)
    assert check.run_case("nesc").skipped
    assert run_cases(["nesc", "us76_table"], False, None) == 0
    assert "skipped: nesc: no data" in capsys.readouterr().out


def test_unknown_case_is_refused_with_a_hint(capsys):
    assert run_cases(["keplr"], False, None) == 2
    assert "kepler" in capsys.readouterr().err


def test_plots(tmp_path):
    pytest.importorskip("matplotlib")
    assert run_cases(["kepler", "rotations"], True, tmp_path / "plots") == 0
    assert {path.name for path in (tmp_path / "plots").iterdir()} == {"kepler.png", "made.json"}
