"""Film of a flight (MP4): stage, cast, shots and titles, frame by frame."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from functools import partial
from pathlib import Path

import numpy as np

from edl6dof.replay.film.actors import Cast
from edl6dof.replay.film.encoder import encoder, encoding
from edl6dof.replay.film.pace import Cut, frame_times, moments, reversals
from edl6dof.replay.film.shots import shot_list, views
from edl6dof.replay.film.smooth import smooth
from edl6dof.replay.film.stage import Stage
from edl6dof.replay.film.titles import Titles
from edl6dof.replay.history import History
from edl6dof.replay.scene.poses import Motion

#: Width and height of a film in pixels.
SIZE = (1920, 1080)


def film(
    flight: History,
    target: Path,
    cut: Cut,
    progress: Callable[[int, int], None],
    size: tuple[int, int] = SIZE,
) -> None:
    """Write a film of the flight; ``progress`` is called after each scene with the counts drawn and in all.

    Raises:
        NoFilm: a library or the encoder is missing, or the encoder ended with an error.
    """
    times = times_of(flight, cut)
    with encoding(encoder(), target, size, cut.fps) as frames, ThreadPoolExecutor(1) as writer:

        def write(finished: Callable[[], np.ndarray]) -> None:
            frames.write(finished().tobytes())

        written: Future[None] | None = None
        for number, finished in enumerate(drawn(flight, times, cut.fps, size)):
            if written is not None:
                written.result()
            written = writer.submit(write, finished)
            progress(number + 1, len(times))
        if written is not None:
            written.result()


def times_of(flight: History, cut: Cut) -> np.ndarray:
    """Return the time of the flight (s) at each frame."""
    return frame_times(cut, *moments(flight.events))


def drawn(
    flight: History, times: np.ndarray, fps: float, size: tuple[int, int]
) -> Iterator[Callable[[], np.ndarray]]:
    """Draw the scene at these times (s); yield for each a function that returns the finished frame, shape
    (height, width, 3), uint8.  It may run in another thread while the next scene is drawn.
    """
    motion = Motion(flight)
    shots = shot_list(motion, flight.when, reversals(flight.events))
    titles, stage = Titles(flight, times, size, fps), Stage(flight, motion, size)
    try:
        cast = Cast(stage, flight, motion)
        for number, view in enumerate(views(motion, shots, times, fps)):
            t = float(times[number])
            new = number == 0 or t != times[number - 1]  # the film ends with a still
            if new:
                cast.show(t)
                picture = stage.draw(view, float(np.interp(t, flight.t, motion.height)))
            yield partial(_finished, titles, picture, number, new)
    finally:
        stage.close()


def _finished(titles: Titles, picture: np.ndarray, number: int, new: bool) -> np.ndarray:
    """Return a frame with smooth edges and titles; ``picture``: rows from the bottom, smoothed if ``new``."""
    if new:
        smooth(picture)
    return titles.write(picture[::-1].copy(), number)
