"""The calibration of one scenario: its ``calibration:`` section, and flights that give the figures for given
parameters.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from math import nan
from typing import Self

import numpy as np
from pydantic import model_validator

from edl6dof.calibration.fit import Data, least_flights
from edl6dof.campaign.design.case import Case, scenario_of
from edl6dof.campaign.ensemble import fly_neighbours
from edl6dof.campaign.executor import Progress, Row, fly_rows
from edl6dof.config.base import REQUIRED, Params, param
from edl6dof.config.document.document import Document
from edl6dof.config.document.source import read_document, resolve_scenario
from edl6dof.config.errors import ConfigError, Inconsistent, Problem
from edl6dof.config.validate import judged
from edl6dof.config.wording import counted
from edl6dof.metrics.published import PublishedPair, published_figures
from edl6dof.scenario.loaded import LoadedScenario
from edl6dof.scenario.loading import CALIBRATION, judged_scenario


class Prior(Params):
    """Prior knowledge of a parameter, in its unit: a normal distribution cut off at two bounds."""

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
    """Uncertain parameters, and the published figures that they should explain."""

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
    def _flights_suffice(self) -> Self:
        parameters = counted(len(self.parameters), "parameter")
        if self.flights < (least := least_flights(len(self.parameters))):
            raise Inconsistent({"flights": f"must be >= {least} with {parameters} (got {self.flights})"})
        return self


class CalibrationFile(Params):
    """The ``calibration:`` section of a scenario file."""

    calibration: CalibrationParams = param(REQUIRED, "calibration against the published flight")


@dataclass(frozen=True)
class Calibration:
    """Scenario, its calibration section, and the figures to explain with their published values."""

    loaded: LoadedScenario
    params: CalibrationParams
    compared: tuple[PublishedPair, ...]

    @property
    def paths(self) -> list[str]:
        """Dotted paths of the parameters."""
        return list(self.params.parameters)

    @property
    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Bounds of the parameters, in standard deviations from the means of their priors."""
        priors = self.params.parameters.values()
        low, high = np.array([prior.bounds for prior in priors]).T
        mean, sigma = (np.array([getattr(prior, name) for prior in priors]) for name in ("mean", "sigma"))
        return (low - mean) / sigma, (high - mean) / sigma

    @property
    def data(self) -> Data:
        """Published values of the figures."""
        numbers, sigmas = (
            [getattr(b.published, name) for b in self.compared] for name in ("number", "sigma")
        )
        return Data(np.array(numbers), np.array(sigmas))

    def values(self, x: np.ndarray) -> dict[str, float]:
        """Values in their own units, by dotted path, of parameters in standard deviations of their priors."""
        return {
            path: prior.mean + float(offset) * prior.sigma
            for (path, prior), offset in zip(self.params.parameters.items(), x, strict=True)
        }

    def fly(self, points: np.ndarray, progress: Progress | None = None) -> np.ndarray:
        """Fly once at each row of ``points``, shape (flights, parameters), in standard deviations of the
        priors; return the figures, shape (flights, figures), ``nan`` where a figure was not reached.
        """
        profile = self.loaded.scenario.profile
        cases = [Case(k, belief=self.values(x), profile=profile + k) for k, x in enumerate(points)]
        return self._figures(fly_rows(self.loaded, cases, progress=progress))

    def means(self, x: np.ndarray, progress: Progress | None = None) -> np.ndarray:
        """Means of the figures, shape (figures,), over neighbouring flights at one set of parameters."""
        rows = fly_neighbours(self.loaded, belief=self.values(x), progress=progress)
        return np.mean(self._figures(rows), axis=0)

    def _figures(self, rows: Iterable[Row]) -> np.ndarray:
        return np.array(
            [[b.published.of(row.get(b.figure.name, nan)) for b in self.compared] for row in rows]
        )


def load_calibration(name: str, sets: tuple[str, ...] = (), flights: int | None = None) -> Calibration:
    """Read a scenario file and its calibration section; see :func:`calibration_of`."""
    return calibration_of(read_document(resolve_scenario(name)), sets, flights)


def calibration_of(document: Document, sets: tuple[str, ...] = (), flights: int | None = None) -> Calibration:
    """Check a document that has a calibration section: nothing flies before all of it is right.

    Raises:
        ConfigError: every problem, with file and line.
    """
    if (section := document.data.get(CALIBRATION)) is None:
        words = "has no calibration: section; edl6dof calibrate tianwen1 has"
        raise ConfigError([document.problem((), words)])
    if flights is not None and isinstance(section, dict):
        section = {**section, "flights": flights}
    own = Document({CALIBRATION: section}, dict(document.marks), files=document.files)
    file, problems = judged(CalibrationFile, own)
    loaded, more = judged_scenario(document, sets)
    if problems or more:
        raise ConfigError([*problems, *more])
    params = file.calibration
    every = published_figures(loaded.scenario.published)
    explainable = {b.figure.name: b for b in every if b.published.explainable}
    words = f"is no flown value with a sigma under published (allowed {', '.join(explainable)})"
    wrong = [
        own.problem((CALIBRATION, "figures", k), words)
        for k, figure in enumerate(params.figures)
        if figure not in explainable
    ]
    if not explainable:
        wrong.append(own.problem((CALIBRATION,), "published: has no flown value with a sigma to explain"))
    chosen = tuple(explainable[name] for name in params.figures or explainable if name in explainable)
    calibration = Calibration(loaded, params, chosen)
    wrong += _unknown_paths(calibration, own)
    if wrong:
        raise ConfigError(wrong)
    return calibration


def _unknown_paths(calibration: Calibration, own: Document) -> list[Problem]:
    """Find parameters that the scenario does not have, or whose bounds it does not allow."""
    priors = calibration.params.parameters
    words = "must be a value of its own, not an element of a list"
    if elements := [path for path in priors if path.rpartition(".")[2].isdecimal()]:
        return [own.problem((CALIBRATION, "parameters", path), words) for path in elements]
    corners = [
        {path: value(prior) for path, prior in priors.items()}
        for value in (lambda p: p.bounds[0], lambda p: p.mean, lambda p: p.bounds[1])
    ]
    if all(_refused(calibration.loaded, corner) is None for corner in corners):
        return []
    alone = (
        (path, _refused(calibration.loaded, {path: corner[path]})) for path in priors for corner in corners
    )
    return [
        own.problem((CALIBRATION, "parameters", path), error.problems[0].message)
        for path, error in alone
        if error is not None
    ]


def _refused(loaded: LoadedScenario, values: Mapping[str, float]) -> ConfigError | None:
    """Return the error with which a scenario refuses values by dotted path, ``None`` if it accepts them."""
    try:
        scenario_of(loaded, Case(0, belief=values))
    except ConfigError as error:
        return error
    return None
