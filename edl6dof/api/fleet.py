"""Dispersed flights of one scenario in parallel, each started in a phase, for learning environments."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from edl6dof.api.simulation import Starts
from edl6dof.config.errors import refusal
from edl6dof.metrics.evaluation import checks
from edl6dof.metrics.touchdown import touchdown_state, touchdown_terrain_figures
from edl6dof.scenario.schema import LimitParams
from edl6dof.sim import fleet as sim
from edl6dof.sim.fleet import Start
from edl6dof.sim.outcome import FLYING, LANDED
from edl6dof.sim.simulation import SteppedFlight

#: Base cycles between two looks at the phase.
_LOOK = 5


class Fleet(sim.Fleet):
    """Flights of one scenario; see :class:`edl6dof.sim.fleet.Fleet` for the records of each."""

    @property
    def flying(self) -> np.ndarray:
        """True for each flight that has not ended, shape (flights,)."""
        return self.outcomes == FLYING

    def landed_well(self, limits: LimitParams) -> np.ndarray:
        """True for each flight at rest within the limits of touchdown and of the ground, shape (flights,)."""
        landed = self.outcomes == LANDED
        for index in np.flatnonzero(landed):
            one = slice(index, index + 1)
            case, plant, outputs = self.cases[one], self.plants[one], self.outputs[one]
            figures = touchdown_state(case, plant)
            figures |= touchdown_terrain_figures(case, self.tables, plant, outputs)
            landed[index] = all(check.ok for check in checks(limits, figures))
        return landed


class DispersedFlights:
    """The flights of a campaign by their seeds, flown by the flight software up to a phase.

    Args:
        scenario: name or file of a campaign.
        overrides: changes of the scenario, as for :func:`edl6dof.load`.
        faults: faults that replace those of the campaign; each flight has one of them, all equally likely.

    Attributes:
        loaded: the scenario.
    """

    def __init__(
        self, scenario: str, overrides: Mapping[str, Any] | None = None, faults: Sequence[Mapping] = ()
    ):
        self._name, self._starts = scenario, Starts(scenario, overrides or {}, faults)
        self.loaded = self._starts.loaded

    def fleet(self, count: int, workers: int = 1) -> Fleet:
        """Make a fleet with places for a number of flights, which :meth:`Fleet.put` starts."""
        return Fleet(count, self._starts.base.parts.tables, self.loaded.scenario.steps_per_cycle, workers)

    def at_phase(self, seed: int, role: str, later_s: float = 0.0) -> Start | None:
        """Return the flight of a seed at the start of its phase with a role, or ``later_s`` (s) after it;
        ``None`` if it ends before.

        Raises:
            ConfigError: the campaign disperses tables of air or ground, which the flights of a fleet share.
        """
        variant = self._starts.of(seed)
        if variant.parts.tables is not self._starts.base.parts.tables:
            raise refusal(self._name, "disperses the tables of the world, which a fleet shares")
        flight = SteppedFlight(variant.loaded, variant.parts, telemetry=False)
        roles, phase = variant.loaded.scenario.phase_roles, flight.running.fsw["mission"]["phase"]
        while roles[int(phase[0])] != role:
            if not flight.step(cycles=_LOOK):
                return None
        flies = flight.step(cycles=max(round(later_s / flight.cycle_s), 1))
        return Start.of(variant.parts, flight.running.snapshot()) if flies else None
