"""One flight: flown, or read from its files."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from edl6dof.api.overrides import Overrides, texts
from edl6dof.api.results import FlightResults
from edl6dof.config.errors import Named
from edl6dof.metrics.evaluation import Check
from edl6dof.metrics.figures import LIMITS
from edl6dof.runs.run import Run
from edl6dof.scenario.loading import LoadedScenario
from edl6dof.sim import flight as sim
from edl6dof.sim.checkpoint import State
from edl6dof.sim.flight import attitude_at
from edl6dof.telemetry.columns import describe

if TYPE_CHECKING:
    from collections.abc import Mapping

    from pyquaternion import Quaternion

    from edl6dof.scenario.records import Records


class Flight(sim.Flight, FlightResults):
    """A flight that has been flown here; see :class:`edl6dof.sim.flight.Flight` for all it holds.

    Attributes:
        differences: of a case of a campaign flown again: columns in which it is not as its row.
        folder: where it was saved last; ``None`` of one that is in memory only.
    """

    differences: tuple[str, ...] = ()
    folder: Path | None = None

    @classmethod
    def of(cls, flight: sim.Flight) -> Flight:
        """The same flight with all that can be asked of it."""
        return cls(**{field.name: getattr(flight, field.name) for field in fields(flight)})

    def unit(self, name: str) -> str:
        """Printed unit of a channel."""
        return describe(name)[0]

    def meaning(self, name: str) -> str:
        """What a channel means."""
        return describe(name)[1]

    def save(self, folder: str | Path, *, replay: bool = True, force: bool = False) -> Path:
        """Write the folder of a run, as ``edl6dof fly`` does.

        Raises:
            ConfigError: there is something already that must not be replaced, or it cannot be written.
        """
        from edl6dof.api.run_files import write_files
        from edl6dof.runs.folder import atomic_folder

        with atomic_folder(Path(folder), "flight", force) as partial:
            write_files(self, partial, replay)
        self.folder = Path(folder)
        return self.folder


class RecordedFlight(FlightResults):
    """A flight read from the folder of a run; every file is compared with its hash before it is used.

    Attributes:
        folder: of the run.
        telemetry: columns by name, read when they are asked for.
    """

    def __init__(self, folder: Path):
        self.folder, self._run = folder, Run(folder)

    @property
    def name(self) -> str:
        """Name of the scenario."""
        return self._run.name

    @property
    def outcome(self) -> str:
        """How it ended, in words."""
        return self._run.summary["outcome"]

    @property
    def success(self) -> bool:
        """Whether it reached the goal of the mission within all limits."""
        return self._run.summary["success"]

    @property
    def time_s(self) -> float:
        """When it ended, s."""
        return self._run.summary["time_s"]

    @property
    def phase(self) -> str:
        """Name of the last phase."""
        return self._run.summary["phase"]

    @property
    def phase_names(self) -> list[str]:
        """Names of the mission phases; ``guide.phase`` is the index."""
        return self._run.phase_names

    @property
    def telemetry(self) -> Mapping[str, np.ndarray]:
        """Columns by name, each shape (rows,), in the unit of the name's suffix."""
        return self._run

    @property
    def events(self) -> Sequence[Mapping[str, Any]]:
        """The timeline: mappings with ``t_s``, ``key``, ``name``, ``detail`` and the state then."""
        return self._run.events

    @cached_property
    def metrics(self) -> Mapping[str, float | None]:
        """Figures by name with unit suffix; ``None`` for what could not be formed."""
        return Named("figure", self._run.summary["figures"])

    @cached_property
    def checks(self) -> list[Check]:
        """Every limit with this flight's value."""
        names = {figure.meaning: figure.name for figure in LIMITS}
        return [
            Check(
                names.get(limit["name"], ""),
                limit["name"],
                float("nan") if limit["value"] is None else limit["value"],
                limit["limit"],
                limit["unit"],
            )
            for limit in self._run.summary["limits"]
        ]

    def attitude(self, t: float) -> Quaternion:
        """Attitude at time ``t`` (s); see :meth:`edl6dof.sim.flight.Flight.attitude`."""
        return attitude_at(t, self["t_s"], [self[f"truth.q_I2B_{c}"] for c in "wxyz"])

    @property
    def scenario_text(self) -> str:
        """The resolved scenario as YAML."""
        return self._run.scenario_text

    def unit(self, name: str) -> str:
        """Printed unit of a channel."""
        return self._run.unit(name)

    def meaning(self, name: str) -> str:
        """What a channel means."""
        return self._run.meaning(name)


def fly(
    loaded: LoadedScenario,
    *,
    start: State | None = None,
    save_at_s: float | None = None,
    progress: sim.Progress | None = None,
    parts: Records | None = None,
    log: np.ndarray | None = None,
) -> Flight:
    """Fly a scenario to its end; see :func:`edl6dof.sim.flight.fly` for the arguments."""
    return Flight.of(
        sim.fly(loaded, start=start, save_at_s=save_at_s, progress=progress, parts=parts, log=log)
    )


def continued(state: str | Path | State, overrides: Overrides) -> tuple[LoadedScenario, State]:
    """The scenario that a saved state brings with it, and the state.

    Raises:
        ConfigError: it is no saved state, or an override is wrong.
    """
    found = state if isinstance(state, State) else State.load(Path(state))
    return sim.continue_from(found, texts(overrides)), found
