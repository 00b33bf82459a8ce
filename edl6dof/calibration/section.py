"""The ``calibration:`` section of a scenario file: which parameters are uncertain, and how much."""

from __future__ import annotations

from typing import Self

from pydantic import model_validator

from edl6dof.config.base import REQUIRED, Params, param
from edl6dof.config.errors import Inconsistent
from edl6dof.config.wording import counted

#: Flights for each coefficient of a regression, at the least.
_FLIGHTS_PER_COEFFICIENT = 4


def least_flights(parameters: int) -> int:
    """Flights without which no surface is fitted."""
    return _FLIGHTS_PER_COEFFICIENT * (parameters + 1)


class Prior(Params):
    """Prior knowledge of a parameter, in its unit: normal, cut at its bounds."""

    mean: float = param(REQUIRED, "most likely value")
    sigma: float = param(REQUIRED, "standard deviation", gt=0.0)
    low: float | None = param(None, "lowest possible value; mean - 4 sigma when not given")
    high: float | None = param(None, "highest possible value; mean + 4 sigma when not given")

    @model_validator(mode="after")
    def _mean_is_possible(self) -> Self:
        low, high = self.bounds
        if not low < self.mean < high:
            words = f"must lie between low and high (got {self.mean:g}, {low:g}, {high:g})"
            raise Inconsistent({"mean": words})
        return self

    @property
    def bounds(self) -> tuple[float, float]:
        """Lowest and highest value."""
        low = self.mean - 4.0 * self.sigma if self.low is None else self.low
        return low, self.mean + 4.0 * self.sigma if self.high is None else self.high


class CalibrationParams(Params):
    """Uncertain parameters, and the figures that they are to explain."""

    parameters: dict[str, Prior] = param(
        REQUIRED, "prior of each uncertain parameter, by dotted path", min_length=1
    )
    figures: list[str] = param(
        None,
        "published figures to explain; all flown values that have a sigma when none is named",
        factory=list,
    )
    flights: int = param(256, "flights of each design, every one at its own parameters", ge=1, le=100_000)

    @model_validator(mode="after")
    def _flights_tell_a_surface(self) -> Self:
        parameters = counted(len(self.parameters), "parameter")
        if self.flights < (least := least_flights(len(self.parameters))):
            raise Inconsistent({"flights": f"must be >= {least} with {parameters} (got {self.flights})"})
        return self


class CalibrationFile(Params):
    """The section of a scenario file."""

    calibration: CalibrationParams = param(REQUIRED, "calibration against the published flight")
