"""Film of a flight (MP4): stage, cast, shots and titles, frame by frame."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np

from edl6dof.replay.film.actors import Cast
from edl6dof.replay.film.encoder import encoder, encoding
from edl6dof.replay.film.pace import Cut, frame_times, moments, reversals
from edl6dof.replay.film.shots import shot_list, views
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
    """Write a film of the flight; ``progress`` is called after each frame with the counts done and in all.

    Raises:
        NoFilm: a library or the encoder is missing, or the encoder ended with an error.
    """
    times = times_of(flight, cut)
    with encoding(encoder(), target, size, cut.fps) as frames:
        for number, frame in enumerate(drawn(flight, times, cut.fps, size)):
            frames.write(frame.tobytes())
            progress(number + 1, len(times))


def times_of(flight: History, cut: Cut) -> np.ndarray:
    """Return the time of the flight (s) at each frame."""
    return frame_times(cut, *moments(flight.events))


def drawn(flight: History, times: np.ndarray, fps: float, size: tuple[int, int]) -> Iterator[np.ndarray]:
    """Draw the frames at these times (s), shape (height, width, 3), uint8."""
    motion = Motion(flight)
    shots = shot_list(motion, flight.when, reversals(flight.events))
    titles, stage = Titles(flight, times, size, fps), Stage(flight, motion, size)
    try:
        cast = Cast(stage, flight, motion)
        for number, view in enumerate(views(motion, shots, times, fps)):
            t = float(times[number])
            if number == 0 or t != times[number - 1]:  # the film ends with a still
                cast.show(t)
                picture = stage.draw(view, float(np.interp(t, flight.t, motion.height)))
            yield titles.write(picture.copy(), number)
    finally:
        stage.close()
