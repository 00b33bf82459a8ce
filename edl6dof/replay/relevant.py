"""Which telemetry says something of a flight: not that of engines, tanks or thrusters that a vehicle has
none of, nor that of flight software where none flies.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from edl6dof.scenario.schema import Scenario

#: What columns are of, by how their names begin.
_ABOUT = {
    "truth.engine_thrust": "engines",
    "guide.thrust": "engines",
    "guide.time_to_go": "engines",
    "truth.propellant": "tanks",
    "truth.riser": "parachutes",
    "control.": "thrusters",
    "estimate.": "thrusters",
    "diagnosis.": "thrusters",
    "guide.": "phases",
    "nav.": "phases",
}


def relevant(names: Iterable[str], scenario: Scenario) -> tuple[str, ...]:
    """Those telemetry columns that are of something which flies."""
    vehicle = scenario.vehicle
    flies = {
        "engines": vehicle.engines,
        "tanks": vehicle.tanks,
        "parachutes": vehicle.parachutes,
        "thrusters": vehicle.rcs.thrusters,
        "phases": scenario.mission.phases,
    }
    absent = tuple(start for start, about in _ABOUT.items() if not flies[about])
    return tuple(name for name in names if not name.startswith(absent))
