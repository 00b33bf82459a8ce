"""The curves of the plots, and their axes: wide enough for all that is drawn, and for two ticks.

The viewer puts its ticks at multiples of a power of ten, and leaves out those that would stand closer than a
line of text: of seven or more in a plot a sixth of a window high it shows the zero alone.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from edl6dof.replay.views.panels import Plot

#: Standard deviations that bounds stand at.
BOUND = 3.0
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


def drawn(
    plot: Plot, series: Mapping[str, np.ndarray], when: Mapping[str, float]
) -> tuple[np.ndarray, np.ndarray]:
    """Times (s), shape (n,), and curves of a plot, shape (n, curves), where they mean something; the bounds
    that are claimed come last.
    """
    t = series["t_s"]
    keep = _within(t, when.get(plot.since, -np.inf), when.get(plot.until, np.inf))
    values = [series[name][keep] for name in plot.series]
    if plot.sigma:
        values += [sign * BOUND * series[plot.sigma][keep] for sign in (1.0, -1.0)]
    return t[keep], plot.scale * np.stack(values, axis=-1)


def ends(t: np.ndarray, curves: np.ndarray, span: tuple[float, float]) -> list[float]:
    """Least and largest value of curves within a time (s); empty where there are none."""
    values = curves[_within(t, *span)]
    values = values[np.isfinite(values)]
    return [float(values.min()), float(values.max())] if len(values) else []


def _within(t: np.ndarray, first: float, last: float) -> slice:
    """Rows from one time (s) to another, both among them."""
    return slice(int(np.searchsorted(t, first)), int(np.searchsorted(t, last, side="right")))


def _ticks(low: float, high: float, step: float) -> int:
    return int(np.floor(high / step + 1e-9) - np.ceil(low / step - 1e-9)) + 1
