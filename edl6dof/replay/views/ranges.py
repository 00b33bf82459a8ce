"""The axes of the plots: from the least to the largest value that is drawn, and wide enough for two ticks.

The viewer puts its ticks at multiples of a power of ten, and leaves out those that would stand closer than a
line of text: of seven or more in a plot a sixth of a window high it shows the zero alone.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from edl6dof.replay.views.panels import Plot

#: Most steps between ticks that a plot of the least height has room for.
STEPS = 4.5
#: Room above and below the curves, share of the range.
ROOM = 0.06


def axis_range(low: float, high: float) -> tuple[float, float]:
    """First and last value of an axis on which values from ``low`` to ``high`` are drawn."""
    if abs(low + high) < 3.0 * (high - low):  # zero is near
        low, high = min(low, 0.0), max(high, 0.0)
    if high - low < 1e-9 * max(abs(low), abs(high), 1.0):
        low, high = low - 0.5, high + 0.5
    step = 10.0 ** np.ceil(np.log10((high - low) / STEPS))
    if _ticks(low, high, step) < 2:
        high = step * np.ceil(high / step)
    if _ticks(low, high, step) < 2:
        low = step * np.floor(low / step)
    room = ROOM * (high - low)
    return float(low - room), float(high + room)


def drawn_range(
    plot: Plot, columns: Mapping[str, np.ndarray], when: Mapping[str, float], span: tuple[float, float]
) -> tuple[float, float] | None:
    """Least and largest value that a plot shows of a flight within a time (s); ``None`` where it shows
    nothing.
    """
    t = columns["t_s"]
    first, last = span
    keep = (t >= when.get(plot.since, first)) & (t <= when.get(plot.until, last)) & (t >= first) & (t <= last)
    values = plot.scale * np.array([columns[name][keep] for name in plot.series])
    values = values[np.isfinite(values)]
    return (float(values.min()), float(values.max())) if len(values) else None


def _ticks(low: float, high: float, step: float) -> int:
    return int(np.floor(high / step + 1e-9) - np.ceil(low / step - 1e-9)) + 1
