"""The viewer: opens a recording on the desktop, or draws pictures of it without a window, which ffmpeg joins
to a film.

The text of a failure says what the machine lacks.
"""

from __future__ import annotations

import os
import shutil
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory, TemporaryFile
from typing import IO, NamedTuple

import numpy as np

from edl6dof.replay.failures import NoFilm, NoViewer, ViewerFailed
from edl6dof.replay.pages import TIMELINE

HOST = "127.0.0.1"
STARTUP_S = 20.0

_NO_GRAPHICS = (
    "it finds no graphics that it can draw with; without a GPU it needs mesa-vulkan-drivers "
    "(Debian: apt-get install mesa-vulkan-drivers)"
)
#: Messages of a viewer that cannot work on this machine, and an explanation of each.
_LACKING = {
    "Failed to get render context": _NO_GRAPHICS,
    "No graphics adapter was found": _NO_GRAPHICS,
    "EventLoopError": (
        "there is no display to open a window on; --web, --html FILE and --screenshot FILE need none"
    ),
    "error while loading shared libraries": "a library of the system is missing",
}

#: Python code that becomes the program after asking Linux to kill it (PR_SET_PDEATHSIG, SIGKILL) when the
#: process that started it ends in any way.
_TIED = (
    "import ctypes, os, sys; ctypes.CDLL(None).prctl(1, 9); os.getppid() == int(sys.argv[1]) and "
    "os.execv(sys.argv[2], sys.argv[2:])"
)
#: Time (s) in which a recording is loaded and the notices of the start fade; and time after which a picture
#: that still changes counts as never finished.
START_S, MOST_S = 2.5, 60.0
#: Width and height of a picture and of a film in pixels.
PICTURE, FILM = (1920, 1080), (1280, 720)
#: Longest film (s) if no length is given.
LENGTH_S = 60.0


class Program:
    """The viewer's program while it runs."""

    def __init__(self, process: subprocess.Popen[bytes], log: IO[bytes]) -> None:
        self._process, self._log = process, log

    def wait(self) -> None:
        """Wait until the viewer ends by itself.

        Raises:
            ViewerFailed: the viewer ended with an error.
        """
        if self._process.wait():
            raise self._why_ended()

    def wait_for(self, port: int) -> None:
        """Wait until the viewer listens on a port.

        Raises:
            ViewerFailed: the viewer ends instead, or never listens.
        """
        end = time.monotonic() + STARTUP_S
        while time.monotonic() < end:
            if self._process.poll() is not None:
                raise self._why_ended()
            with socket.socket() as probe:
                if probe.connect_ex((HOST, port)) == 0:
                    return
            time.sleep(0.1)
        raise ViewerFailed(f"the viewer does not start within {STARTUP_S:g} s")

    @contextmanager
    def asked(self) -> Iterator[None]:
        """Report a failed request by the viewer's own message, if the viewer has ended.

        Raises:
            ViewerFailed: a request failed.
        """
        try:
            yield
        except Exception as error:  # the client raises bare exceptions of its transport
            try:
                self._process.wait(timeout=5.0)
            except subprocess.TimeoutExpired:
                raise ViewerFailed(f"the viewer cannot take a picture: {error}") from None
            raise self._why_ended() from None

    def _why_ended(self) -> ViewerFailed:
        self._log.seek(0)
        said = self._log.read().decode(errors="replace")
        lines = [line.strip() for line in said.splitlines() if line.strip()]
        for line in lines:
            for words, remedy in _LACKING.items():
                if words in line:
                    return NoViewer(f"the viewer does not run on this machine: {remedy} ({_short(line)})")
        errors = [line for line in lines if line.lower().startswith("error") or "panicked at" in line]
        telling = errors[0] if errors else lines[-1] if lines else ""
        return ViewerFailed(f"the viewer ended with status {self._process.returncode}: {_short(telling)}")


