"""edl6dof: a six-degree-of-freedom Mars entry, descent and landing flight simulator.

>>> import edl6dof
>>> flight = edl6dof.fly("tianwen1")
>>> flight.outcome
'landed within limits'

Each command of the command line has a function here that returns its result as an object; see docs/python.md.
"""

# ruff: noqa: E402  the current folder leaves the path before anything is imported

from __future__ import annotations

import sys

_STARTED_HERE = sys.argv[:1] == ["-m"] and "edl6dof" in sys.orig_argv and not sys.flags.safe_path
if _STARTED_HERE and __path__[0].removesuffix("edl6dof")[:-1] != sys.path[0]:
    del sys.path[0]  # the current folder, of ``python -m edl6dof``: it may contain another person's yaml.py

from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING, Any

from edl6dof.api.functions import (
    assure,
    calibrate,
    campaign,
    faults,
    fly,
    load,
    margins,
    open_run,
    rare,
    refly,
    replay,
    report,
    verify,
)

if TYPE_CHECKING:
    from edl6dof.api.campaign import CampaignResult
    from edl6dof.api.flight import Flight, RecordedFlight
    from edl6dof.api.live import live
    from edl6dof.api.scenario import Scenario, Vehicle
    from edl6dof.api.simulation import Simulation
    from edl6dof.campaign.design.case import Case
    from edl6dof.campaign.executor import fly_rows
    from edl6dof.config.errors import ConfigError
    from edl6dof.scenario.loaded import LoadedScenario
    from edl6dof.sim.checkpoint import State

__version__ = "0.1.0"
__all__ = [
    "CampaignResult",
    "Case",
    "ConfigError",
    "Flight",
    "LoadedScenario",
    "RecordedFlight",
    "Scenario",
    "Simulation",
    "State",
    "Vehicle",
    "assure",
    "calibrate",
    "campaign",
    "faults",
    "fly",
    "fly_rows",
    "live",
    "load",
    "margins",
    "open_run",
    "rare",
    "refly",
    "replay",
    "report",
    "verify",
]

#: Modules of the names that are loaded at their first use.
_MODULES = {
    "CampaignResult": "edl6dof.api.campaign",
    "Case": "edl6dof.campaign.design.case",
    "ConfigError": "edl6dof.config.errors",
    "Flight": "edl6dof.api.flight",
    "LoadedScenario": "edl6dof.scenario.loaded",
    "RecordedFlight": "edl6dof.api.flight",
    "Scenario": "edl6dof.api.scenario",
    "Simulation": "edl6dof.api.simulation",
    "State": "edl6dof.sim.checkpoint",
    "Vehicle": "edl6dof.api.scenario",
    "fly_rows": "edl6dof.campaign.executor",
    "live": "edl6dof.api.live",
}

for _function in (
    campaign,
    replay,
    report,
    verify,
):  # importing a package of this name would replace the function
    _package = import_module(f"edl6dof.{_function.__name__}")
    _package.__class__ = type("Package", (ModuleType,), {"__call__": staticmethod(_function)})
    vars(_package).update(__doc__=_function.__doc__, __wrapped__=_function)


def __getattr__(name: str) -> Any:
    if name in _MODULES:
        return getattr(import_module(_MODULES[name]), name)
    raise AttributeError(f"module 'edl6dof' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
