"""edl6dof: a six-degree-of-freedom Mars entry, descent and landing flight simulator.

>>> import edl6dof
>>> flight = edl6dof.fly("tianwen1")
>>> flight.outcome
'landed within limits'
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from edl6dof.scenario.loading import LoadedScenario
    from edl6dof.sim.flight import Flight

__version__ = "0.1.0"
__all__ = ["fly", "load"]


def load(name_or_path: str | Path, overrides: Iterable[str] = (), trust: bool = False) -> LoadedScenario:
    """Read and validate a scenario file, or a shipped scenario by name.

    Args:
        name_or_path: ``"scenarios/tianwen1.yaml"`` or ``"tianwen1"``.
        overrides: texts ``"dotted.path=value"``.
        trust: whether plugins that the scenario of a run folder names may be loaded; those of any other
            scenario always are.

    Raises:
        edl6dof.config.errors.ConfigError: with every problem found, each with file, line and key.
    """
    from edl6dof.plugins import activate

    activate([name_or_path], trust)
    from edl6dof.scenario.loading import load_scenario

    return load_scenario(name_or_path, overrides)


def fly(scenario: LoadedScenario | str | Path, overrides: Iterable[str] = (), **options: Any) -> Flight:
    """Fly a scenario and return the flight; see :func:`edl6dof.sim.flight.fly` for the options."""
    # before the flight software is imported
    loaded = load(scenario, overrides) if isinstance(scenario, str | Path) else scenario
    from edl6dof.sim.flight import fly as fly_scenario

    return fly_scenario(loaded, **options)