@contextmanager
def running(*options: str) -> Iterator[Program]:
    """Run the program with some options, bound to this machine, for as long as the block lasts.

    On Linux it also ends when the thread that started it does.

    Raises:
        NoViewer: the installed rerun has no viewer program.
    """
    command = [str(_path()), "--bind", HOST, *options]
    if sys.platform == "linux":
        command = [sys.executable, "-ISc", _TIED, str(os.getpid()), *command]
    with TemporaryFile() as log:
        quiet = {**os.environ, "NO_COLOR": "1"}
        process = subprocess.Popen(
            command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=log, env=quiet
        )
        try:
            yield Program(process, log)
        finally:
            process.kill()
            process.wait()


def free_port() -> int:
    """Return a port that nothing listens on."""
    with socket.socket() as probe:
        probe.bind((HOST, 0))
        return int(probe.getsockname()[1])


def _path() -> Path:
    """The program of the installed rerun; its wrapper ``python -m rerun`` could outlive this process."""
    found = find_spec("rerun_cli")
    folder = Path(found.origin).parent if found is not None and found.origin is not None else Path()
    names = ("Rerun.app/Contents/MacOS/Rerun", "rerun.exe", "rerun")
    program = next((path for name in names if (path := folder / name).is_file()), None)
    if program is None:
        raise NoViewer("the installed rerun-sdk has no viewer for this machine")
    return program


def _short(line: str) -> str:
    return line if len(line) <= 200 else f"{line[:100]} ... {line[-95:]}"


def show(recording: Path) -> None:
    """Open the recording in the desktop viewer and wait until its window is closed.

    The viewer listens for more recordings on a port of this machine, which cannot be turned off; a free one
    is taken for each.

    Raises:
        NoViewer: there is no display, or no graphics to draw with.
        ViewerFailed: it ended with an error.
    """
    with running("--port", str(free_port()), str(recording)) as program:
        program.wait()


def screenshot(recording: Path, picture: Path, t: float, size: tuple[int, int] = PICTURE) -> None:
    """Write a picture (PNG) of the recording at time ``t`` (s), from the viewer without a window.

    Raises:
        NoViewer: this machine lacks what it needs.
        ViewerFailed: it ended with an error, or never finishes drawing.
    """
    with drawing(recording, t, size) as draw:
        picture.write_bytes(draw(t))


@contextmanager
def drawing(recording: Path, t: float, size: tuple[int, int]) -> Iterator[Callable[[float], bytes]]:
    """Open a viewer without a window and return a function that draws the recording at a time (s) as PNG,
    first at ``t``.

    No picture is drawn while it loads: with a software renderer, an incomplete picture costs as much as the
    loading.

    Raises:
        NoViewer: this machine lacks what it needs.
        ViewerFailed: it ended with an error, or never finishes drawing.
    """
    import rerun as rr

    port, window = free_port(), f"{size[0]}x{size[1]}"
    options = ("--headless", "--port", str(port), "--window-size", window, "--hide-welcome-screen")
    with TemporaryDirectory(prefix="edl6dof-") as folder, running(*options) as program:
        picture = Path(folder) / "picture.png"

        def go_to(at_s: float) -> None:
            with program.asked():
                viewer.set_time(TIMELINE, duration=at_s, play_state="paused")

        def draw(at_s: float) -> bytes:
            go_to(at_s)
            return _settled(look)

        def look() -> bytes:
            with program.asked():
                viewer.save_screenshot(str(picture))  # returns when it is painted and saved
            return picture.read_bytes()

        program.wait_for(port)
        with program.asked():
            viewer = rr.experimental.ViewerClient.connect(f"rerun+http://{HOST}:{port}/proxy")
            viewer.open(str(recording.resolve()))
        go_to(t)
        time.sleep(START_S)
        yield draw


def _settled(look: Callable[[], bytes]) -> bytes:
    """A picture that is the same twice in a row: before that, views are still loading."""
    before, start = b"", time.monotonic()
    while time.monotonic() - start < MOST_S:
        now = look()
        if now == before:
            return now
        before = now
    raise ViewerFailed("the viewer did not finish drawing")


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
        with suppress(RuntimeError):  # the package contains no program for this machine
            found = str(import_module("imageio_ffmpeg").get_ffmpeg_exe())
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
    with drawing(recording, float(times[0]), FILM) as draw, _encoding(program, target, cut.fps) as frames:
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
