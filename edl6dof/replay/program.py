"""The viewer's program: run for as long as it is needed, on this machine's own address only, and never longer
than its parent.

Where it cannot do its work, what it said on its way out tells what the machine lacks.
"""

from __future__ import annotations

import os
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryFile
from typing import IO

HOST = "127.0.0.1"
STARTUP_S = 20.0

#: Words of a viewer that cannot work here, and what to do about it.
_LACKING = {
    "Failed to get render context": (
        "it finds no graphics that it can draw with; without a GPU it needs mesa-vulkan-drivers "
        "(Debian: apt-get install mesa-vulkan-drivers)"
    ),
    "EventLoopError": (
        "there is no display to open a window on; --web, --html FILE and --screenshot FILE need none"
    ),
    "error while loading shared libraries": "a library of the system is missing",
}

#: Becomes the program after asking Linux to end it (PR_SET_PDEATHSIG, SIGKILL) with the process that started
#: it, however that ends.
_TIED = (
    "import ctypes, os, sys; ctypes.CDLL(None).prctl(1, 9); os.getppid() == int(sys.argv[1]) and "
    "os.execv(sys.argv[2], sys.argv[2:])"
)


class ViewerFailed(RuntimeError):
    """The viewer ended before its work was done, or does not do it."""


class NoViewer(ViewerFailed):
    """This machine lacks what the viewer needs; the text says what."""


class Program:
    """The viewer's program while it runs."""

    def __init__(self, process: subprocess.Popen[bytes], log: IO[bytes]) -> None:
        self._process, self._log = process, log

    def wait(self) -> None:
        """Wait until it ends by itself.

        Raises:
            ViewerFailed: with an error.
        """
        if self._process.wait():
            raise self._why_ended()

    def wait_for(self, port: int) -> None:
        """Wait until it listens on a port.

        Raises:
            ViewerFailed: it ends instead, or never does.
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
        """While it is asked for something: what fails is said in its own words, if it ended.

        Raises:
            ViewerFailed: it does not do what it is asked for.
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
        said = [
            line.strip() for line in self._log.read().decode(errors="replace").splitlines() if line.strip()
        ]
        for line in said:
            for words, remedy in _LACKING.items():
                if words in line:
                    return NoViewer(f"the viewer does not run on this machine: {remedy} ({_short(line)})")
        telling = next(
            (line for line in said if line.lower().startswith("error") or "panicked at" in line),
            said[-1] if said else "",
        )
        return ViewerFailed(f"the viewer ended with status {self._process.returncode}: {_short(telling)}")


@contextmanager
def running(*options: str) -> Iterator[Program]:
    """The program with some options, bound to this machine, for as long as the block lasts.

    On Linux it also ends when the thread that started it does.

    Raises:
        NoViewer: the installed rerun has none.
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
    """A port that nothing listens on."""
    with socket.socket() as probe:
        probe.bind((HOST, 0))
        return int(probe.getsockname()[1])


def _path() -> Path:
    """Where the installed rerun keeps the program; its own ``python -m rerun`` is a wrapper that could
    outlive us.
    """
    found = find_spec("rerun_cli")
    folder = Path(found.origin).parent if found is not None and found.origin is not None else Path()
    names = ("Rerun.app/Contents/MacOS/Rerun", "rerun.exe", "rerun")
    program = next((path for name in names if (path := folder / name).is_file()), None)
    if program is None:
        raise NoViewer("the installed rerun-sdk has no viewer for this machine")
    return program


def _short(line: str) -> str:
    return line if len(line) <= 200 else f"{line[:100]} ... {line[-95:]}"
