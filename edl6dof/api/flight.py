"""Flights as objects of the API: flown, or read from the folder of a run."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import fields
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from edl6dof.api.flight_results import FlightResults
from edl6dof.config.errors import Named
from edl6dof.metrics.evaluation import Check
from edl6dof.metrics.figures import LIMITS
from edl6dof.runs.files import atomic_folder
from edl6dof.runs.run import Run, write_run
from edl6dof.scenario.loading import viewed_scenario
from edl6dof.sim import flight as sim
from edl6dof.sim.flight import attitude_at
from edl6dof.telemetry.columns import describe

if TYPE_CHECKING:
    from collections.abc import Mapping

    from pyquaternion import Quaternion

    from edl6dof.scenario.schema import Scenario
    from edl6dof.telemetry.landing_map import LandingMap

#: Name of the 3D replay in the folder of a run.
REPLAY = "replay.rrd"


class Flight(sim.Flight, FlightResults):
    """A flight flown by this process; :class:`edl6dof.sim.flight.Flight` describes its contents.

    Attributes:
        differences: columns that differ from the row of the case, if a case of a campaign was flown again.
        folder: folder to which it was saved last; ``None`` if it is in memory only.
    """

    differences: tuple[str, ...] = ()
    folder: Path | None = None

    @classmethod
    def of(cls, flight: sim.Flight) -> Flight:
        """Make an object of the API from a flight."""
        return cls(**{field.name: getattr(flight, field.name) for field in fields(flight)})

    def unit(self, name: str) -> str:
        """Return the printed unit of a channel."""
        return describe(name)[0]

    def meaning(self, name: str) -> str:
        """Return the meaning of a channel."""
        return describe(name)[1]

    def save(self, folder: str | Path, *, replay: bool = True, force: bool = False) -> Path:
        """Write the folder of a run, as ``edl6dof fly`` does.

        Raises:
            ConfigError: the folder exists and must not be replaced, or cannot be written.
        """
        with atomic_folder(Path(folder), "flight", force) as partial:
            self.write(partial, replay)
        self.folder = Path(folder)
        return self.folder

    def write(self, folder: Path, replay: bool = True, release: bool = False) -> None:
        """Write all files of a run into a folder that exists.

        Args:
            folder: folder of the run.
            replay: True to write the 3D replay.
            release: True to free the telemetry once it is written and keep only the results; the replay
                needs as much memory again.
        """
        write_run(self, folder)
        if self.saved is not None:
            self.saved.save(folder / "state.npz")
        if replay:
            from edl6dof.replay.recording import history, write_replay

            shown = history(self)
            if release:
                self.release_log()
            write_replay([shown], folder / REPLAY)


class RecordedFlight(FlightResults):
    """A flight that is read from the folder of a run; the hash of every file is checked before use.

    Attributes:
        folder: folder of the run.
        telemetry: columns by name, each read at its first use.
    """

    def __init__(self, folder: Path):
        self.folder, self._run = folder, Run(folder)

    @property
    def name(self) -> str:
        """Name of the scenario."""
        return self._run.name

    @property
    def outcome(self) -> str:
        """Outcome of the flight in words."""
        return self._run.summary["outcome"]

    @property
    def success(self) -> bool:
        """True if the flight reached the goal of the mission within all limits."""
        return self._run.summary["success"]

    @property
    def time_s(self) -> float:
        """Time at the end of the flight, s."""
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
        """Events in the order of time: mappings with ``t_s``, ``key``, ``name``, ``detail`` and the state."""
        return self._run.events

    @cached_property
    def metrics(self) -> Mapping[str, float | None]:
        """Figures by name with unit suffix; ``None`` for a figure that could not be computed."""
        return Named("figure", self._run.summary["figures"])

    @cached_property
    def checks(self) -> list[Check]:
        """Every limit with the value of this flight."""
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
        """Return the attitude at time ``t`` (s); see :meth:`edl6dof.sim.flight.Flight.attitude`."""
        return attitude_at(t, self["t_s"], [self[f"truth.q_I2B_{c}"] for c in "wxyz"])

    @property
    def landing_map(self) -> LandingMap | None:
        """Map of the ground from the scan of the lander, and the chosen spot; ``None`` without a scan."""
        return self._run.landing_map

    @cached_property
    def scenario(self) -> Scenario:
        """The resolved scenario, without parts that only a plugin defines."""
        return viewed_scenario(self.scenario_text, str(self.folder / "scenario.yaml")).scenario

    @property
    def scenario_text(self) -> str:
        """The resolved scenario as YAML."""
        return self._run.scenario_text

    def unit(self, name: str) -> str:
        """Return the printed unit of a channel."""
        return self._run.unit(name)

    def meaning(self, name: str) -> str:
        """Return the meaning of a channel."""
        return self._run.meaning(name)


def flown_into(
    folder: Path, fly: Callable[[], Flight], *, replay: bool, force: bool, release: bool = False
) -> Flight:
    """Fly and write the folder of the run, which is reserved before the flight; see :meth:`Flight.write`.

    Raises:
        ConfigError: the folder exists and must not be replaced, or cannot be written.
    """
    with atomic_folder(folder, "flight", force) as partial:
        flight = fly()
        flight.write(partial, replay, release)
    flight.folder = folder
    return flight
