"""What a flight leaves that was not flown by :class:`~edl6dof.sim.underway.Underway`."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from edl6dof.scenario.loading import LoadedScenario


@dataclass
class Flown:
    """The records of a flight at its end, each of shape (1,), named as those of a flight under way, and its
    telemetry since t = 0.

    Attributes:
        code: outcome code of the loop.
        cycle: base cycle that would come next.
    """

    loaded: LoadedScenario
    case: np.ndarray
    tables: np.ndarray
    onboard: np.ndarray
    plant: np.ndarray
    outputs: np.ndarray
    peaks: np.ndarray
    work: np.ndarray
    sensors: np.ndarray
    fsw: np.ndarray
    log: np.ndarray
    code: int
    cycle: int
    first: int = 0

    @property
    def rows(self) -> int:
        """Rows of the telemetry."""
        return len(self.log)
