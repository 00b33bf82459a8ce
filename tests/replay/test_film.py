"""Films: what is missing is said before anything is drawn, frames at even times, a whole file or none."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
from made_up import END

from edl6dof.api.arguments import naming_options
from edl6dof.cli.group import UNAVAILABLE
from edl6dof.cli.run_outputs import replay
from edl6dof.config.errors import ConfigError
from edl6dof.replay import viewer
from edl6dof.replay.viewer import Cut, NoFilm, NoViewer

#: A program that keeps what it reads in the file named last, as ffmpeg does.
KEEPS = "import sys; open(sys.argv[-1], 'wb').write(sys.stdin.buffer.read())"
#: One that writes a part of its file, complains and ends.
FAILS = "import sys; open(sys.argv[-1], 'wb').write(b'part'); sys.exit('Unknown encoder')"


@pytest.fixture
def drawn(monkeypatch) -> list[float]:
    """Times of the frames that were drawn, by a viewer that draws the time itself."""
    times: list[float] = []

    @contextmanager
    def drawing(*_: object) -> Iterator[Callable[[float], bytes]]:
        yield lambda t: times.append(t) or f"{t:.3f} ".encode()

    monkeypatch.setattr(viewer, "drawing", drawing)
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


def run_replay(recording: Path, video: Path | None, *asked: float | None, force: bool = False) -> int:
    """Status of the command, whose film has these first and last times, length and frames per second."""
    with naming_options():
        return replay(
            [recording],
            video=video,
            force=force,
            **dict(zip(("start", "end", "length", "fps"), asked, strict=False)),
        )


def test_frames_are_even_in_time_from_first_to_last(recording, tmp_path, drawn, encoder):
    encoder(KEEPS)
    target = tmp_path / "flight.mp4"
    assert run_replay(recording, target, 4.0, 10.0, 1.5, 10.0) == 0
    assert np.allclose(drawn, np.linspace(4.0, 10.0, 15))
    assert target.read_text().split() == [f"{t:.3f}" for t in drawn]


@pytest.mark.parametrize(("asked", "length_s"), [((), END), ((2.0,), END - 2.0), ((None, None, 3.0), 3.0)])
def test_a_film_lasts_as_long_as_the_flight_unless_told(recording, tmp_path, drawn, encoder, asked, length_s):
    encoder(KEEPS)
    assert run_replay(recording, tmp_path / "flight.mp4", *asked) == 0
    assert len(drawn) == round(24.0 * length_s)
    assert drawn[-1] == pytest.approx(END)


def test_without_an_encoder_nothing_is_drawn_and_the_remedy_is_said(
    recording, tmp_path, drawn, monkeypatch, capsys
):
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setattr(viewer, "find_spec", lambda _: None)
    monkeypatch.setattr(viewer, "running", lambda *_: pytest.fail("the viewer was started"))
    assert run_replay(recording, tmp_path / "flight.mp4") == UNAVAILABLE
    said = capsys.readouterr().err
    assert "apt-get install ffmpeg" in said and "edl6dof[video]" in said and len(said.splitlines()) == 1
    assert drawn == [] and list(tmp_path.iterdir()) == []


def test_an_encoder_that_fails_says_why_and_leaves_nothing(recording, tmp_path, drawn, encoder, capsys):
    encoder(FAILS)
    assert run_replay(recording, tmp_path / "flight.mp4") == UNAVAILABLE
    assert "ffmpeg ended with status 1: Unknown encoder" in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["bin"]


def test_an_interrupted_film_leaves_the_one_that_was_there(recording, tmp_path, monkeypatch, encoder):
    encoder(KEEPS)

    @contextmanager
    def drawing(*_: object) -> Iterator[Callable[[float], bytes]]:
        def interrupted(t: float) -> bytes:
            if t > 10.0:
                raise KeyboardInterrupt
            return b"frame"

        yield interrupted

    monkeypatch.setattr(viewer, "drawing", drawing)
    target = tmp_path / "flight.mp4"
    target.write_bytes(b"mine")
    with pytest.raises(ConfigError, match="exists"):
        run_replay(recording, target)
    with pytest.raises(KeyboardInterrupt):
        run_replay(recording, target, force=True)
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
def test_times_that_make_no_film_are_refused(recording, tmp_path, drawn, encoder, asked, words):
    encoder(KEEPS)
    with pytest.raises(ConfigError, match=words):
        run_replay(recording, tmp_path / "flight.mp4", *asked)
    assert drawn == []


def test_another_kind_of_file_is_refused(recording, tmp_path, drawn):
    with pytest.raises(ConfigError, match=r"flight\.mkv: .*\.mp4"):
        run_replay(recording, tmp_path / "flight.mkv")
    assert drawn == []


def test_times_without_a_film_are_refused(recording):
    with pytest.raises(ConfigError, match="--video FILE"):
        run_replay(recording, None, 3.0)


def test_a_real_film_of_five_frames(recording, tmp_path):
    target = tmp_path / "flight.mp4"
    try:
        viewer.film(recording, target, Cut(15.0, 16.0, 0.5, 10.0), lambda *_: None)
    except (NoFilm, NoViewer) as missing:
        pytest.skip(str(missing))
    assert target.read_bytes()[4:8] == b"ftyp"
    assert target.stat().st_size > 10_000
