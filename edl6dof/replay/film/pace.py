"""Pace of a film: the time of the flight at each frame.

A film of a given length has constant pace.  Otherwise, the flight is in real time around its events and
faster between them, such that the film lasts about a minute.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any, NamedTuple

import numpy as np

from edl6dof.interface import roles

#: Length (s) of a film if none is given, with the still picture of its end; and duration (s) of that picture.
LENGTH_S, STILL_S = 60.0, 4.0
#: Key of a bank reversal, and least time (s) of the flight between two that have shots of their own: at least
#: three seconds of a film of a minute, whose pace is slow around them.
REVERSAL, APART_S = "bank_reversal", 25.0
#: Keys of events without a milestone that a film shows, and roles whose beginning it shows.
SHOWN = ("line_stretch", REVERSAL, "image", "scan", "spot", "diagnosis", "touchdown")
SHOWN_ROLES = (roles.HOVER_IMAGING, roles.HAZARD_AVOIDANCE)
#: Time (s) before and after an event in real time, and time (s) in which the pace changes.
_BEFORE_S, _AFTER_S, _CHANGE_S = 0.8, 2.6, 4.0
#: Time (s) before touchdown that is slow, too.
_LANDING_S = 4.0
#: Logarithm of the pace around slow events, relative to that far from events.
_SLOW = 0.3
#: Largest share of a film in real time; with more events, these are faster, too.
_EVENTFUL = 0.7
#: Number of steps of the map from film time to flight time.
_STEPS = 20_000


class Cut(NamedTuple):
    """First and last time of the flight (s), length of the film (s; ``None``: about a minute, at a pace that
    follows the events), and frames per second.
    """

    first_s: float
    last_s: float
    length_s: float | None
    fps: float


def shown_events(events: Iterable[Mapping[str, Any]]) -> list[Mapping[str, Any]]:
    """Return the events that a film announces."""
    return [
        one for one in events if one.get("milestone") or one["key"] in SHOWN or one.get("role") in SHOWN_ROLES
    ]


def moments(events: Iterable[Mapping[str, Any]]) -> tuple[list[float], list[float]]:
    """Return the times (s) around which a film is in real time: the first event of each kind, and the last
    seconds before touchdown; and those around which it is slow: later bank reversals that have shots.
    """
    first = {one["key"]: one["t_s"] for one in reversed(shown_events(events))}
    if "touchdown" in first:
        first["landing"] = first["touchdown"] - _LANDING_S
    return sorted(first.values()), reversals(events)[1:]


def reversals(events: Iterable[Mapping[str, Any]]) -> list[float]:
    """Return the times (s) of the bank reversals that have shots: the first, and each that begins at least
    ``APART_S`` after the last of them.
    """
    found: list[float] = []
    for one in events:
        if one["key"] == REVERSAL and (not found or one["t_s"] - found[-1] >= APART_S):
            found.append(one["t_s"])
    return found


def frame_times(cut: Cut, moments: Iterable[float], slow: Iterable[float] = ()) -> np.ndarray:
    """Return the time of the flight (s) at each frame, from the first to the last time of the cut;
    ``moments`` and ``slow``: times (s) of events in real time and of those that are only slow.
    """
    span = cut.last_s - cut.first_s
    if cut.length_s is not None or span <= LENGTH_S:
        moving = span if cut.length_s is None else cut.length_s
        times = np.linspace(cut.first_s, cut.last_s, _frames(moving, cut.fps))
    else:
        flight_s, film_s = _paced(cut, [*moments, cut.last_s], [*slow], LENGTH_S - STILL_S)
        times = np.interp(np.linspace(0.0, film_s[-1], _frames(film_s[-1], cut.fps)), film_s, flight_s)
        times[[0, -1]] = cut.first_s, cut.last_s
    still = 0 if cut.length_s is not None else round(STILL_S * cut.fps)
    return np.append(times, np.full(still, cut.last_s))


def _frames(length_s: float, fps: float) -> int:
    return max(2, round(length_s * fps))


def _paced(
    cut: Cut, moments: list[float], slow: list[float], length_s: float
) -> tuple[np.ndarray, np.ndarray]:
    """Times of the flight and of the film (s) that belong to each other."""
    t = np.unique(np.append(np.linspace(cut.first_s, cut.last_s, _STEPS), _near(cut, [*moments, *slow])))
    calm = np.minimum(_calm(t, moments), np.maximum(_calm(t, slow), _SLOW))
    calm, step = 0.5 * (calm[1:] + calm[:-1]), np.diff(t)
    eventful = calm < 1.0

    def film_s(factor: float, where: np.ndarray | slice = slice(None)) -> float:
        return float((step / factor**calm)[where].sum())

    # real time around the events, if that leaves enough of the film to the rest
    factor = _solved(lambda factor: film_s(factor) - length_s)
    slowest = film_s(factor, eventful) / (_EVENTFUL * length_s)
    if slowest > 1.0:
        share = _EVENTFUL / (1.0 - _EVENTFUL)
        factor = _solved(lambda factor: share * film_s(factor, ~eventful) - film_s(factor, eventful))
    film_t = np.append(0.0, np.cumsum(step / factor**calm))
    return t, film_t * length_s / film_t[-1]


def _solved(excess: Callable[[float], float]) -> float:
    """Factor at which a falling function of it is zero."""
    low, high = 1.0, 1e6
    for _ in range(60):
        factor = float(np.sqrt(low * high))
        low, high = (factor, high) if excess(factor) > 0.0 else (low, factor)
    return high


def _calm(t: np.ndarray, moments: list[float]) -> np.ndarray:
    """Share of the way from the time of events, 0, to that without events, 1."""
    away = np.full(len(t), np.inf)
    for moment in moments:
        away = np.minimum(away, np.maximum(moment - _BEFORE_S - t, t - moment - _AFTER_S))
    return np.clip(away / _CHANGE_S, 0.0, 1.0)


def _near(cut: Cut, moments: list[float]) -> np.ndarray:
    """Closely spaced times (s) around events, which the steps of a flight of hours would miss."""
    around = np.arange(-_BEFORE_S - _CHANGE_S, _AFTER_S + _CHANGE_S, 0.1)
    near = (np.array(moments)[:, None] + around).ravel()
    return near[(near > cut.first_s) & (near < cut.last_s)]
