"""The viewer: open a recording on the desktop or in the browser, or take its picture without either.

Everything that serves listens on this machine only; rerun's own Python helpers would listen on all interfaces.
"""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from edl6dof.post.replay.layout import TIMELINE

HOST = "127.0.0.1"
#: A picture is finished when two in a row are the same, looked at every half second, at least and at most this often.
LEAST_LOOKS, MOST_LOOKS = 5, 60
STARTUP_S = 20.0


class NoViewer(RuntimeError):
    """The viewer does not run on this machine."""


def open_viewer(recording: Path, web: bool) -> int:
    """Open the desktop viewer, or serve the recording to a browser on this machine until interrupted; returns the exit status."""
    command = [sys.executable, "-m", "rerun", "--bind", HOST, *(["--web-viewer"] if web else []), str(recording)]
    try:
        return subprocess.run(command, check=False).returncode
    except KeyboardInterrupt:
        return 0  # Ctrl-C is how the server is ended


def screenshot(recording: Path, picture: Path, t: float, size: tuple[int, int] = (1920, 1080)) -> None:
    """Picture (PNG) of the recording at time ``t`` (s), from the viewer without a window.

    Raises:
        NoViewer: it does not start here, or never finishes drawing.
    """
    port = free_port()
    with serving("--headless", "--port", str(port), "--window-size", f"{size[0]}x{size[1]}", "--hide-welcome-screen"):
        viewer = _connect(port)
        viewer.open(str(recording.resolve()))
        viewer.set_time(TIMELINE, duration=t, play_state="paused")
        _settle(viewer, picture.resolve())


@contextmanager
def serving(*options: str) -> Iterator[None]:
    """The viewer's program with some options, bound to this machine, for as long as the block lasts."""
    command = [sys.executable, "-m", "rerun", "--bind", HOST, *options]
    program = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)
    try:
        yield
    finally:
        _end(program)


def _end(program: subprocess.Popen[bytes]) -> None:
    """End the program and what it started (rerun is a wrapper around the program proper): asked first, then without asking."""
    with suppress(ProcessLookupError):  # which says that the whole group has gone
        os.killpg(program.pid, signal.SIGTERM)
        for _ in range(50):
            program.poll()
            os.killpg(program.pid, 0)
            time.sleep(0.1)
        os.killpg(program.pid, signal.SIGKILL)
    program.wait(timeout=10.0)


def free_port() -> int:
    """A port that nothing listens on."""
    with socket.socket() as probe:
        probe.bind((HOST, 0))
        return int(probe.getsockname()[1])


def wait_for(port: int) -> None:
    """Wait until something listens on a port of this machine."""
    end = time.monotonic() + STARTUP_S
    while time.monotonic() < end:
        with socket.socket() as probe:
            if probe.connect_ex((HOST, port)) == 0:
                return
        time.sleep(0.1)
    raise NoViewer(
        "the viewer does not start on this machine; without a GPU it needs mesa-vulkan-drivers (apt install mesa-vulkan-drivers)"
    )


def _connect(port: int) -> Any:
    import rerun as rr

    wait_for(port)
    return rr.experimental.ViewerClient.connect(f"rerun+http://{HOST}:{port}/proxy")


def _settle(viewer: Any, picture: Path) -> None:
    """Take pictures until the drawing is finished: views load and notices fade."""
    before = b""
    for look in range(MOST_LOOKS):
        time.sleep(0.5)
        try:
            viewer.save_screenshot(str(picture))
        except Exception as error:  # the client raises bare exceptions of its transport
            raise NoViewer(f"the viewer cannot take a picture: {error}") from None
        now = picture.read_bytes()
        if look >= LEAST_LOOKS and now == before:
            return
        before = now
    raise NoViewer("the viewer did not finish drawing")
