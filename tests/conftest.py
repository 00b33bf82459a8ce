"""Shared flights: the nominal is flown once for the whole session, in each process of it."""

from __future__ import annotations

import signal

import in_process  # noqa: F401  whoever calls the program, it is put together once
import pytest

import edl6dof

#: Files that take longest, the longest first: begun last, one would run alone while the other processes have
#: nothing left to do.
LONGEST = (
    *("test_plugins.py", "test_damaged_runs.py", "test_files_of_failed_flights.py", "test_dask.py"),
    *("test_phase_roles.py", "test_campaign_damage.py", "test_calibration.py", "test_bounds_check.py"),
    *("test_types.py", "test_error_state_consistency.py", "test_nothing_is_lost.py"),
    *("test_campaign_kills.py", "test_fuzz.py", "test_report_rendered.py", "test_rendered.py"),
    *("test_server.py", "test_hu2022.py"),
)


def pytest_collection_modifyitems(items):
    """Begin with the longest files."""
    place = {name: number for number, name in enumerate(LONGEST)}
    items.sort(key=lambda item: place.get(item.path.name, len(place)))


@pytest.fixture(scope="session")
def nominal():
    """The nominal Tianwen-1 flight."""
    return edl6dof.fly("tianwen1")


def pytest_sessionstart(session):
    """Compile the simulator before several processes start, so that only one of them does.

    Programs that tests start answer Ctrl-C, which a shell has those ignore that it runs in the background.
    """
    signal.signal(signal.SIGINT, signal.default_int_handler)
    if not hasattr(session.config, "workerinput") and session.config.getoption("numprocesses", None):
        edl6dof.fly("tianwen1", ["simulation.time_limit_s=1"])
