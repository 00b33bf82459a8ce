"""Films of a recording: pictures of the viewer without a window at even times, joined by ffmpeg."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryFile
from typing import IO, NamedTuple

import numpy as np

from edl6dof.replay.viewer import drawing

#: Width and height of a film in pixels; how long (s) one is at most that was not given a length.
SIZE, LENGTH_S = (1280, 720), 60.0


class NoFilm(RuntimeError):
    """There is no encoder, or it ended with an error; the text says which."""


class Cut(NamedTuple):
    """First and last time of the flight (s), length of the film (s), and frames per second."""

    first_s: float
    last_s: float
    length_s: float
    fps: float

    @property
    def times(self) -> np.ndarray:
        """Time of the flight (s) at each frame, evenly spaced."""
        return np.linspace(self.first_s, self.last_s, max(2, round(self.length_s * self.fps)))


def encoder() -> str:
    """Return the ffmpeg program: that of the machine, or of the package imageio-ffmpeg.

    Raises:
        NoFilm: there is neither.
    """
    found = shutil.which("ffmpeg")
    if found is None and find_spec("imageio_ffmpeg") is not None:
        try:
            found = str(import_module("imageio_ffmpeg").get_ffmpeg_exe())
        except RuntimeError:  # the package came without a program for this machine
            found = None
    if found is None:
        raise NoFilm(
            "a film needs ffmpeg, which is not on this machine: install it (Debian: apt-get install ffmpeg), "
            "or the extra of this package that brings one (pip install 'edl6dof[video]')"
        )
    return found


def film(recording: Path, target: Path, cut: Cut, progress: Callable[[int, int], None]) -> None:
    """Write a film (MP4) of the recording; ``progress`` is called after each frame with the counts done and
    in all.

    Raises:
        NoFilm: there is no encoder, or it ended with an error.
        ViewerFailed: the viewer lacks something, or ended with an error.
    """
    times, program = cut.times, encoder()
    with drawing(recording, float(times[0]), SIZE) as draw, _encoding(program, target, cut.fps) as frames:
        for k, t in enumerate(times):
            frames.write(draw(float(t)))
            progress(k + 1, len(times))


@contextmanager
def _encoding(program: str, target: Path, fps: float) -> Iterator[IO[bytes]]:
    """Open a stream for the frames (PNG), one after the other; the block's end completes the film."""
    words = [program, "-y", "-loglevel", "error", "-f", "image2pipe", "-framerate", f"{fps:g}", "-c:v", "png"]
    words += ["-i", "-", "-pix_fmt", "yuv420p", "-movflags", "+faststart", "-f", "mp4", str(target.resolve())]
    with TemporaryFile() as log:
        process = subprocess.Popen(
            words, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=log, bufsize=0
        )
        assert process.stdin is not None
        try:
            with process.stdin, suppress(BrokenPipeError):  # it has ended, and says why
                yield process.stdin
            status = process.wait()
        finally:
            process.kill()
            process.wait()
        if status:
            log.seek(0)
            words = log.read().decode(errors="replace").split("\n")
            raise NoFilm(f"ffmpeg ended with status {status}: {' '.join(words).strip()[-200:]}")
