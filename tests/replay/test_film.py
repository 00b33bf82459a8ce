"""Films: pace, shots, captions and pictures of a flight; what is missing is said before anything is drawn; a
whole file or none.
"""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from made_up import END, SHELL

from edl6dof.api import replays
from edl6dof.api.arguments import naming_options
from edl6dof.cli.group import UNAVAILABLE
from edl6dof.cli.run_outputs import replay
from edl6dof.config.errors import ConfigError
from edl6dof.replay.failures import NoFilm
from edl6dof.replay.film import encoder as encoders
from edl6dof.replay.film import film as films
from edl6dof.replay.film import stage as stages
from edl6dof.replay.film.pace import (
    APART_S,
    LENGTH_S,
    REVERSAL,
    STILL_S,
    Cut,
    frame_times,
    moments,
    reversals,
    shown_events,
)
from edl6dof.replay.film.shots import Shot, shot_list, views
from edl6dof.replay.film.smooth import smooth
from edl6dof.replay.film.titles import COLUMNS, Titles
from edl6dof.replay.history import History
from edl6dof.replay.scene import craft_shapes
from edl6dof.replay.scene.poses import Motion
from edl6dof.spatial import rotations as turns

#: A program that keeps what it reads in the file named last, as ffmpeg does.
KEEPS = "import sys; open(sys.argv[-1], 'wb').write(sys.stdin.buffer.read())"
#: One that writes a part of its file, complains and ends.
FAILS = "import sys; open(sys.argv[-1], 'wb').write(b'part'); sys.exit('Unknown encoder')"


@pytest.fixture(scope="module")
def filmed(made_up_flight) -> History:
    """The made-up flight, as read for a film."""
    return History(made_up_flight, COLUMNS)


@pytest.fixture
def given(filmed, monkeypatch) -> None:
    """Lets the command film the made-up flight, whatever folder is named."""
    pytest.importorskip("pyvista")
    monkeypatch.setattr(replays, "_filmed", lambda *_: filmed)
    monkeypatch.setattr(stages, "_PROBE", "")


@pytest.fixture
def drawn(given, monkeypatch) -> list[float]:
    """Times of the frames that were drawn, by a stage that draws one pixel."""
    times: list[float] = []

    def pixels(_: History, at: np.ndarray, *__: object) -> Iterator[Callable[[], np.ndarray]]:
        for t in at:
            times.append(float(t))
            yield lambda: np.full((1, 1, 3), 7, np.uint8)

    monkeypatch.setattr(films, "drawn", pixels)
    return times


@pytest.fixture
def encoder(tmp_path, monkeypatch) -> Callable[[str], None]:
    """Puts a Python program in the place of ffmpeg."""

    def put(text: str) -> None:
        folder = tmp_path / "bin"
        folder.mkdir()
        program = folder / "ffmpeg"
        program.write_text(f"#!{sys.executable}\n{text}\n", encoding="utf-8")
        program.chmod(0o755)
        monkeypatch.setenv("PATH", str(folder))

    return put


def run_replay(run: Path, video: Path | None, *asked: float | None, **more: object) -> int:
    """Status of the command, whose film has these first and last times, length and frames per second."""
    with naming_options():
        named = dict(zip(("start", "end", "length", "fps"), asked, strict=False))
        return replay([run], video=video, **named, **more)


def test_a_given_length_is_filmed_at_even_times_from_first_to_last(tmp_path, drawn, encoder):
    encoder(KEEPS)
    target = tmp_path / "flight.mp4"
    assert run_replay(tmp_path / "bin/ffmpeg", target, 4.0, 10.0, 1.5, 10.0) == 0
    assert np.allclose(drawn, np.linspace(4.0, 10.0, 15))
    assert target.read_bytes() == 15 * bytes([7, 7, 7])


def test_a_short_flight_is_filmed_in_real_time_and_its_end_stays(tmp_path, drawn, encoder):
    encoder(KEEPS)
    assert run_replay(tmp_path / "bin/ffmpeg", tmp_path / "flight.mp4") == 0
    assert len(drawn) == round(30.0 * (END + STILL_S))
    assert np.allclose(drawn[: round(30.0 * END)], np.linspace(0.0, END, round(30.0 * END)))
    assert set(drawn[-round(30.0 * STILL_S) :]) == {drawn[-1]}


@pytest.mark.parametrize(
    ("last_s", "moments"),
    [
        (540.0, [120.0, 280.0, 281.0, 310.0, 446.0]),
        (9000.0, [4.2, 8990.0]),
        (600.0, list(range(10, 590, 25))),
    ],
)
def test_a_long_flight_takes_a_minute_and_is_slow_around_its_events(last_s, moments):
    fps = 30.0
    times = frame_times(Cut(3.0, last_s, None, fps), moments)
    assert len(times) == pytest.approx(LENGTH_S * fps, abs=2)
    assert (times[0], times[-1]) == (3.0, last_s)
    pace = np.diff(times[: -round(STILL_S * fps)]) * fps
    assert np.all(pace > 0.0)
    near = np.abs(times[: len(pace), None] - moments).min(axis=1) < 0.5
    assert pace[near].max() < 0.4 * pace.max()
    if len(moments) < 10:
        assert pace[near].max() < 1.1


