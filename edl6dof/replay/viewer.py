"""The viewer: open a recording on the desktop, or take its picture without a window."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from edl6dof.replay.program import HOST, ViewerFailed, free_port, running
from edl6dof.replay.views.spatial import TIMELINE

#: A picture is finished when two half a second apart are the same, not before notices of the viewer's start
#: have faded (s), nor later than (s).
PAUSE_S, LEAST_S, MOST_S = 0.5, 2.5, 60.0


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
    with drawing(recording, t, size) as draw:
        picture.write_bytes(draw(t))


@contextmanager
def drawing(
    recording: Path, t: float, size: tuple[int, int] = (1920, 1080)
) -> Iterator[Callable[[float], bytes]]:
    """What draws the recording at a time (s) as PNG, in a viewer without a window that has finished drawing
    it at time ``t`` (s).

    Raises:
        NoViewer: this machine lacks what it needs.
        ViewerFailed: it ended with an error, or never finishes drawing.
    """
    import rerun as rr

    port = free_port()
    with (
        TemporaryDirectory(prefix="edl6dof-") as folder,
        running(
            "--headless",
            "--port",
            str(port),
            "--window-size",
            f"{size[0]}x{size[1]}",
            "--hide-welcome-screen",
        ) as program,
    ):
        picture = Path(folder) / "picture.png"

        def draw(at_s: float) -> bytes:
            with program.asked():
                viewer.set_time(TIMELINE, duration=at_s, play_state="paused")
                viewer.save_screenshot(str(picture))  # returns when it is painted and saved
            return picture.read_bytes()

        program.wait_for(port)
        with program.asked():
            viewer = rr.experimental.ViewerClient.connect(f"rerun+http://{HOST}:{port}/proxy")
            viewer.open(str(recording.resolve()))
        _settle(lambda: draw(t))
        yield draw


def _settle(look: Callable[[], bytes]) -> None:
    """Take pictures until the drawing is finished: views load and notices fade."""
    before, start = b"", time.monotonic()
    while (gone := time.monotonic() - start) < MOST_S:
        now = look()
        if gone >= LEAST_S and now == before:
            return
        before = now
        time.sleep(PAUSE_S)
    raise ViewerFailed("the viewer did not finish drawing")
