"""What a calibration found, in numbers and sentences."""

from __future__ import annotations

from typing import Any

import numpy as np

from edl6dof import __version__
from edl6dof.calibration.fit import Fit
from edl6dof.calibration.problem import Calibration

#: A residual beyond which a figure is not explained, in standard deviations.
UNEXPLAINED = 2.0
#: Resolution below which the figures say next to nothing of a parameter, and correlation above which they
#: tell two parameters apart no more.
UNTOLD, ALIKE = 0.1, 0.9


def rounded(calibration: Calibration, found: Fit) -> dict[str, float]:
    """Values by dotted path, to a hundredth of their posterior standard deviation."""
    deviations = found.deviation * [prior.sigma for prior in calibration.params.parameters.values()]
    return {
        path: round(value, int(np.ceil(2.0 - np.log10(deviation))))
        for (path, value), deviation in zip(calibration.values(found.x).items(), deviations, strict=True)
    }


def unexplained(calibration: Calibration, found: Fit) -> list[str]:
    """Meanings of the figures that the solution does not explain."""
    return [
        b.figure.meaning
        for b, residual in zip(calibration.beside, found.after, strict=True)
        if abs(residual) > UNEXPLAINED
    ]


def remarks(calibration: Calibration, found: Fit) -> list[str]:
    """What the figures cannot tell, in sentences."""
    paths, said = calibration.paths, []
    said.append(
        f"{len(calibration.beside)} figures tell {found.told_apart:.1f} of {len(paths)} parameters; the rest "
        "is what the priors say."
    )
    if untold := [path for path, share in zip(paths, found.resolution, strict=True) if share < UNTOLD]:
        said.append(f"They say next to nothing of: {', '.join(untold)}.")
    for i, j in zip(*np.triu_indices(len(paths), 1), strict=True):
        if abs(correlation := found.correlation[i, j]) > ALIKE:
            said.append(f"They cannot tell apart {paths[i]} and {paths[j]} (correlation {correlation:+.2f}).")
    if bound := [path for path, stands in zip(paths, found.at_bound, strict=True) if stands]:
        said.append(f"At the end of what is possible: {', '.join(bound)}.")
    if lost := unexplained(calibration, found):
        said.append(f"Not explained within {UNEXPLAINED:g} sigma: {', '.join(lost)}.")
    return said


def plain(calibration: Calibration, found: Fit) -> dict[str, Any]:
    """Everything that was found, ready for JSON."""
    priors, values = calibration.params.parameters, calibration.values(found.x)
    return {
        "scenario": calibration.loaded.scenario.name,
        "flights": calibration.params.flights,
        "evaluations": len(calibration.flown),
        "parameters": {
            path: {
                "prior_mean": prior.mean,
                "prior_sigma": prior.sigma,
                "mean": values[path],
                "sigma": prior.sigma * float(found.deviation[k]),
                "resolution": float(found.resolution[k]),
                "at_bound": bool(found.at_bound[k]),
            }
            for k, (path, prior) in enumerate(priors.items())
        },
        "correlation": found.correlation.tolist(),
        "figures": {
            b.figure.name: {
                "published": b.published.number,
                "sigma": float(calibration.weights[k]),
                "before": float(found.before[k]),
                "after": float(found.after[k]),
                "slopes": dict(zip(priors, found.slopes[k].tolist(), strict=True)),
            }
            for k, b in enumerate(calibration.beside)
        },
        "remarks": remarks(calibration, found),
        "edl6dof_version": __version__,
    }
