"""The replay that a second process draws is what this one would draw; where it fails, this one draws."""

from __future__ import annotations

import os
import signal
import sys
import time

import numpy as np
import pytest

import edl6dof
from edl6dof.app import replay_beside
from edl6dof.app.fly import FlyOptions, run_fly
from edl6dof.app.replay_beside import artist_beside
from edl6dof.replay.recording import history

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="forks on Linux only")
BRIEF = ("simulation.time_limit_s=3",)


@pytest.fixture
def alone(monkeypatch):
    """As in the command line: two cores, no other threads."""
    monkeypatch.setattr(replay_beside.threading, "active_count", lambda: 1)
    monkeypatch.setattr(replay_beside.os, "sched_getaffinity", lambda _: {0, 1})


def test_the_other_process_has_the_flight_as_this_one_has_it(alone, tmp_path, monkeypatch):
    loaded = edl6dof.load("tianwen1", BRIEF)

    def drawn(flights, path):
        path.write_bytes(np.ascontiguousarray(flights[0].columns["truth.site_up_m"]).tobytes())

    monkeypatch.setattr("edl6dof.replay.recording.write_replay", drawn)
    with artist_beside(loaded, tmp_path / "replay.rrd") as artist:
        flight = edl6dof.fly(loaded, log=artist.log.take())
        artist.draw(flight)
        assert artist.wait()
    wanted = history(flight).columns["truth.site_up_m"]
    assert len(wanted) > 50
    assert np.array_equal(np.frombuffer((tmp_path / "replay.rrd").read_bytes()), wanted)


def test_what_goes_wrong_there_is_told(alone, tmp_path, monkeypatch):
    def broken(*_):
        raise OSError("no space left")

    monkeypatch.setattr("edl6dof.replay.recording.write_replay", broken)
    loaded = edl6dof.load("tianwen1", BRIEF)
    with artist_beside(loaded, tmp_path / "replay.rrd") as artist:
        artist.draw(edl6dof.fly(loaded, log=artist.log.take()))
        assert not artist.wait()


def test_where_the_other_process_fails_this_one_draws_the_same(alone, tmp_path, monkeypatch):
    here = os.getpid()

    def drawn(flights, path):
        if os.getpid() != here:
            os.kill(os.getpid(), signal.SIGKILL)
        path.write_bytes(flights[0].columns["truth.site_up_m"].tobytes())

    monkeypatch.setattr("edl6dof.replay.recording.write_replay", drawn)
    target = tmp_path / "run"
    run_fly(FlyOptions("tianwen1", BRIEF, target, False, True, False, True, False, None, None))
    wanted = history(edl6dof.fly("tianwen1", BRIEF)).columns["truth.site_up_m"]
    assert np.array_equal(np.frombuffer((target / "replay.rrd").read_bytes()), wanted)


def test_ctrl_c_leaves_the_other_process_to_this_one(alone, tmp_path):
    with artist_beside(edl6dof.load("tianwen1"), tmp_path / "x") as artist:
        os.kill(artist._process, signal.SIGINT)
        time.sleep(0.1)
        assert os.waitpid(artist._process, os.WNOHANG) == (0, 0)
    assert signal.SIGINT not in signal.pthread_sigmask(signal.SIG_BLOCK, [])  # of this one


def test_nobody_is_left_behind_where_the_flight_fails(alone, tmp_path):
    with pytest.raises(ZeroDivisionError), artist_beside(edl6dof.load("tianwen1"), tmp_path / "x") as artist:
        process = artist._process
        raise ZeroDivisionError
    with pytest.raises(ProcessLookupError):
        os.kill(process, 0)
    assert not (tmp_path / "x").exists()


def test_beside_other_threads_this_process_draws(tmp_path, monkeypatch):
    monkeypatch.setattr(replay_beside.threading, "active_count", lambda: 2)
    with artist_beside(edl6dof.load("tianwen1"), tmp_path / "x") as artist:
        assert artist is None
