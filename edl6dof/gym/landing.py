"""Whether a flight of a fleet has landed as it should."""

from __future__ import annotations

import numpy as np

from edl6dof.metrics.evaluation import checks
from edl6dof.metrics.footing import footing_figures
from edl6dof.metrics.touchdown import touchdown_state
from edl6dof.scenario.schema import LimitParams
from edl6dof.sim.fleet import Fleet
from edl6dof.sim.outcome import LANDED


def landed_well(fleet: Fleet, limits: LimitParams) -> np.ndarray:
    """Whether each flight has come to rest upright, within the limits of touchdown and of the ground below,
    shape (flights,).
    """
    landed = fleet.outcomes == LANDED
    for index in np.flatnonzero(landed):
        landed[index] = _within(fleet, int(index), limits)
    return landed


def _within(fleet: Fleet, index: int, limits: LimitParams) -> bool:
    one = slice(index, index + 1)
    case, plant, outputs = fleet.cases[one], fleet.plants[one], fleet.outputs[one]
    figures = touchdown_state(case, plant)
    figures |= footing_figures(case, fleet.tables, plant, outputs)
    return all(check.ok for check in checks(limits, figures))
