"""The viewer: open a recording on the desktop, or take its picture without a window."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

from edl6dof.replay.program import HOST, ViewerFailed, free_port, running
from edl6dof.replay.views.spatial import TIMELINE

#: A picture is finished when two in a row are the same, looked at every half second, at least and at most
#: this often.
LEAST_LOOKS, MOST_LOOKS = 5, 60


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


def screenshot(recording: Path, picture: Path, t: float, size: tuple[int, int] = (1920, 1080)) -> None:
    """Picture (PNG) of the recording at time ``t`` (s), from the viewer without a window.

    Raises:
        NoViewer: this machine lacks what it needs.
        ViewerFailed: it ended with an error, or never finishes drawing.
    """
    import rerun as rr

    port = free_port()
    with running(
        "--headless", "--port", str(port), "--window-size", f"{size[0]}x{size[1]}", "--hide-welcome-screen"
    ) as program:
        program.wait_for(port)
        try:
            viewer = rr.experimental.ViewerClient.connect(f"rerun+http://{HOST}:{port}/proxy")
            viewer.open(str(recording.resolve()))
            viewer.set_time(TIMELINE, duration=t, play_state="paused")
            _settle(viewer, picture.resolve())
        except ViewerFailed:
            raise
        except Exception as error:  # the client raises bare exceptions of its transport
            raise program.failure(error) from None


def _settle(viewer: Any, picture: Path) -> None:
    """Take pictures until the drawing is finished: views load and notices fade."""
    before = b""
    for look in range(MOST_LOOKS):
        time.sleep(0.5)
        viewer.save_screenshot(str(picture))
        now = picture.read_bytes()
        if look >= LEAST_LOOKS and now == before:
            return
        before = now
    raise ViewerFailed("the viewer did not finish drawing")
