"""The viewer: opens a recording on the desktop, or draws a picture of it without a window.

The text of a failure says what the machine lacks.
"""

from __future__ import annotations

import os
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory, TemporaryFile
from typing import IO

from edl6dof.replay.failures import NoViewer, ViewerFailed
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
#: Width and height of a picture in pixels.
PICTURE = (1920, 1080)


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
    import rerun as rr

    port, window = free_port(), f"{size[0]}x{size[1]}"
    options = ("--headless", "--port", str(port), "--window-size", window, "--hide-welcome-screen")
    with TemporaryDirectory(prefix="edl6dof-") as folder, running(*options) as program:
        shot = Path(folder) / "picture.png"

        def look() -> bytes:
            with program.asked():
                viewer.save_screenshot(str(shot))  # returns when it is painted and saved
            return shot.read_bytes()

        program.wait_for(port)
        with program.asked():
            viewer = rr.experimental.ViewerClient.connect(f"rerun+http://{HOST}:{port}/proxy")
            viewer.open(str(recording.resolve()))
            viewer.set_time(TIMELINE, duration=t, play_state="paused")
        time.sleep(START_S)  # with a software renderer, an incomplete picture costs as much as the loading
        picture.write_bytes(_settled(look))


def _settled(look: Callable[[], bytes]) -> bytes:
    """A picture that is the same twice in a row: before that, views are still loading."""
    before, start = b"", time.monotonic()
    while time.monotonic() - start < MOST_S:
        now = look()
        if now == before:
            return now
        before = now
    raise ViewerFailed("the viewer did not finish drawing")
