"""Findings of a calibration: in numbers, in sentences, and as a scenario file that extends the calibrated
one.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from edl6dof import __version__
from edl6dof.calibration.fit import DESIGNS, Fit, fit
from edl6dof.calibration.problem import Calibration
from edl6dof.campaign.executor import Progress
from edl6dof.config.document.document import EXTENDS
from edl6dof.config.dump import dump_resolved

#: A residual beyond which a figure is not explained, in standard deviations.
UNEXPLAINED = 2.0
#: Resolution below which the figures say next to nothing about a parameter, and correlation above which they
#: cannot separate two parameters.
UNTOLD, ALIKE = 0.1, 0.9


@dataclass(frozen=True, repr=False)
class Findings:
    """Result of a calibration: the posterior, and the figures flown at its solution.

    Attributes:
        before: means of the figures over neighbouring flights at the priors' means, shape (figures,).
        after: means of the figures over neighbouring flights at the solution, flown and not computed from the
            linear model, shape (figures,).
    """

    calibration: Calibration
    fit: Fit
    before: np.ndarray
    after: np.ndarray

    def __repr__(self) -> str:
        return f"<Findings: {', '.join(f'{path} = {value:.5g}' for path, value in self.values.items())}>"

    @property
    def values(self) -> dict[str, float]:
        """Values of the parameters at the solution, by dotted path, in their own units."""
        return self.calibration.values(self.fit.x)

    @property
    def sigmas(self) -> dict[str, float]:
        """Posterior standard deviations of the parameters, by dotted path, in their own units."""
        priors = self.calibration.params.parameters
        shares = map(float, self.fit.deviation)
        return {path: priors[path].sigma * share for path, share in zip(priors, shares, strict=True)}

    @property
    def residuals(self) -> np.ndarray:
        """Flown less published value of each figure, shape (figures,), over the combined standard deviation
        of the published value (not widened) and of one flight.
        """
        return (self.after - self.calibration.data.number) / self.fit.sigma

    @property
    def unexplained(self) -> list[str]:
        """Meanings of the figures that the solution does not explain."""
        pairs = zip(self.calibration.compared, self.residuals, strict=True)
        return [b.figure.meaning for b, residual in pairs if not abs(residual) <= UNEXPLAINED]


def find(calibration: Calibration, progress: Progress | None = None) -> Findings:
    """Find the posterior of a calibration, and fly the figures before and after.

    Raises:
        TooFew: too few flights of a design reached every figure.
    """
    flights, seed = calibration.params.flights, calibration.loaded.scenario.seed
    fly = partial(calibration.fly, progress=progress)
    found = fit(fly, calibration.data, *calibration.bounds, flights, seed)
    before, after = (calibration.means(x, progress) for x in (np.zeros(len(found.x)), found.x))
    return Findings(calibration, found, before, after)


def rounded(found: Findings) -> dict[str, float]:
    """Values at the solution by dotted path, rounded to a hundredth of their posterior standard deviation."""
    return {
        path: round(value, int(np.ceil(2.0 - np.log10(found.sigmas[path]))))
        for path, value in found.values.items()
    }


def remarks(found: Findings) -> list[str]:
    """Return sentences on how far the figures determine the parameters, and on unexplained figures."""
    paths, fitted, figures = found.calibration.paths, found.fit, len(found.calibration.compared)
    said = [
        f"{figures} figures determine {fitted.determined:.1f} of {len(paths)} parameters; the priors "
        "determine the rest."
    ]
    if untold := [path for path, share in zip(paths, fitted.resolution, strict=True) if share < UNTOLD]:
        said.append(f"The figures say next to nothing about: {', '.join(untold)}.")
    for i, j in zip(*np.triu_indices(len(paths), 1), strict=True):
        if abs(correlation := fitted.correlation[i, j]) > ALIKE:
            said.append(
                f"The figures cannot separate {paths[i]} and {paths[j]} (correlation {correlation:+.2f})."
            )
    if bound := [path for path, stands in zip(paths, fitted.at_bound, strict=True) if stands]:
        said.append(f"At a bound: {', '.join(bound)}.")
    if lost := found.unexplained:
        said.append(f"Not explained within {UNEXPLAINED:g} sigma: {', '.join(lost)}.")
    if fitted.widening > 1.0:
        said.append(
            f"Priors and figures contradict each other: sum of squares {fitted.squares:.0f} where {figures} "
            f"are expected; the published sigmas are multiplied by {fitted.widening:.1f}."
        )
    said.append(f"The last design moved no parameter by more than {fitted.moved:.2f} of its posterior sigma.")
    return said


def plain(found: Findings) -> dict[str, Any]:
    """All results, ready for JSON; a mean is ``nan`` if a neighbour did not reach the figure."""
    calibration, fitted, residuals = found.calibration, found.fit, found.residuals
    priors, values, sigmas = calibration.params.parameters, found.values, found.sigmas
    return {
        "scenario": calibration.loaded.scenario.name,
        "designs": DESIGNS,
        "flights": calibration.params.flights,
        "seed": calibration.loaded.scenario.seed,
        "squares": fitted.squares,
        "widening": fitted.widening,
        "moved": fitted.moved,
        "parameters": {
            path: {
                "prior_mean": prior.mean,
                "prior_sigma": prior.sigma,
                "mean": values[path],
                "sigma": sigmas[path],
                "resolution": float(fitted.resolution[k]),
                "at_bound": bool(fitted.at_bound[k]),
            }
            for k, (path, prior) in enumerate(priors.items())
        },
        "correlation": fitted.correlation.tolist(),
        "figures": {
            b.figure.name: {
                "published": b.published.number,
                "sigma": float(fitted.sigma[k]),
                "before": float(found.before[k]),
                "after": float(found.after[k]),
                "residual": float(residuals[k]),
                "slopes": dict(zip(priors, fitted.slopes[k].tolist(), strict=True)),
            }
            for k, b in enumerate(calibration.compared)
        },
        "remarks": remarks(found),
        "edl6dof_version": __version__,
    }


def overlay_text(name: str, extended: str, values: Mapping[str, float], sources: Mapping[str, str]) -> str:
    """YAML text of a scenario that extends another one and calibrates some values.

    Args:
        name: name of the new scenario.
        extended: scenario that it extends, by name or path.
        values: by dotted path; a path may name items of lists, but no element of a list of numbers.
        sources: how each value was found, by dotted path.
    """
    tree: dict[str, Any] = {EXTENDS: extended, "name": name}
    for path, value in values.items():
        *parents, key = path.split(".")
        inside = tree
        for parent in parents:
            inside = inside.setdefault(parent, {})
        inside[key] = value
    return dump_resolved(tree, status=dict.fromkeys(values, "calibrated"), sources=sources)
