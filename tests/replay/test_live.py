"""A flight that is shown while it is flown: the viewer gets what a replay contains, each row once."""

from __future__ import annotations

import copy
from collections import Counter
from contextlib import contextmanager, nullcontext
from types import SimpleNamespace

import numpy as np
import pytest
import rerun as rr
from rerun.chunk import RrdReader

import edl6dof
from edl6dof.api import live
from edl6dof.cli.group import UNAVAILABLE
from edl6dof.cli.scenarios import fly
from edl6dof.config.errors import ConfigError
from edl6dof.replay import viewer
from edl6dof.replay.live import Live
from edl6dof.replay.recording import history, write_replay

SHORT = ["simulation.time_limit_s=20", "mission.goal=time"]


def rows(path):
    """Number of rows by entity, of what changes with time."""
    chunks = RrdReader(path).stream().filter(is_static=False).to_chunks()
    found = Counter()
    for chunk in chunks:
        found[chunk.entity_path] += chunk.to_record_batch().num_rows
    return found


@pytest.fixture(scope="module")
def recordings(tmp_path_factory):
    """The recording of a flight shown in five parts, and its replay."""
    folder, planned = tmp_path_factory.mktemp("live"), edl6dof.fly("tianwen1", SHORT)
    simulation = edl6dof.Simulation("tianwen1", SHORT)
    stream = rr.RecordingStream("edl6dof", recording_id="live")
    shown = Live(stream, planned)
    stream.save(str(folder / "live.rrd"), default_blueprint=shown.blueprint)
    while simulation.step(cycles=200):
        shown.update(simulation.flight())
    shown.update(simulation.flight())
    shown.update(simulation.flight())  # nothing new
    stream.disconnect()
    write_replay([history(planned)], folder / "whole.rrd")
    return folder / "live.rrd", folder / "whole.rrd"


def test_viewer_gets_every_entity_of_the_replay(recordings):
    shown, whole = map(rows, recordings)
    assert set(shown) == set(whole) - {"/__properties"}


def test_poses_are_sent_once(recordings):
    """Each update ends with the last row of the flight so far, which the replay may leave out."""
    shown, whole = map(rows, recordings)
    for entity in ("/site/vehicle", "/site/camera"):
        assert whole[entity] <= shown[entity] <= whole[entity] + 5, entity


def test_timeless_entities_are_sent_again_only_when_they_change(recordings):
    chunks = RrdReader(recordings[0]).stream().filter(is_static=True).to_chunks()
    sent = Counter(chunk.entity_path for chunk in chunks)
    assert sent["/site/ground"] == sent["/site/vehicle/lander"] == 1
    assert sent["/site/path"] > 1


def test_without_a_display_the_flight_is_refused_with_the_reason(tmp_path, monkeypatch, capsys):
    for name in ("DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"):
        monkeypatch.delenv(name, raising=False)
    assert fly("tianwen1", sets=SHORT, live=True, out=tmp_path / "run") == UNAVAILABLE
    assert "viewer" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_live_excludes_saving_a_state():
    with pytest.raises(ConfigError, match="--live: shows a whole flight"):
        fly("tianwen1", live=True, save_state=10.0)


def test_a_flight_in_the_viewer_is_the_same_flight(monkeypatch):
    """In a viewer without a window, which ends at once after the flight."""
    running = viewer.running
    monkeypatch.setattr(viewer, "running", lambda *options: running("--headless", *options))
    monkeypatch.setattr(viewer.Program, "wait", lambda program: None)
    monkeypatch.setattr(live, "sleep", lambda seconds: None)
    loaded = edl6dof.load("tianwen1", SHORT)
    try:
        flight = live.fly_live(loaded, pace=10.0)
    except viewer.NoViewer as error:
        pytest.skip(str(error))
    assert flight.telemetry["t_s"][-1] == pytest.approx(20.0)
    assert flight.figures == edl6dof.fly(loaded).figures


def test_a_flight_goes_on_when_its_window_is_closed(monkeypatch):
    shown = []

    @contextmanager
    def closing(simulation):
        def show():
            shown.append(simulation.time_s)
            if len(shown) > 1:
                raise viewer.ViewerFailed("closed")

        yield show

    monkeypatch.setattr(live, "live", closing)
    monkeypatch.setattr(live, "sleep", lambda seconds: None)
    flight = live.fly_live(edl6dof.load("tianwen1", SHORT), pace=10.0)
    assert len(shown) == 2 and flight.telemetry["t_s"][-1] == pytest.approx(20.0)


@pytest.fixture
def streams_to_files(monkeypatch, tmp_path):
    """A viewer that keeps each recording in a file; returns the list of their paths."""
    files = []

    @contextmanager
    def running(*_):
        yield SimpleNamespace(wait_for=lambda port: None, asked=nullcontext, wait=lambda: None)

    def connect(stream, _, default_blueprint):
        files.append(tmp_path / f"{len(files)}.rrd")
        stream.save(str(files[-1]), default_blueprint=default_blueprint)

    monkeypatch.setattr(viewer, "running", running)
    monkeypatch.setattr(rr.RecordingStream, "connect_grpc", connect)
    return files


def times(path):
    """Times (s) at which a recording has a pose of the vehicle."""
    chunks = RrdReader(path).stream().filter(content=["/site/vehicle"], is_static=False).to_chunks()
    found = [chunk.to_record_batch().column("time").to_numpy(zero_copy_only=False) for chunk in chunks]
    return np.concatenate(found).astype("timedelta64[ns]") / np.timedelta64(1, "s")


def test_a_reset_begins_another_recording(streams_to_files):
    simulation = edl6dof.Simulation("tianwen1", SHORT)
    with live.live(simulation, wait=False) as show:
        for cycles in (200, 150):
            simulation.step(cycles=cycles)
            show()
            simulation.reset()
    assert [float(times(path)[-1]) for path in streams_to_files] == pytest.approx([4.0, 3.0], abs=0.05)


def test_episodes_of_an_environment_are_shown_while_they_are_stepped(streams_to_files):
    gym = pytest.importorskip("edl6dof.gym")
    env = gym.FlightEnv("EntryBank", pool=1, render_mode="human")
    begun = []
    for _ in range(2):
        env.reset(seed=0)
        begun.append(env._watched.flight.time_s)
        for _ in range(3):
            env.step(np.array([0.4], np.float32))
        fleet, running = env.unwrapped.task.fleet, env._watched.flight.running
        assert running.plant.tobytes() == fleet.plants.tobytes()
        assert running.fsw.tobytes() == fleet.memories.tobytes()
    assert env.render() is None
    copied = copy.deepcopy(env)
    env.close()
    assert copied._watched is None and env._watched is None
    assert len(streams_to_files) == 2
    for path, start in zip(streams_to_files, begun, strict=True):
        assert times(path)[[0, -1]] == pytest.approx([start, start + 3.0], abs=0.1)
