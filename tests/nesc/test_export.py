"""``edl6dof fly nesc/case06`` ends with status 0, and ``edl6dof export RUN --nesc`` writes the check cases'
own table.
"""

import csv
import sys
from pathlib import Path

import in_process
import numpy as np
import pytest

from edl6dof.export.nesc import COLUMNS
from edl6dof.verify.nesc import TOLERANCES, differences, reference


def run(capsys, monkeypatch, *words):
    monkeypatch.setattr(sys, "argv", ["edl6dof", *words])
    with pytest.raises(SystemExit) as end:
        in_process.main()
    out, err = capsys.readouterr()
    return end.value.code, out, err


@pytest.fixture
def folder(capsys, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    code, out, _ = run(capsys, monkeypatch, "fly", "nesc/case06", "--no-replay", "-q")
    assert code == 0 and "flown to the time limit (at t = 30.0 s)" in out
    return tmp_path / "runs" / "nesc_case06"


@pytest.mark.exact_start
def test_table_of_a_run(folder, capsys, monkeypatch):
    assert run(capsys, monkeypatch, "export", str(folder), "--nesc", "case06.csv")[0] == 0
    with open("case06.csv", encoding="utf-8", newline="") as stream:
        header, *rows = csv.reader(stream)
    assert header == list(COLUMNS) and len(rows) == 301 and rows[1][0] == "0.1"
    table = {column: np.array([float(row[k]) for row in rows]) for k, column in enumerate(header)}
    found = differences(table, reference(6))
    assert all(found[quantity] <= limit for _, quantity, limit, _ in TOLERANCES)


def test_same_bits_from_the_resolved_scenario(folder, capsys, monkeypatch):
    assert (
        run(capsys, monkeypatch, "fly", str(folder / "scenario.yaml"), "--no-replay", "-q", "--out", "again")[
            0
        ]
        == 0
    )
    for place in (str(folder), "again"):
        assert run(capsys, monkeypatch, "export", place, "--nesc")[0] == 0
    assert (folder / "nesc.csv").read_bytes() == Path("again/nesc.csv").read_bytes()


def test_standard_output_existing_file_and_wrong_folder(folder, capsys, monkeypatch):
    code, out, _ = run(capsys, monkeypatch, "export", str(folder), "--nesc", "-")
    assert code == 0 and out.startswith("time,eiPosition_ft_X,") and out.count("\n") == 302
    assert run(capsys, monkeypatch, "export", str(folder), "--nesc")[0] == 0
    (made,) = folder.glob("*nesc*.csv")
    made.write_text("the user's own")
    code, _, err = run(capsys, monkeypatch, "export", str(folder), "--nesc")
    assert code == 2 and "exists" in err and made.read_text() == "the user's own"
    code, _, err = run(capsys, monkeypatch, "export", "nowhere", "--nesc")
    assert code == 2 and "no such folder" in err and err.count("\n") == 1
    assert run(capsys, monkeypatch, "export", str(folder))[0] == 2
