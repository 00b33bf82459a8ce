"""Shared flights: the nominal is flown once for the whole session, in each process of it."""

from __future__ import annotations

import gc
import os
import signal
import subprocess
import sys
from pathlib import Path
from shutil import rmtree
from tempfile import mkdtemp

import pytest
from filelock import FileLock

import edl6dof

#: Files that compile what others need, which would do so at the same time; then those that take longest, the
#: longest first: begun last, one would run alone while the other processes have nothing left to do.
FIRST = (
    *("test_members_write_their_own.py", "test_world_families.py"),
    *("test_plugins.py", "test_files_of_failed_flights.py", "test_bank_travel.py", "test_damaged_runs.py"),
    *("test_error_state_consistency.py", "test_bounds_check.py", "test_rigid_landing.py"),
    *("test_campaign_kills.py", "test_campaign_damage.py", "test_dask.py"),
    *("test_nothing_is_lost.py", "test_attack.py", "test_report_rendered.py", "test_rendered.py"),
    *("test_server.py", "test_hu2022.py"),
)

#: Held by the process that collects its tests: the next finds their bytecode on disk.
COLLECTS = pytest.StashKey[FileLock]()
#: Folder of the user's settings.
SETTINGS = pytest.StashKey[str]()
#: The process that compiles, and what it does.
COMPILING = pytest.StashKey[subprocess.Popen]()
COMPILED = "import edl6dof; edl6dof.fly('tianwen1', ['simulation.time_limit_s=1'])"


def pytest_addoption(parser):
    parser.addoption(
        "--nudge",
        type=float,
        default=0.0,
        metavar="SHARE",
        help="move the initial state of every flight by this share",
    )


def pytest_configure(config):
    """Give the suite a user who has accepted no plugin; move initial states before a module is imported."""
    if not hasattr(config, "workerinput"):
        os.environ["XDG_CONFIG_HOME"] = config.stash[SETTINGS] = mkdtemp(prefix="edl6dof-settings-")
    if by := config.getoption("nudge"):
        from nudged import nudge_initial_states

        nudge_initial_states(by)


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_auto_num_workers():
    """One process more than there are cores: tests wait for the programs that they start."""
    return os.cpu_count() + 1


def pytest_collection_finish(session):
    """What is loaded stays: it is not searched for garbage, the rest less often (4 % of the suite's time)."""
    if lock := session.config.stash.get(COLLECTS, None):
        lock.release()
    gc.freeze()
    gc.set_threshold(50_000, 20, 20)


def pytest_unconfigure(config):
    """Remove the settings of the suite's user."""
    rmtree(config.stash.get(SETTINGS, ""), ignore_errors=True)


def pytest_sessionfinish():
    """What is left at the end goes with the process: pytest would search it for garbage twice."""
    gc.freeze()


def pytest_collection_modifyitems(config, items):
    """Begin with the files that come first; skip what needs the exact initial state where it is moved."""
    if config.getoption("nudge"):
        skipped = pytest.mark.skip(reason="needs the exact initial state, which --nudge moves")
        for item in items:
            if item.get_closest_marker("exact_start"):
                item.add_marker(skipped)
    place = {name: number for number, name in enumerate(FIRST)}
    items.sort(key=lambda item: place.get(item.path.name, len(place)))


@pytest.fixture(scope="session")
def nominal():
    """The nominal Tianwen-1 flight."""
    return edl6dof.fly("tianwen1")


def pytest_sessionstart(session):
    """Start compiling the simulator, so that only one process does; the others collect their tests meanwhile,
    one after the other: the first writes the bytecode of the tests.

    Programs that tests start answer Ctrl-C, which a shell has those ignore that it runs in the background.
    They find the bytecode of the sources on disk, whether it is written usually or not: else each would make
    it again.
    """
    signal.signal(signal.SIGINT, signal.default_int_handler)
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
    if hasattr(session.config, "workerinput"):
        session.config.stash[COLLECTS] = FileLock(Path(__file__).parent / "__pycache__" / "collecting.lock")
        session.config.stash[COLLECTS].acquire()
    elif session.config.getoption("numprocesses", None):
        session.config.stash[COMPILING] = subprocess.Popen([sys.executable, "-c", COMPILED])


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_node_collection_finished(node):
    """No test begins before the simulator is compiled."""
    if compiling := node.config.stash.get(COMPILING, None):
        compiling.wait()
