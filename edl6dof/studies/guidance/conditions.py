"""What an entry meets that its guidance was not planned for: one thing at a time.

Every flight of a condition has its own waves of density, gusts and copies of the instruments.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from math import cos, radians, sin
from typing import Any

import numpy as np

from edl6dof.campaign.design.case import Case
from edl6dof.config.model_paths import value_at
from edl6dof.scenario.schema import Scenario
from edl6dof.sensors.ground_tracking import GroundTrackingParams
from edl6dof.studies.guidance.vehicles import ENTRY, SEED

Values = dict[str, Any]
#: What every flight has besides.
WAVES_AND_GUSTS: Values = {"atmosphere.perturbation.enabled": True, "wind.gust.enabled": True}

_ANGLE = "initial.flight_path_angle_deg"
_TRACKING, _NAVIGATION = "sensors.ground_tracking", "sensors.navigation_error"
_SLOW_DEG_S, _WIND_M_S = 5.0, 60.0
#: How much worse than believed the state is that the ground sends up.
_WORSE_TRACKING = 3.0


def _nothing(scenario: Scenario, flight: int) -> Values:
    return {}


def _density(factor: float, scenario: Scenario, flight: int) -> Values:
    return {"atmosphere.density_factor": factor}


def _entry_angle(more_deg: float, scenario: Scenario, flight: int) -> Values:
    return {_ANGLE: value_at(scenario, _ANGLE) + more_deg}


def _less_lift(scenario: Scenario, flight: int) -> Values:
    """A fifth of the lift-to-drag ratio gone: of a capsule by its centre of mass, a third of whose offset
    makes that of the trim angle.
    """
    rigid = scenario.dynamics == "six_dof"
    path = "vehicle.mass.entry_centre_m.2" if rigid else "vehicle.aero.lift_drag.lift_to_drag"
    return {path: (2.0 / 3.0 if rigid else 0.8) * value_at(scenario, path)}


def _wind(scenario: Scenario, flight: int) -> Values:
    """The same wind at all altitudes: from behind, from the right, from ahead and from the left, in turn."""
    towards = radians(value_at(scenario, "initial.azimuth_deg") + 90.0 * flight)
    return {
        "wind.model": "constant",
        "wind.constant.north_m_s": _WIND_M_S * cos(towards),
        "wind.constant.east_m_s": _WIND_M_S * sin(towards),
    }


def _slow_bank(scenario: Scenario, flight: int) -> Values:
    rigid = scenario.dynamics == "six_dof"
    vehicle = (
        "flight_software.control.bank_to_steer.bank.rate_deg_s" if rigid else "point_mass.bank_rate_deg_s"
    )
    return {f"{ENTRY}.bank_rate_deg_s": _SLOW_DEG_S, vehicle: _SLOW_DEG_S}


def _poor_navigation(scenario: Scenario, flight: int) -> Values:
    """Errors of the state that the ground sends up, three times those believed; a point mass has them all the
    way.
    """
    if scenario.dynamics == "six_dof":
        worse = _of_each_axis(_TRACKING, scenario.sensors.ground_tracking)
        return {path: _WORSE_TRACKING * sigma for path, sigma in worse}
    draws, sigmas = np.random.default_rng((SEED, flight)), _of_each_axis(_NAVIGATION, GroundTrackingParams())
    return {path: _WORSE_TRACKING * sigma * draws.standard_normal() for path, sigma in sigmas}


def _of_each_axis(section: str, tracking: GroundTrackingParams) -> Iterator[tuple[str, float]]:
    for axis in range(3):
        yield f"{section}.position_m.{axis}", tracking.position_m[axis]
        yield f"{section}.velocity_m_s.{axis}", tracking.velocity_m_s[axis]


def _navigation_with_errors(scenario: Scenario, flight: int) -> Values:
    return (
        {} if scenario.dynamics == "six_dof" else {"sensors.carried": ["perfect", "imu", "navigation_error"]}
    )


@dataclass(frozen=True)
class Condition:
    """One thing that is other than planned.

    Attributes:
        name: as it stands in the table.
        truth: what is so, of the scenario and the number of the flight, and the flight computer is not told.
        belief: what it is told.
    """

    name: str
    truth: Callable[[Scenario, int], Values] = _nothing
    belief: Callable[[Scenario, int], Values] = _nothing

    def case(self, index: int, scenario: Scenario, flight: int, label: Values) -> Case:
        """Case number ``index``: the condition's flight number ``flight``."""
        truth = {**WAVES_AND_GUSTS, **self.truth(scenario, flight)}
        told = self.belief(scenario, flight)
        return Case(index, truth, told, flight, {**label, "condition": self.name})


CONDITIONS = (
    Condition("nominal"),
    Condition("density -40 %", partial(_density, 0.6)),
    Condition("density +40 %", partial(_density, 1.4)),
    Condition("L/D -20 %", _less_lift),
    Condition("bank 5 deg/s", belief=_slow_bank),
    Condition("entry -0.3 deg", partial(_entry_angle, -0.3)),
    Condition("entry +0.3 deg", partial(_entry_angle, 0.3)),
    Condition("wind 60 m/s", _wind),
    Condition("navigation", _poor_navigation, _navigation_with_errors),
)
DISPERSED = "dispersed"
