"""Bands of dispersed flights over time around the trajectory of a real flight: shares, words and picture.

The error of the flown value is not in the bands.  The samples of a curve are correlated, so their share in
the band of 95 % is no test: it scatters widely around 95 % if the dispersions are right.
"""

from __future__ import annotations

from collections.abc import Sequence
from textwrap import fill
from typing import Any, NamedTuple

import numpy as np

from edl6dof.campaign.executor import Row
from edl6dof.config.wording import counted
from edl6dof.missions.flown import SERIES, Trajectory
from edl6dof.report.catalogue import plot_of
from edl6dof.report.figure import Axis, Figure, Panel, Trace
from edl6dof.report.flight.common import LETTERS, TIME
from edl6dof.report.palette import BLUE, VERMILION

#: Shares of the flights below the edges of the bands, and the edges of the band of each probability.
EDGES, BANDS = (0.025, 0.25, 0.5, 0.75, 0.975), {0.95: (0, 4), 0.5: (1, 3)}


class Band(NamedTuple):
    """A channel of a real flight, and the dispersed flights at the same times.

    Attributes:
        channel: its name in the telemetry.
        t: times, s, shape (samples,).
        flown: values of the real flight, shape (samples,).
        edges: quantiles (:data:`EDGES`) of the flights, shape (5, samples); NaN where fewer than half of the
            flights fly.
    """

    channel: str
    t: np.ndarray
    flown: np.ndarray
    edges: np.ndarray

    @property
    def there(self) -> np.ndarray:
        """Samples with a band, shape (samples,), bool."""
        return np.isfinite(self.edges[0])

    @property
    def shares(self) -> dict[str, Any]:
        """Numbers of samples, and shares in the bands, for JSON."""
        inside = {f"inside_{100.0 * level:.0f}": self.share(level) for level in BANDS}
        return {"channel": self.channel, "samples": len(self.t), "with_band": int(self.there.sum()), **inside}

    def share(self, probability: float) -> float:
        """Share of the samples with a band that lie in the central band of this ``probability``."""
        low, high = (self.edges[k, self.there] for k in BANDS[probability])
        flown = self.flown[self.there]
        return float(np.mean((low <= flown) & (flown <= high))) if len(flown) else float("nan")


def bands(flown: Trajectory | None, rows: Sequence[Row]) -> tuple[Band, ...]:
    """Band of each channel of a real flight over the rows of dispersed flights."""
    found = []
    for channel, values in (flown.channels if flown else {}).items():
        none = [np.nan] * len(values)
        every = np.array([row.get(SERIES + channel) or none for row in rows])
        there = 2 * np.isfinite(every).sum(axis=0) >= max(len(rows), 1)
        edges = np.full((len(EDGES), len(values)), np.nan)
        edges[:, there] = np.nanquantile(every[:, there], EDGES, axis=0)
        found.append(Band(channel, flown.t if flown else values, values, edges))
    return tuple(found)


def in_bands(mission: str, found: Sequence[Band]) -> list[str]:
    """Say which share of each flown curve lies in the bands."""
    return [
        f"{mission}, {plot_of(band.channel).title}: {100.0 * band.share(0.95):.0f} % of the flown curve in "
        f"the central 95 % of the flights, {100.0 * band.share(0.5):.0f} % in the central 50 % "
        f"({counted(int(band.there.sum()), 'sample')})"
        for band in found
    ]


def bands_drawing(mission: str, found: Sequence[Band]) -> Figure:
    """Each flown channel over time with the bands of the flights; on the right, less their median."""
    panels = [panel for band in found for panel in _panels(band)]
    return Figure("flown", f"{mission}: flown and predicted", panels, columns=2, share_x=True, height=230)


def _panels(band: Band) -> list[Panel]:
    plot = plot_of(band.channel)
    factor, there = 1e-3 if plot.kilo else 1.0, band.there
    edges, flown, t = factor * band.edges[:, there], factor * band.flown[there], band.t[there]
    found = []
    for zero, title in ((0.0 * t, plot.label), (edges[2], f"{plot.title}, less the median")):
        regions = [
            Trace(
                np.append(t, t[::-1]),
                np.append(edges[low] - zero, (edges[high] - zero)[::-1]),
                f"{100.0 * level:.0f} % of the flights",
                "region",
                BLUE,
            )
            for level, (low, high) in BANDS.items()
        ]
        median = Trace(t, edges[2] - zero, "their median", colour=BLUE, width=1.0)
        curve = Trace(t, flown - zero, "flown", colour=VERMILION)
        found.append(Panel(Axis(TIME), Axis(fill(title, LETTERS)), [*regions, median, curve]))
    return found
