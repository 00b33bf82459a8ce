"""What the tests of the replay share: a recording of the flight that a file names, the made-up one unless it
says otherwise.
"""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import pytest
from made_up import synthetic_flight

from edl6dof.replay.recording import history, write_replay


@pytest.fixture(scope="session")
def made_up_flight() -> SimpleNamespace:
    """The made-up flight; for reading only."""
    return synthetic_flight()


@pytest.fixture(scope="session")
def recording(made_up_flight, tmp_path_factory) -> Path:
    """A recording of the made-up flight."""
    return recorded(made_up_flight, tmp_path_factory)


@pytest.fixture(scope="module")
def flight(made_up_flight) -> SimpleNamespace:
    """The flight that a file is about: the made-up one where it names no other."""
    return made_up_flight


@pytest.fixture(scope="module")
def replay(request, flight, made_up_flight, tmp_path_factory) -> Path:
    """A recording of that flight."""
    if flight is made_up_flight:
        return request.getfixturevalue("recording")
    return recorded(flight, tmp_path_factory)


def recorded(flight: SimpleNamespace, tmp_path_factory: pytest.TempPathFactory) -> Path:
    pytest.importorskip("rerun")
    path = tmp_path_factory.mktemp("replay") / "replay.rrd"
    write_replay([history(flight)], path)
    return path
