"""One command in an empty folder, and the table that an undisturbed campaign gives."""

from __future__ import annotations

import sys

import in_process
import pytest
from campaign_run import write_drop
from forked import finished


@pytest.fixture
def edl6dof(capsys, monkeypatch, tmp_path):
    """Run one command in an empty folder: status, stdout, stderr."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "100")

    def run(*words: str) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["edl6dof", *words])
        with pytest.raises(SystemExit) as end:
            in_process.main()
        out, err = capsys.readouterr()
        return int(end.value.code or 0), out, err

    return run


@pytest.fixture(scope="session")
def undisturbed(tmp_path_factory) -> bytes:
    """``cases.parquet`` of the small campaign flown in one go by one thread."""
    folder = tmp_path_factory.mktemp("undisturbed")
    status, _, err = finished("campaign", write_drop(folder), "--workers", "1", "-q", cwd=folder)
    assert status == 0, err
    return (folder / "runs" / "drops" / "cases.parquet").read_bytes()