def test_each_event_has_its_caption_when_it_happens(filmed):
    times = films.times_of(filmed, Cut(0.0, END, None, 30.0))
    titles = Titles(filmed, times, (320, 180), 30.0)
    shown = shown_events(filmed.events)
    assert {one["key"] for one in shown} >= {"diagnosis"}
    assert [words for _, words, _ in titles.captions] == [_capitalised(one["name"]) for one in shown]
    for (frame, *_), event in zip(titles.captions, shown, strict=True):
        assert 0.0 <= times[frame] - event["t_s"] < 1.0 / 30.0 + 1e-3


def _capitalised(words: str) -> str:
    return words[:1].upper() + words[1:]


@pytest.mark.parametrize(("since", "until"), [(SHELL - 1.0, SHELL + 3.0), (END - 2.0, END)])
def test_the_lander_is_large_at_backshell_release_and_touchdown(filmed, since, until):
    motion, height = Motion(filmed), films.SIZE[1]
    times = np.linspace(since, until, 40)
    shots = shot_list(motion, filmed.when, reversals(filmed.events))
    mesh = craft_shapes.lander(motion.vehicle, motion.shape)
    for t, view in zip(times, views(motion, shots, times, 30.0), strict=True):
        row = np.searchsorted(motion.t, t)
        place = motion.nose[row] + turns.rotate(motion.rotation[row], mesh.positions)
        assert np.ptp(_pixels(place, view, height)) >= 60.0


def _pixels(place: np.ndarray, view: object, height: int) -> np.ndarray:
    """Vertical places of points in a picture ``height`` pixels high."""
    ahead = view.aim - view.eye
    ahead /= np.linalg.norm(ahead)
    right = np.cross(ahead, view.up)
    above = np.cross(right / np.linalg.norm(right), ahead)
    seen = place - view.eye
    return 0.5 * height * (seen @ above) / (seen @ ahead) / np.tan(0.5 * np.radians(view.field_deg))


def test_later_bank_reversals_are_seen_from_behind_but_not_one_after_the_other(filmed):
    motion, turned = Motion(filmed), [2.0, 2.0 + 0.5 * APART_S, 4.0 + APART_S]
    events = [{"key": REVERSAL, "t_s": t} for t in turned]
    assert reversals(events) == [turned[0], turned[2]]
    behind = [one.start_s for one in shot_list(motion, {}, [2.0, 4.0]) if one.azimuth_deg > 170.0]
    assert np.allclose(behind, [1.2, 3.2])
    times = frame_times(Cut(0.0, 600.0, None, 30.0), *moments(events))
    steps = np.diff(times) * 30.0
    first, second, third = (float(steps[np.searchsorted(times, t)]) for t in turned)
    assert first < 1.1 < third < 0.5 * second


def test_no_shot_is_a_flash(filmed):
    motion = Motion(filmed)
    fast = np.linspace(0.0, END, 30)
    shots = [
        Shot(0.0, "vehicle", 60.0, 40.0),
        Shot(9.0, "vehicle", 180.0, 40.0),
        Shot(10.0, "vehicle", 0.0, 40.0),
    ]
    ways = [view.eye - view.aim for view in views(motion, shots, fast, 10.0)]
    jumps = np.flatnonzero(np.linalg.norm(np.diff(ways, axis=0), axis=-1) > 1.0)
    assert len(jumps) == 1 and fast[jumps[0] + 1] == pytest.approx(10.0, abs=1.0)


def test_a_film_shows_the_lander_on_the_ground(filmed, tmp_path):
    try:
        stages.require_graphics()
        program = encoders.encoder()
    except NoFilm as missing:
        pytest.skip(str(missing))
    target, size = tmp_path / "flight.mp4", (320, 180)
    films.film(filmed, target, Cut(END - 1.0, END, 1.0, 5.0), lambda *_: None, size)
    words = [program, "-loglevel", "error", "-i", str(target), "-f", "rawvideo", "-pix_fmt", "rgb24", "-"]
    pixels = subprocess.run(words, capture_output=True, check=True).stdout
    frames = np.frombuffer(pixels, np.uint8).reshape(-1, size[1], size[0], 3).astype(float)
    assert len(frames) == 5
    sky, middle = frames[-1, :20].mean(axis=(0, 1)), frames[-1, 70:110, 130:190]
    assert sky.min() > 30.0  # by day
    assert (np.abs(middle - sky).max(axis=-1) > 40.0).mean() > 0.2


