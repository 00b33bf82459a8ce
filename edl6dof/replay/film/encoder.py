"""The encoder of films: ffmpeg, of the machine or of the package imageio-ffmpeg."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryFile
from typing import IO

from edl6dof.replay.failures import NoFilm


def encoder() -> str:
    """Return the ffmpeg program.

    Raises:
        NoFilm: there is none.
    """
    found = shutil.which("ffmpeg")
    if found is None and find_spec("imageio_ffmpeg") is not None:
        with suppress(RuntimeError):  # the package contains no program for this machine
            found = str(import_module("imageio_ffmpeg").get_ffmpeg_exe())
    if found is None:
        raise NoFilm(
            "a film needs ffmpeg, which is not on this machine: install it (Debian: apt-get install ffmpeg), "
            "or the extra of this package that brings one (pip install 'edl6dof[video]')"
        )
    return found


@contextmanager
def encoding(program: str, target: Path, size: tuple[int, int], fps: float) -> Iterator[IO[bytes]]:
    """Open a stream for the frames, one after the other, each of ``size`` (width, height) RGB pixels from the
    top left; the block's end completes the film.

    Raises:
        NoFilm: ffmpeg ended with an error.
    """
    words = [program, "-y", "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgb24"]
    words += ["-s", f"{size[0]}x{size[1]}", "-framerate", f"{fps:g}", "-i", "-"]
    words += ["-pix_fmt", "yuv420p", "-preset", "veryfast", "-crf", "18"]
    words += ["-movflags", "+faststart", "-f", "mp4", str(target.resolve())]
    with TemporaryFile() as log:
        process = subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=log)
        assert process.stdin is not None
        try:
            with suppress(BrokenPipeError), process.stdin:  # it has ended, and says why
                yield process.stdin
            status = process.wait()
        finally:
            process.kill()
            process.wait()
        if status:
            log.seek(0)
            words = log.read().decode(errors="replace").split("\n")
            raise NoFilm(f"ffmpeg ended with status {status}: {' '.join(words).strip()[-200:]}")
