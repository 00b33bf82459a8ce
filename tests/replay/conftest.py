"""What the tests of the replay share: a recording of the flight that a file names, the made-up one unless it
says otherwise.
"""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import pytest
from made_up import synthetic_flight

from edl6dof.replay.recording import history, write_replay


@pytest.fixture(scope="module")
def flight() -> SimpleNamespace:
    """The made-up flight."""
    return synthetic_flight()


@pytest.fixture(scope="module")
def replay(flight, tmp_path_factory) -> Path:
    """A recording of the flight."""
    pytest.importorskip("rerun")
    path = tmp_path_factory.mktemp("replay") / "replay.rrd"
    write_replay([history(flight)], path)
    return path
