"""The viewer: open a recording on the desktop, or take its picture without a window."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from edl6dof.replay.program import HOST, ViewerFailed, free_port, running
from edl6dof.replay.views.spatial import TIMELINE

#: After so long (s) a recording is loaded and notices of the start have faded; what changes for longer never
#: settles.
START_S, MOST_S = 2.5, 60.0


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
    """What draws the recording at a time (s) as PNG, in a viewer without a window that has had time to load
    it, first at time ``t`` (s).

    It loads while nobody looks: with a software renderer, a picture of what is not yet complete costs as much
    as the loading.

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
    """A picture that is the same twice in a row: until then views load, and show that they do."""
    before, start = b"", time.monotonic()
    while time.monotonic() - start < MOST_S:
        now = look()
        if now == before:
            return now
        before = now
    raise ViewerFailed("the viewer did not finish drawing")
