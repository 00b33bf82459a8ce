"""One run folder of the nominal flight for all tests of reports."""

from __future__ import annotations

import pytest

from edl6dof.manifest import seal
from edl6dof.runs.run import Run, write_run


@pytest.fixture(scope="session")
def run(nominal, tmp_path_factory):
    """The nominal flight, read back from its files."""
    folder = tmp_path_factory.mktemp("runs") / "nominal"
    folder.mkdir()
    write_run(nominal, folder)
    seal(folder, "flight")
    return Run(folder)
