"""Where an event happens, as covariance tells it and as the flights of a campaign show it."""

from __future__ import annotations

import numpy as np

from edl6dof.campaign.covariance_estimate import Covariance
from edl6dof.campaign.statistics import contour
from edl6dof.metrics.figures import figure_of_merit
from edl6dof.report.figure import BLACK, BLUE, Axis, Dash, Figure, Panel, Trace

_DASHES: dict[int, Dash] = {1: "solid", 2: "dash", 3: "dot"}


def ellipse_figure(title: str, found: Covariance, sampled: np.ndarray | None) -> Figure:
    """Ellipses of one to three standard deviations of the first two figures of the event, which are its
    position if it has one, and the flights of a campaign if given, shape (flights, figures).
    """
    mean, covariance = found.spread.mean[:2], found.pairs.covariance[:2, :2]
    traces = []
    if sampled is not None:
        x, y = sampled[:, :2].T
        traces.append(Trace(x, y, "flights of the campaign", "points", BLUE, width=1.0))
    for sigmas, dash in _DASHES.items():
        x, y = contour(covariance, sigmas) + mean[:, None]
        traces.append(Trace(x, y, f"{sigmas} sigma", colour=BLACK, dash=dash))
    across, up = (_axis(name) for name in found.event.all[:2])
    equal = bool(found.event.position)
    return Figure("covariance", title, [Panel(across, up, traces, equal=equal)], height=480)


def _axis(name: str) -> Axis:
    figure = figure_of_merit(name)
    return Axis(f"{figure.meaning} ({figure.unit.label or '1'})")
