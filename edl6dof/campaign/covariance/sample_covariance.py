"""Spread of a finished campaign's flights, which covariance is held against."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pyarrow as pa
from scipy.stats import kurtosis

from edl6dof.campaign.covariance.estimate import principal
from edl6dof.campaign.covariance.event_figures import EventFigures
from edl6dof.config.errors import refusal

#: Shares of a normal distribution below one standard deviation under and over its mean.
_CORE = (0.158655, 0.841345)


@dataclass(frozen=True)
class Sampled:
    """Spread of some quantities over flights; each array has shape (quantities,).

    Attributes:
        mean: mean.
        deviation: standard deviation.
        error: its standard error, which the tails of the distribution widen.
        core: half of what the middle 68 % span: the deviation, where the distribution is normal.
    """

    mean: np.ndarray
    deviation: np.ndarray
    error: np.ndarray
    core: np.ndarray

    @classmethod
    def of(cls, values: np.ndarray) -> Sampled:
        """``values`` has shape (flights, quantities)."""
        deviation = values.std(axis=0, ddof=1)
        low, high = np.quantile(values, _CORE, axis=0)
        error = deviation * np.sqrt((kurtosis(values) + 2.0) / (4.0 * len(values)))
        return cls(values.mean(axis=0), deviation, error, 0.5 * (high - low))


def flown(table: pa.Table, event: EventFigures, place: object) -> np.ndarray:
    """Figures of the flights that came to the event, shape (flights, figures).

    Raises:
        ConfigError: fewer than ten did.
    """
    if missing := [name for name in event.all if name not in table.column_names]:
        raise refusal(place, f"no flight of it has {', '.join(missing)}")
    values = np.stack([table[name].to_numpy(zero_copy_only=False) for name in event.all], axis=1)
    values = values[np.isfinite(values).all(axis=1)]
    if len(values) < 10:
        raise refusal(place, f"only {len(values)} of its flights came to the event")
    return values


def along_axes(values: np.ndarray, position: int) -> np.ndarray:
    """Position along the axes of its own ellipse, long axis first, shape (flights, position)."""
    place = values[:, :position]
    return place @ principal(np.cov(place.T)) if position else place
