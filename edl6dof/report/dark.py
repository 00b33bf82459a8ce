"""The colours of figures on a dark page: each of :mod:`edl6dof.report.figure` and the one in its place.

A drawing names its colours once, for paper; a page whose reader prefers dark ones puts these in.  Both sets
stay apart for the colour-blind.
"""

from __future__ import annotations

from edl6dof.report.figure import (
    AXIS,
    BAD,
    BLACK,
    BLUE,
    GOOD,
    GREEN,
    GREY,
    INK,
    ORANGE,
    PAPER,
    PHASES,
    PURPLE,
    ROUGH,
    RULE,
    SAFE,
    SEQUENTIAL,
    SKY,
    STEEP,
    UNKNOWN,
    UNSEEN,
    VERMILION,
    WARN,
)

_PHASES = ("#1d3a52", "#573220", "#1c4434", "#4b2f41", "#544018", "#1b4557", "#3a3f46", "#3a345a")
_SEQUENTIAL = ("#1b2027", "#173a5e", "#1f5f93", "#3f8fc4", "#86bfe3", "#e2f0fa")

DARK = {
    BLUE: "#2f8fdc",
    VERMILION: "#e8702a",
    GREEN: "#14b88c",
    PURPLE: "#d98cc0",
    ORANGE: "#f2b93b",
    SKY: "#7cc8f7",
    BLACK: "#f0f2f4",
    GREY: "#98a1ac",
    INK: "#e4e8ec",
    RULE: "#2d343d",
    AXIS: "#4a535e",
    PAPER: "#171b21",
    GOOD: "#35c79a",
    WARN: "#e0a63c",
    BAD: "#ff7b72",
    SAFE: "#1c7a52",
    UNSEEN: "#4c525a",
    STEEP: "#d0a03a",
    ROUGH: "#a83f22",
    UNKNOWN: "#343b44",
    **dict(zip(PHASES, _PHASES, strict=True)),
    **dict(zip(SEQUENTIAL, _SEQUENTIAL, strict=True)),
}
