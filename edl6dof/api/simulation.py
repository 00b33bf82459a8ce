"""Flights step by step, with seeds: one of any scenario, or many dispersed ones in parallel."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from edl6dof.api.arguments import named, naming_arguments, texts
from edl6dof.api.flight import Flight
from edl6dof.api.functions import activate, load
from edl6dof.campaign.design.case import Case, Variant, Variants
from edl6dof.campaign.design.plan import Plan, plan_of
from edl6dof.config.document.source import read_document, resolve_scenario
from edl6dof.config.errors import refusal
from edl6dof.config.units import split_unit
from edl6dof.metrics.evaluation import checks
from edl6dof.metrics.record_figures import touchdown_state, touchdown_terrain_figures
from edl6dof.scenario.loaded import LoadedScenario
from edl6dof.scenario.loading import CAMPAIGN_SECTIONS, load_scenario
from edl6dof.scenario.schema import LimitParams
from edl6dof.sim import fleet as sim
from edl6dof.sim.commands import ESTIMATE
from edl6dof.sim.fleet import Start
from edl6dof.sim.outcome import FLYING, LANDED
from edl6dof.sim.simulation import SteppedFlight

#: Cases that a seed can draw: those of a campaign that samples at random and has no end.
_ENDLESS = 2**31
#: Base cycles between two checks of the phase.
_LOOK = 5


class Starts:
    """Initial conditions of flights by seed.

    For a scenario, the seed selects the random profiles.  For a campaign, it is the number of a case of a
    campaign that samples at random: the flight with seed N is row N of ``--sampling monte_carlo``.

    Args:
        scenario: file, name, or a loaded scenario.
        overrides: changes of the scenario, as for :func:`edl6dof.load`.
        faults: faults of a campaign that replace its own; each flight has one of them, all equally likely.
    """

    def __init__(
        self,
        scenario: str | Path | LoadedScenario,
        overrides: Iterable[str] | Mapping[str, Any] = (),
        faults: Sequence[Mapping[str, Any]] = (),
    ):
        self._plan: Plan | None = None
        if isinstance(scenario, LoadedScenario):
            self.loaded = load(scenario, overrides) if overrides else scenario
            return
        document = read_document(resolve_scenario(named(scenario)[0]))
        if isinstance(campaign := document.data.get(CAMPAIGN_SECTIONS[0]), dict):
            if faults:
                campaign["faults"] = [{"chance": 1.0, "one_of": [dict(fault) for fault in faults]}]
            plan = plan_of(document, texts(overrides), cases=1, sampling="monte_carlo")
            endless = plan.campaign and plan.campaign.model_copy(update={"cases": _ENDLESS})
            self._plan, self.loaded = replace(plan, campaign=endless), plan.loaded
        else:
            self.loaded = load_scenario(scenario, texts(overrides))

    @property
    def base(self) -> Variant:
        """The scenario itself, and its records."""
        return self._variants.nominal

    def of(self, seed: int | None) -> Variant:
        """Return the flight of a seed (0 or more), or without a seed the scenario unchanged.

        Raises:
            ConfigError: a value that was drawn is not allowed.
        """
        if seed is None:
            return self.base
        if self._plan is None:
            return self._variants.build(Case(0, belief={"seed": seed}))
        return self._variants.build(next(self._plan.cases(seed, seed + 1)))

    @cached_property
    def _variants(self) -> Variants:
        return Variants(self.loaded)


class Simulation(SteppedFlight):
    """A flight flown step by step; commands may replace the output of any part of the flight software.

    >>> simulation = edl6dof.Simulation("tianwen1")
    >>> while simulation.step():
    ...     pass
    >>> simulation.flight().outcome
    'landed within limits'

    Args:
        scenario: file, name of a shipped one, or the result of :func:`edl6dof.load`; if the file has a
            ``campaign`` section, :meth:`reset` draws its dispersions.
        overrides: changes of the scenario, as for :func:`edl6dof.load`.
        telemetry: True to record telemetry, which :meth:`flight` needs.

    Raises:
        ConfigError: the scenario is wrong.
        TypeError: an argument is of a wrong kind.
    """

    def __init__(
        self,
        scenario: str | Path | LoadedScenario,
        overrides: Iterable[str] | Mapping[str, Any] = (),
        *,
        telemetry: bool = True,
    ):
        activate(scenario)
        with naming_arguments():
            self._starts = Starts(scenario, overrides)
        base = self._starts.base
        super().__init__(base.loaded, base.parts, telemetry)

    def __repr__(self) -> str:
        stands = f"in phase {self.phase}" if self.flying else self.outcome
        return f"<Simulation {self.loaded.scenario.name}: {stands} at t = {self.time_s:.2f} s>"

    def reset(self, seed: int | None = None) -> dict[str, Any]:
        """Go back to the start and return the observation there.

        Args:
            seed: 0 or more; for a scenario the seed of its random profiles, for a campaign the number of a
                randomly drawn case.  Without a seed the scenario is unchanged.

        Raises:
            ConfigError: a value that was drawn is not allowed.
        """
        start = self._starts.of(seed)
        self._begin(start.loaded, start.parts)
        return self.look_ahead()

    def flight(self) -> Flight:
        """Return the flight so far; see :meth:`SteppedFlight.flight`."""
        return Flight.of(super().flight())


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


class DispersedFlights(Starts):
    """Flights of a campaign by their seeds, flown by the flight software up to a phase."""

    def fleet(self, count: int, workers: int = 1) -> Fleet:
        """Make a fleet with places for a number of flights, which :meth:`Fleet.put` starts."""
        return Fleet(count, self.base.parts.tables, self.loaded.scenario.steps_per_cycle, workers)

    def at_phase(self, seed: int, role: str, later_s: float = 0.0) -> Start | None:
        """Fly a case of the campaign up to a phase, and return its state as the start of a flight of a fleet.

        Args:
            seed: seed of the case.
            role: role of the phase, such as ``hover_imaging``; the flight is looked at every few cycles.
            later_s: time after the start of the phase, s; at least one cycle is flown.

        Returns:
            the start, or ``None`` if the flight ends before this time.

        Raises:
            ConfigError: the campaign disperses tables of air or ground. All flights of a fleet share these
                tables, so that they must be the same for every seed.
        """
        variant = self.of(seed)
        if variant.parts.tables is not self.base.parts.tables:
            raise refusal(self.loaded.scenario.name, "disperses tables of the world, which a fleet shares")
        flight = SteppedFlight(variant.loaded, variant.parts, telemetry=False)
        roles, phase = variant.loaded.scenario.phase_roles, flight.running.fsw["mission"]["phase"]
        while roles[int(phase[0])] != role:
            if not flight.step(cycles=_LOOK):
                return None
        flies = flight.step(cycles=max(round(later_s / flight.cycle_s), 1))
        return Start.of(variant.parts, flight.running.snapshot()) if flies else None


#: Commands of more than one number, or of none: how many; those left out have one.
_SIZES = {"thrust_n": 3, "torque_nm": 3, "safe_spot_m": 2, "coarse_spot_m": 2}


def described(simulation: Simulation) -> dict[str, Any]:
    """The scenario, and everything that can be observed and commanded in it."""
    from edl6dof import __version__

    scenario = simulation.loaded.scenario
    thrusters = scenario.thruster_names
    return {
        "version": __version__,
        "scenario": scenario.name,
        "cycle_s": simulation.cycle_s,
        "phases": list(scenario.phase_names),
        "thrusters": list(thrusters),
        "observations": {name: _kind(name, value) for name, value in simulation.observe().items()},
        "commands": {name: _command(name, len(thrusters)) for name in simulation.commands},
    }


def _kind(name: str, value: Any) -> dict[str, Any]:
    kinds = {bool: "true or false", int: "whole number"}
    return _described(name, np.shape(value), kinds.get(type(value), "number"))


def _command(name: str, thrusters: int) -> dict[str, Any]:
    if name == "estimate":
        return {"type": "map", "of": {part: _numbers(part, size) for part, (_, size) in ESTIMATE.items()}}
    if name == "isolate":
        return _described(name, (), "names of thrusters")
    return _numbers(name, thrusters if name == "duties" else _SIZES.get(name, 1))


def _numbers(name: str, size: int) -> dict[str, Any]:
    return _described(name, () if size == 1 else (size,))


def _described(name: str, shape: Sequence[int], kind: str = "number") -> dict[str, Any]:
    """Type, shape and unit of an observation or a command."""
    return {"type": kind, "shape": list(shape), "unit": split_unit(name)[1].label}