@pytest.mark.parametrize("lacking", ["ffmpeg", "pyvista"])
def test_what_is_lacking_is_said_before_anything_is_drawn(
    tmp_path, drawn, encoder, monkeypatch, capsys, lacking
):
    encoder(KEEPS)
    if lacking == "ffmpeg":
        monkeypatch.setenv("PATH", str(tmp_path))
        monkeypatch.setattr(encoders, "find_spec", lambda _: None)
    else:
        monkeypatch.setitem(sys.modules, "pyvista", None)
    assert run_replay(tmp_path / "bin/ffmpeg", tmp_path / "flight.mp4") == UNAVAILABLE
    said = capsys.readouterr().err
    assert lacking in said and "pip install 'edl6dof[video]'" in said and len(said.splitlines()) == 1
    assert drawn == [] and [path.name for path in tmp_path.iterdir()] == ["bin"]


def test_a_machine_without_graphics_is_said_to_have_none(tmp_path, drawn, encoder, monkeypatch, capsys):
    """VTK ends the process that tries to draw there."""
    encoder(KEEPS)
    monkeypatch.setattr(stages, "_PROBE", "import os; os.abort()")
    assert run_replay(tmp_path / "bin/ffmpeg", tmp_path / "flight.mp4") == UNAVAILABLE
    said = capsys.readouterr().err
    assert "this machine has none that VTK can draw with" in said and len(said.splitlines()) == 1
    assert drawn == [] and [path.name for path in tmp_path.iterdir()] == ["bin"]


def test_an_encoder_that_fails_says_why_and_leaves_nothing(tmp_path, drawn, encoder, capsys):
    encoder(FAILS)
    assert run_replay(tmp_path / "bin/ffmpeg", tmp_path / "flight.mp4") == UNAVAILABLE
    assert "ffmpeg ended with status 1: Unknown encoder" in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["bin"]


def test_an_interrupted_film_leaves_the_one_that_was_there(tmp_path, given, monkeypatch, encoder):
    encoder(KEEPS)

    def interrupted(*_: object) -> Iterator[Callable[[], np.ndarray]]:
        yield lambda: np.zeros((1, 1, 3), np.uint8)
        raise KeyboardInterrupt

    monkeypatch.setattr(films, "drawn", interrupted)
    run, target = tmp_path / "bin/ffmpeg", tmp_path / "flight.mp4"
    target.write_bytes(b"mine")
    with pytest.raises(ConfigError, match="exists"):
        run_replay(run, target)
    with pytest.raises(KeyboardInterrupt):
        run_replay(run, target, force=True)
    assert target.read_bytes() == b"mine"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["bin", "flight.mp4"]


@pytest.mark.parametrize(
    ("asked", "words"),
    [
        ((99.0,), "--from: 99 s is not in"),
        ((None, 99.0), "--to: 99 s is not in"),
        ((9.0, 4.0), "--to: 4 s is"),
    ],
)
def test_times_that_make_no_film_are_refused(tmp_path, drawn, encoder, asked, words):
    encoder(KEEPS)
    with pytest.raises(ConfigError, match=words):
        run_replay(tmp_path / "bin/ffmpeg", tmp_path / "flight.mp4", *asked)
    assert drawn == []


def test_what_cannot_be_filmed_is_refused(recording, tmp_path):
    pytest.importorskip("pyvista")
    with pytest.raises(ConfigError, match=r"flight\.mkv: .*\.mp4"):
        run_replay(recording, tmp_path / "flight.mkv")
    with pytest.raises(ConfigError, match="--video FILE"):
        run_replay(recording, None, 3.0)
    with pytest.raises(ConfigError, match="--video: shows one flight"):
        run_replay(recording, tmp_path / "flight.mp4")


def test_a_page_is_not_filmed(tmp_path, drawn):
    (tmp_path / "run").mkdir()
    with pytest.raises(ConfigError, match="a film has shots of its own"):
        run_replay(tmp_path / "run", tmp_path / "flight.mp4", page="Tour")
    assert drawn == []


@pytest.mark.parametrize("degrees", [3.0, 20.0, 70.0, 87.0])
def test_edges_are_smooth_and_the_rest_is_left_as_it_is(degrees):
    """Compared with the share of each pixel that a half plane covers."""
    fine, size = 8, 48
    row, column = np.indices((fine * size, fine * size)) / fine - 0.5 * size
    turn = np.radians(degrees)
    inside = row * np.cos(turn) < column * np.sin(turn)
    truth = 40.0 + 160.0 * inside.reshape(size, fine, size, fine).mean(axis=(1, 3))
    stepped = 40 + 160 * inside[fine // 2 :: fine, fine // 2 :: fine].astype(np.uint8)
    picture = np.repeat(stepped[..., None], 3, axis=-1)
    smooth(picture)
    off = np.abs(picture[..., 0] - truth)[4:-4, 4:-4]
    assert off.sum() < 0.6 * np.abs(stepped - truth)[4:-4, 4:-4].sum()
    level = (truth <= 40.0) | (truth >= 200.0)
    far = np.array([level[max(k - 1, 0) : k + 2].all(axis=0) for k in range(size)])
    far &= np.roll(far, 1, axis=1) & np.roll(far, -1, axis=1)
    assert np.array_equal(picture[far], np.repeat(stepped[far][:, None], 3, axis=-1))
