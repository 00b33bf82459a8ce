"""A scenario as an object that prints its values, draws its vehicle, flies, and changes into another one.

This module imports no family of models, so that the plugins of a scenario can be loaded first.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from edl6dof.api.arguments import Overrides, named, naming_arguments, texts
from edl6dof.config.text_table import text_table
from edl6dof.config.units import split_unit
from edl6dof.scenario.loaded import LoadedScenario

if TYPE_CHECKING:
    from edl6dof.api.flight import Flight
    from edl6dof.api.plots import Plot
    from edl6dof.design.thruster_authority import Configuration
    from edl6dof.scenario.schema import Scenario as Values
    from edl6dof.sim.flight import Progress
    from edl6dof.vehicle.vehicle import VehicleParams

#: Values that a scenario prints; one that is not set, as of another kind of initial state, is left out.
MAIN_VALUES = (
    *("planet.name", "vehicle.name", "vehicle.mass.entry_kg", "dynamics"),
    *("initial.epoch_utc", "initial.altitude_m", "initial.height_above_areoid_m", "initial.latitude_deg"),
    *("initial.longitude_deg", "initial.speed_m_s", "initial.flight_path_angle_deg", "initial.azimuth_deg"),
    *("terrain.site_latitude_deg", "terrain.site_longitude_deg", "atmosphere.model", "wind.model"),
    *("sensors.set", "flight_software.navigation.filter", "flight_software.guidance.entry.law"),
    *("flight_software.guidance.powered.law", "mission.goal", "seed"),
)


class Scenario(LoadedScenario):
    """A validated scenario that can be printed, drawn, changed and flown. Every function that takes the name
    of a scenario also takes a ``Scenario``.

    >>> scenario = edl6dof.Scenario("tianwen1")
    >>> scenario["vehicle.mass.entry_kg"]
    1285.0
    >>> heavy = scenario.with_({"vehicle.mass.entry_kg": 1350.0})

    Args:
        name_or_path: file, name of a shipped scenario, or another scenario.
        overrides: changes as for :func:`edl6dof.load`.

    Attributes:
        source: file or name.
        overrides: changes of it, texts ``"dotted.path=value"``.

    Raises:
        ConfigError: lists every problem found with file, line and key, and suggests a correction.
        TypeError: an argument is of a wrong kind.
    """

    source: str
    overrides: tuple[str, ...]

    @naming_arguments()
    def __init__(self, name_or_path: str | Path | LoadedScenario, overrides: Overrides = ()):
        self.source, self.overrides = named(name_or_path, overrides)
        from edl6dof.plugins import activate

        activate([self.source])
        from edl6dof.scenario.loading import load_scenario

        loaded = load_scenario(self.source, self.overrides)
        super().__init__(loaded.scenario, loaded.truth, loaded.document)

    def __getitem__(self, path: str) -> Any:
        """Return the value, or the section as an object, at a dotted path, list items by index or by name.

        Raises:
            UnknownName: there is no such parameter; the message suggests a similar one.
        """
        from edl6dof.config.errors import UnknownName
        from edl6dof.config.model_paths import leaves, root_slot, walk

        slot = root_slot(type(self.scenario))
        try:
            keys, value = walk(self.scenario, path)
        except (AttributeError, LookupError, ValueError):
            keys, value = (path,), None
        for key in keys:
            if (inner := slot.child(key)) is None:
                raise UnknownName("parameter", path, [leaf[0] for leaf in leaves(self.scenario)])
            slot = inner
        return value

    def with_(self, *changes: str | Overrides) -> Scenario:
        """Return another scenario with changes, which are checked at once.

        Args:
            changes: texts ``"dotted.path=value"``, or mappings as for :func:`edl6dof.load`.

        Raises:
            ConfigError: lists every mistake of the changes.
            TypeError: a change is of a wrong kind.
        """
        return Scenario(
            self, [text for one in changes for text in texts([one] if isinstance(one, str) else one)]
        )

    def show(self, path: str = "") -> None:
        """Print values with unit, bounds, status, meaning, file and line, as ``edl6dof show`` does.

        Args:
            path: dotted path from which downwards values are printed, or a part of their paths.

        Raises:
            ConfigError: there is no such parameter.
        """
        from edl6dof.config.parameter_table import values
        from edl6dof.report.parameters import print_values, selected

        table = list(values(self.scenario, self.document))
        print_values(selected(table, path, f"edl6dof show {self.source}"))

    @cached_property
    def vehicle(self) -> Vehicle:
        """The vehicle."""
        return Vehicle(self.scenario)

    @naming_arguments()
    def fly(
        self,
        *,
        out: str | Path | None = None,
        replay: bool = True,
        force: bool = False,
        save_at_s: float | None = None,
        progress: Progress | None = None,
    ) -> Flight:
        """Fly the scenario; see :func:`edl6dof.fly`."""
        from edl6dof.api.flight import fly_loaded

        return fly_loaded(self, out, replay=replay, force=force, save_at_s=save_at_s, progress=progress)

    @naming_arguments()
    def save(self, path: str | Path, *, force: bool = False) -> None:
        """Write the scenario with every default as YAML; sections of campaigns are not included.

        Raises:
            ConfigError: the file exists and must not be replaced, or cannot be written.
        """
        from edl6dof.runs.files import atomic_file
        from edl6dof.sim.flight_state import resolved_text

        with atomic_file(Path(path), force) as partial:
            partial.write_text(resolved_text(self), encoding="utf-8")

    def __repr__(self) -> str:
        """Name, description, main values, changes and warnings."""
        changes = [f"changed: {text}" for text in self.overrides]
        warnings = [f"warning: {text}" for text in self.warnings]
        return "\n".join([self._title, text_table(self._rows, right=(1,)), *changes, *warnings])

    def _repr_html_(self) -> str:
        """The same, for notebooks."""
        from html import escape

        from edl6dof.api.flight import html_table

        notes = "".join(f"<p>{escape(text)}</p>" for text in (*self.overrides, *self.warnings))
        table = html_table(("parameter", "value", "unit"), self._rows)
        return f"<div><p>{escape(self._title)}</p>{table}{notes}</div>"

    @property
    def _title(self) -> str:
        return f"{self.scenario.name}: {self.scenario.description}".removesuffix(": ")

    @property
    def _rows(self) -> list[tuple[str, str, str]]:
        found = {path: self[path] for path in MAIN_VALUES}
        return [
            (path, str(value), split_unit(path)[1].label)
            for path, value in found.items()
            if value not in (None, "")
        ]


@dataclass(frozen=True, repr=False)
class Vehicle:
    """The vehicle of a scenario, which prints and draws.

    Attributes:
        scenario: values of the scenario.
    """

    scenario: Values

    @property
    def params(self) -> VehicleParams:
        """Its parameters."""
        return self.scenario.vehicle

    @cached_property
    def authority(self) -> list[Configuration]:
        """Control authority of each thruster group: at entry, and without the aeroshell."""
        from edl6dof.design.thruster_authority import configurations

        return configurations(self.params)

    @naming_arguments()
    def draw(self, path: str | Path | None = None, *, force: bool = False) -> Plot:
        """Draw top and side view, as ``edl6dof show --vehicle`` does.

        Args:
            path: picture to write: .svg, .png or .pdf; by default nothing is written.
            force: True to replace an existing file.

        Raises:
            ConfigError: the vehicle is a point mass, or the file cannot be written.
        """
        from edl6dof.api.plots import Plot
        from edl6dof.config.errors import refusal
        from edl6dof.report.vehicle_drawing import vehicle_figure
        from edl6dof.runs.files import atomic_file

        if self.scenario.dynamics == "point_mass":
            raise refusal(self.scenario.name, "has no shape to draw: its dynamics are those of a point mass")
        target = None if path is None else Path(path)
        if target is not None and target.suffix not in (".svg", ".png", ".pdf"):
            raise refusal(target, "must end in .svg, .png, .pdf")
        plot = Plot.of(vehicle_figure(self.params, self.authority))
        if target is not None:
            with atomic_file(target, force) as partial:
                plot.save(partial)
        return plot

    def __repr__(self) -> str:
        from edl6dof.design.thruster_authority import groups_of
        from edl6dof.scenario.unusual import radius_m

        params = self.params
        groups = {name: len(jets) for name, jets in groups_of(params).items() if name != "all"}
        rows = [
            ("entry mass", f"{params.mass.entry_kg:g} kg"),
            ("diameter", f"{2.0 * radius_m(params):.3g} m"),
            ("thrusters", ", ".join(f"{count} {name}" for name, count in groups.items())),
            *(
                (kind, ", ".join(item.name for item in items))
                for kind, items in (
                    ("engines", params.engines),
                    ("tanks", params.tanks),
                    ("parachutes", params.parachutes),
                    ("parts", params.parts),
                )
            ),
        ]
        return f"{params.name}\n{text_table(row for row in rows if row[1])}"
