"""Titles of a film: head-up line, captions of events, title and credits, drawn on the frames."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from textwrap import wrap
from typing import Any

import numpy as np

from edl6dof import __version__
from edl6dof.replay.film.pace import shown_events
from edl6dof.replay.history import History

#: Time (s of the film) for which a caption and the title are shown, in which they come and go, and of the
#: credits at the end.
CAPTION_S, TITLE_S, _FADE_S, CREDITS_S = 3.0, 4.5, 0.35, 4.0
#: Columns that the head-up line shows.
COLUMNS = ("truth.speed_m_s", "truth.load_g0", "truth.mach")
#: Most captions at a time.
_MOST = 3
#: Places of the figures of the head-up line, as shares of the width of the frame.
_PLACES = (0.045, 0.175, 0.305, 0.435, 0.545, 0.9)
_WHITE, _PALE, _ACCENT = (255, 255, 255), (226, 220, 212), (255, 176, 92)


class Titles:
    """Writes on the frames of a film at ``times`` (s of the flight)."""

    def __init__(self, flight: History, times: np.ndarray, size: tuple[int, int], fps: float) -> None:
        self.flight, self.times, self.size, self.fps = flight, times, size, fps
        self._unit = size[1] / 1080.0
        self.captions = [
            (int(np.searchsorted(times, one["t_s"])), *_caption(one))
            for one in shown_events(flight.events)
            if times[0] <= one["t_s"] <= times[-1]
        ]
        pace = np.gradient(times) * fps
        self._pace = np.convolve(np.pad(pace, 4, mode="edge"), np.full(9, 1.0 / 9.0), mode="valid")
        rise = np.clip(np.linspace(0.0, 1.0, round(0.17 * size[1])), 0.0, 1.0)[:, None, None]
        self._dark = (256.0 * (1.0 - 0.62 * rise**1.3)).astype(np.uint16)
        self._names = [name.replace("_", " ") for name in flight.phase_names] or ["free flight"]

    def write(self, frame: np.ndarray, number: int) -> np.ndarray:
        """Return the frame with its titles; ``number``: its number, from 0."""
        from PIL import Image, ImageDraw

        frame = np.ascontiguousarray(frame)
        band = frame[-len(self._dark) :]
        band[:] = (band * self._dark >> 8).astype(np.uint8)
        film_s, left_s = number / self.fps, (len(self.times) - 1 - number) / self.fps
        credits = np.clip((CREDITS_S - left_s) / 0.8, 0.0, 1.0) if len(self.times) > 12 * self.fps else 0.0
        if credits > 0.0:
            frame = (frame * (1.0 - 0.4 * credits)).astype(np.uint8)
        self._image = Image.fromarray(frame)
        self._draw = ImageDraw.Draw(self._image, "RGBA")
        if credits < 1.0:
            self._figures(number, 1.0 - credits)
            self._captions(number, 1.0 - credits)
        if film_s < TITLE_S and len(self.times) > 12 * self.fps:
            self._title(min(1.0, film_s / 0.8, (TITLE_S - film_s) / 0.8))
        if credits > 0.0:
            self._credits(float(credits))
        return np.asarray(self._image)

    def _text(
        self, place: tuple[float, float], words: str, size: float, look: str, colour: Any, shown: float
    ) -> None:
        """Write words, their baseline at a place (shares of the frame); ``size``: pixels of 1080."""
        if shown <= 0.0 or not words:
            return
        off = max(1, round(1.6 * self._unit))
        for shift, tint, share in ((off, (0, 0, 0), 0.55 * shown), (0, colour, shown)):
            mask, left, top = _written(words, look, max(round(size * self._unit), 6), round(255.0 * share))
            x, y = round(place[0] * self.size[0]) + left, round(place[1] * self.size[1]) + top
            self._image.paste(tint, (x + shift, y + shift), mask)

    def _figures(self, number: int, shown: float) -> None:
        """Write time, height, speed, load, phase and pace."""
        t, flight = float(self.times[number]), self.flight
        row = int(np.clip(np.searchsorted(flight.t, t, side="right") - 1, 0, len(flight.t) - 1))
        height, speed, load = (
            float(np.interp(t, flight.t, flight[name]))
            for name in ("truth.height_m", "truth.speed_m_s", "truth.load_g0")
        )
        phase = flight["guide.phase"][row]
        name = self._names[int(np.clip(np.nan_to_num(phase), 0, len(self._names) - 1))]
        figures = [
            ("TIME", clock(t)),
            ("HEIGHT", length(height)),
            ("SPEED", f"{speed:,.0f} m/s" if speed >= 10.0 else f"{speed:.1f} m/s"),
            ("LOAD", f"{load:.1f} g"),
            ("PHASE", name),
            ("PACE", factor(self._pace[number])),
        ]
        for x, (label, value) in zip(_PLACES, figures, strict=True):
            self._text((x, 0.922), label, 19, "DejaVuSans-Bold", _ACCENT, 0.95 * shown)
            self._text((x, 0.961), value, 33, "DejaVuSans", _WHITE, shown)

    def _captions(self, number: int, shown: float) -> None:
        """Write the captions of the events that have just happened, the latest at the bottom."""
        recent = [one for one in self.captions if 0 <= number - one[0] < CAPTION_S * self.fps][-_MOST:]
        for place, (first, words, detail) in enumerate(reversed(recent)):
            age = (number - first) / self.fps
            there = shown * float(np.clip(min(age + 0.12, CAPTION_S - age) / _FADE_S, 0.0, 1.0))
            y = 0.845 - 0.092 * place
            x, top, line = 0.045 * self.size[0], (y - 0.036) * self.size[1], 4.0 * self._unit
            box = (x, top, x + line, top + 0.066 * self.size[1])
            self._draw.rectangle(box, fill=(*_ACCENT, int(235 * there)))
            self._text((0.053, y), words, 38, "DejaVuSans-Bold", _WHITE, there)
            self._text((0.053, y + 0.031), detail, 25, "DejaVuSans", _PALE, there)

    def _title(self, shown: float) -> None:
        """Write description and name of the scenario."""
        scenario = self.flight.scenario
        words = scenario.description or scenario.name.replace("_", " ")
        head = [(line, 54, "DejaVuSans-Bold", _WHITE) for line in wrap(words[:1].upper() + words[1:], 48)]
        self._block(head, [f"Scenario {scenario.name}, simulated in six degrees of freedom"], shown)

    def _credits(self, shown: float) -> None:
        """Write outcome, scenario and program."""
        flight = self.flight
        outcome = flight.outcome[:1].upper() + flight.outcome[1:]
        head = [(words, 54, "DejaVuSans-Bold", _WHITE) for words in wrap(outcome, 48)]
        about = [
            f"Scenario {flight.scenario.name}, seed {flight.scenario.seed}",
            f"Simulated and drawn by edl6dof {__version__}",
            "Flames, dust, sky and the finest relief of the ground are decoration",
        ]
        self._block(head, about, shown)

    def _block(self, head: list[tuple[str, int, str, Any]], about: list[str], shown: float) -> None:
        """Write lines below each other at the top left: a heading, and smaller lines about it."""
        y = 0.075
        for words, size, look, colour in [*head, *((line, 30, "DejaVuSans", _PALE) for line in about)]:
            y += 1.45 * size / 1080.0
            self._text((0.06, y), words, size, look, colour, shown)


@lru_cache(maxsize=256)
def _written(words: str, look: str, size: int, opacity: int) -> tuple[Any, int, int]:
    """Picture of words, 0 to ``opacity``, and its left and top edge from the start of the baseline."""
    from PIL import Image, ImageDraw

    font = _font(look, size)
    left, top, right, bottom = (int(edge) for edge in font.getbbox(words, anchor="ls"))
    mask = Image.new("L", (right - left + 1, bottom - top + 1))
    ImageDraw.Draw(mask).text((-left, -top), words, font=font, anchor="ls", fill=opacity)
    return mask, left, top


@lru_cache
def _font(look: str, size: int) -> Any:
    """Font of this look, ``size`` pixels high."""
    import matplotlib
    from PIL import ImageFont

    return ImageFont.truetype(str(Path(matplotlib.get_data_path()) / "fonts/ttf" / f"{look}.ttf"), size)


def _caption(event: Mapping[str, Any]) -> tuple[str, str]:
    """Words of an event and of the state at its time."""
    words = event.get("role") or event["name"]
    words = words.replace("_", " ")
    return words[:1].upper() + words[1:], str(event.get("detail", ""))


def clock(t: float) -> str:
    """Return a time (s) as minutes and seconds, or hours, minutes and seconds."""
    minutes, seconds = divmod(abs(t), 60.0)
    sign = "-" if t < 0.0 else ""
    if minutes >= 60.0:
        return f"{sign}{int(minutes // 60)}:{int(minutes % 60):02d}:{int(seconds):02d}"
    return f"{sign}{int(minutes)}:{int(10.0 * seconds) / 10.0:04.1f}"


def length(height_m: float) -> str:
    """Return a height with about three digits."""
    if height_m >= 9_950.0:
        return f"{height_m / 1e3:.1f} km"
    if height_m >= 1_000.0:
        return f"{height_m / 1e3:.2f} km"
    return f"{height_m:.0f} m" if height_m >= 100.0 else f"{max(height_m, 0.0):.1f} m"


def factor(pace: float) -> str:
    """Return the pace of the film relative to the flight; nothing for a still picture."""
    if pace < 0.5:
        return ""
    return f"x{pace:.1f}" if pace < 9.95 else f"x{pace:.0f}"
