"""Shared flights: the nominal is flown once for the whole session, in each process of it."""

from __future__ import annotations

import signal

import pytest

import edl6dof


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
