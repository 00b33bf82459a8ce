"""A flight with all that can be asked of it: flown, or read from the folder of its run."""

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
from edl6dof.runs.folder import atomic_folder
from edl6dof.runs.run import Run
from edl6dof.runs.run_files import write_run
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
        """Meaning of a channel."""
        return describe(name)[1]

    def save(self, folder: str | Path, *, replay: bool = True, force: bool = False) -> Path:
        """Write the folder of a run, as ``edl6dof fly`` does.

        Raises:
            ConfigError: there is something already that must not be replaced, or it cannot be written.
        """
        with atomic_folder(Path(folder), "flight", force) as partial:
            self.write(partial, replay)
        self.folder = Path(folder)
        return self.folder

    def write(self, folder: Path, replay: bool = True, release: bool = False) -> None:
        """Write all files of a run into a folder that exists.

        Args:
            folder: where to.
            replay: whether to write the 3D replay.
            release: whether the flight may let its telemetry go, once it is written, and keep its results
                only: the replay takes as much memory again.
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
        """True if it reached the goal of the mission within all limits."""
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
    def landing_map(self) -> LandingMap | None:
        """The ground as the lander saw it, and the spot it chose; ``None`` without a scan."""
        return self._run.landing_map

    @cached_property
    def scenario(self) -> Scenario:
        """The resolved scenario, as far as the package itself knows it."""
        return viewed_scenario(self.scenario_text, str(self.folder / "scenario.yaml")).scenario

    @property
    def scenario_text(self) -> str:
        """The resolved scenario as YAML."""
        return self._run.scenario_text

    def unit(self, name: str) -> str:
        """Printed unit of a channel."""
        return self._run.unit(name)

    def meaning(self, name: str) -> str:
        """Meaning of a channel."""
        return self._run.meaning(name)


def flown_into(
    folder: Path, fly: Callable[[], Flight], *, replay: bool, force: bool, release: bool = False
) -> Flight:
    """Fly, and write the folder of the run, which is claimed before; see :meth:`Flight.write`.

    Raises:
        ConfigError: there is something already that must not be replaced, or it cannot be written.
    """
    with atomic_folder(folder, "flight", force) as partial:
        flight = fly()
        flight.write(partial, replay, release)
    flight.folder = folder
    return flight
