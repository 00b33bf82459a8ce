"""The calibration of one scenario: from its section to a function of the parameters, which flies."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from edl6dof.calibration.params import CalibrationFile, CalibrationParams
from edl6dof.campaign.design.case import Case
from edl6dof.campaign.design.variants import scenario_of
from edl6dof.campaign.neighbours import SampleMean, fly_neighbours, sample_means
from edl6dof.config.document.source import Document, read_document, resolve_scenario
from edl6dof.config.errors import ConfigError, Problem
from edl6dof.config.validate import validate
from edl6dof.metrics.published import Beside, published_figures
from edl6dof.scenario.schema import CALIBRATION, LoadedScenario, load_document

#: Called with the evaluations done so far.
Progress = Callable[[int], None]
#: Difference in entry speed of the flights of a mean, m/s: far below what a figure feels, and enough for them
#: to meet other cycles of the flight software, so that the mean bends smoothly with the parameters.
_SPEED_STEP_M_S = 0.02
#: A figure that too few of the neighbours reached cannot be compared: all must.
_UNREACHED = 1e3


@dataclass
class Calibration:
    """What is to be explained, and by what.

    Attributes:
        loaded: the scenario.
        params: its calibration section.
        beside: the figures, with what is published.
        flown: mean and spread of the figures at each set of parameters that was flown.
    """

    loaded: LoadedScenario
    params: CalibrationParams
    beside: tuple[Beside, ...]
    progress: Progress | None = None
    flown: dict[tuple[float, ...], Mapping[str, SampleMean]] = field(default_factory=dict)

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

    def values(self, x: np.ndarray) -> dict[str, float]:
        """Values by dotted path of parameters in standard deviations."""
        return {
            path: prior.mean + float(offset) * prior.sigma
            for (path, prior), offset in zip(self.params.parameters.items(), x, strict=True)
        }

    def figures(self, x: np.ndarray) -> Mapping[str, SampleMean]:
        """Mean and spread of the figures over neighbouring flights, the same ones whatever the parameters."""
        key = tuple(float(value) for value in x)
        if key not in self.flown:
            flights = self.params.flights
            rows = fly_neighbours(self.loaded, flights, step_m_s=_SPEED_STEP_M_S, belief=self.values(x))
            self.flown[key] = sample_means(rows, self.loaded.scenario.published)
            if self.progress is not None:
                self.progress(len(self.flown))
        return self.flown[key]

    @cached_property
    def weights(self) -> np.ndarray:
        """Standard deviation of each figure: of what is published, and of one flight about the mean, as the
        real one was; shape (figures,).
        """
        nominal = self.figures(np.zeros(len(self.paths)))
        spread = [nominal[b.figure.name].deviation if b.figure.name in nominal else 0.0 for b in self.beside]
        return np.hypot([b.published.sigma or 0.0 for b in self.beside], np.nan_to_num(spread))

    def misfit(self, x: np.ndarray) -> np.ndarray:
        """Residuals of the figures, shape (figures,); that of a figure which not all flights reached is
        large.
        """
        found = self.figures(x)
        return np.array(
            [
                (b.published.of(found[b.figure.name].mean) - b.published.number) / weight
                if b.figure.name in found and found[b.figure.name].flights == self.params.flights
                else _UNREACHED
                for b, weight in zip(self.beside, self.weights, strict=True)
            ]
        )


def load_calibration(name: str, sets: tuple[str, ...] = (), flights: int | None = None) -> Calibration:
    """Read a scenario file and its calibration section; see :func:`calibration_of`."""
    return calibration_of(read_document(resolve_scenario(name)), sets, flights)


def calibration_of(document: Document, sets: tuple[str, ...] = (), flights: int | None = None) -> Calibration:
    """Check a document that has a calibration section: nothing flies before all of it is right.

    Raises:
        ConfigError: every problem, with file and line.
    """
    if document.data.get(CALIBRATION) is None:
        raise ConfigError(
            [document.problem((), "has no calibration: section; edl6dof calibrate tianwen1 has")]
        )
    own = Document({CALIBRATION: document.data[CALIBRATION]}, dict(document.marks), files=document.files)
    params = validate(CalibrationFile, own).calibration
    if flights is not None:
        params = params.model_copy(update={"flights": flights})
    loaded = load_document(document, sets)
    beside = {b.figure.name: b for b in published_figures(loaded.scenario.published) if b.published.sigma}
    wrong = [
        own.problem(
            (CALIBRATION, "figures", k),
            f"is no flown value with a sigma under published (allowed {', '.join(beside)})",
        )
        for k, figure in enumerate(params.figures)
        if figure not in beside
    ]
    if not beside:
        wrong.append(own.problem((CALIBRATION,), "published: has no flown value with a sigma to explain"))
    calibration = Calibration(
        loaded, params, tuple(beside[name] for name in params.figures or beside if name in beside)
    )
    wrong += _unknown_paths(calibration, own)
    if wrong:
        raise ConfigError(wrong)
    return calibration


def _unknown_paths(calibration: Calibration, own: Document) -> list[Problem]:
    """Parameters that the scenario has not, or whose bounds it does not allow."""
    priors = calibration.params.parameters
    elements = [path for path in priors if path.rpartition(".")[2].isdecimal()]
    if elements:
        return [
            own.problem(
                (CALIBRATION, "parameters", path), "must be a value of its own, not an element of a list"
            )
            for path in elements
        ]
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
    """Why a scenario refuses values by dotted path, if it does."""
    try:
        scenario_of(loaded, Case(0, belief=values))
    except ConfigError as error:
        return error
    return None
