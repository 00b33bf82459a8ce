"""Placement of labels: at points where they cover no other label and least of the curves; labels of lines
that are too near each other are joined.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Literal, get_args

import numpy as np

from edl6dof.report.figure import Mark, Panel, Trace

Side = Literal["above", "below", "right", "left", "above right", "above left", "below right", "below left"]
Span = tuple[float, float]
#: A box: left, right, lower and upper end, px.
Box = tuple[float, float, float, float]

#: Sides of a point in order of preference among equally good ones.
SIDES: tuple[Side, ...] = get_args(Side)
#: Width of a letter, height of a line, distance from a point to its label, and width of a narrow panel, px.
LETTER, LINE, AWAY, NARROW = 6.2, 14.0, 5.0, 370.0
#: Cost of covering a marker, where covering 3 px of a curve costs 1.
MARKER = 8
#: Cost of covering another label, and of leaving the panel, where covering 3 px of a curve costs 1.
OVER_WORDS, OUTSIDE = 1e4, 1e3


def spelt(marks: Sequence[Mark], axis: Literal["x", "y"], span: Span) -> list[Mark]:
    """Return the marks across one axis in order; marks closer than a line of text share one label."""
    near = LINE / (NARROW if axis == "x" else 150.0) * abs(span[1] - span[0])
    found: list[Mark] = []
    for mark in sorted((mark for mark in marks if mark.axis == axis), key=lambda mark: mark.at):
        labelled = [k for k, other in enumerate(found) if other.label and mark.at - other.at < near]
        if mark.label and labelled:
            first = found[labelled[-1]]
            words = first.label if mark.label in first.label.split(", ") else f"{first.label}, {mark.label}"
            found[labelled[-1]] = replace(first, label=words)
            mark = replace(mark, label="")
        found.append(mark)
    return found


def sides(panel: Panel, spans: tuple[Span, Span], width: float, height: float) -> dict[int, list[Side]]:
    """Return the side of each point's label, by the index of its trace.

    ``width`` and ``height`` of the panel in px; a narrow window makes it narrower.
    """
    if not any(trace.labels for trace in panel.traces):
        return {}
    size = np.array([min(width, NARROW), height])
    low, high = np.array(spans).T

    def in_px(trace: Trace) -> np.ndarray:
        return (np.stack([trace.x, trace.y], axis=1) - low) / (high - low) * size

    drawn = [np.empty((0, 2))]
    for trace in (trace for trace in panel.traces if trace.kind in ("line", "steps", "points")):
        way = in_px(trace)
        drawn.append(np.repeat(way, MARKER, axis=0) if trace.kind == "points" else _filled(way))
    points = np.concatenate(drawn)
    taken: list[Box] = []
    found: dict[int, list[Side]] = {}
    for k, trace in enumerate(panel.traces):
        for place, words in zip(in_px(trace), trace.labels, strict=False):
            side = SIDES[0]
            if words:
                boxes = {other: _box(place, words, other) for other in SIDES}
                side = min(SIDES, key=lambda other: _badness(boxes[other], taken, points, size))
                taken.append(boxes[side])
            found.setdefault(k, []).append(side)
    return found


def _filled(way: np.ndarray) -> np.ndarray:
    """Points along a curve with gaps, shape (n, 2), px, dense enough for some to hit a label."""
    gaps = np.flatnonzero(~np.isfinite(way).all(axis=1))
    return np.concatenate([_between(piece[k > 0 :]) for k, piece in enumerate(np.split(way, gaps))])


def _between(way: np.ndarray) -> np.ndarray:
    if len(way) < 2:
        return way
    far = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(way, axis=0).T))])
    steps = np.linspace(0.0, far[-1], int(min(far[-1] / 3.0, 4000)) + 2)
    return np.stack([np.interp(steps, far, along) for along in way.T], axis=1)


def _box(place: np.ndarray, words: str, side: Side) -> Box:
    """Box (px) of a label with the text ``words`` at a side of a place (px)."""
    x, y = place
    width = LETTER * len(words)
    level, way = side.split()[0], side.split()[-1]
    foot = {"above": y + AWAY, "below": y - AWAY - LINE}.get(level, y - 0.5 * LINE)
    left = {"right": x + AWAY, "left": x - AWAY - width}.get(way, x - 0.5 * width)
    return left, left + width, foot, foot + LINE


def _badness(box: Box, taken: Sequence[Box], points: np.ndarray, size: np.ndarray) -> float:
    left, right, foot, top = box
    over = sum(left < other[1] and other[0] < right and foot < other[3] and other[2] < top for other in taken)
    inside = (points > (left, foot)) & (points < (right, top))
    outside = left < 0.0 or foot < 0.0 or right > size[0] or top > size[1]
    return OVER_WORDS * over + OUTSIDE * outside + float(inside.all(axis=1).sum())
