"""The table that an undisturbed campaign gives."""

from __future__ import annotations

import pytest
from campaign_run import finished, write_drop


@pytest.fixture(scope="session")
def undisturbed(tmp_path_factory) -> bytes:
    """``cases.parquet`` of the small campaign flown in one go by one thread."""
    folder = tmp_path_factory.mktemp("undisturbed")
    status, _, err = finished("campaign", write_drop(folder), "--workers", "1", "-q", cwd=folder)
    assert status == 0, err
    return (folder / "runs" / "drops" / "cases.parquet").read_bytes()
