"""The claim tried: errors given before the flight, the law and two constant bank angles, with free lift and
with the vehicle's.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import cos, radians

import numpy as np

from edl6dof.scenario.loading import load_scenario
from edl6dof.studies.lu_bayard.drag_model import Adapted, Design
from edl6dof.studies.lu_bayard.free_lift import Errors, fly_free
from edl6dof.studies.lu_bayard.settings import AS_PRINTED, FLOWN, SCENARIO, setting_of

ERRORS = {
    "no error": Errors(),
    "density +-5 %": Errors(density=0.05),
    "head wind 30 m/s": Errors(wind_m_s=30.0),
    "lift 10 % low": Errors(lift=-0.1),
    "all three": Errors(0.05, 30.0, -0.1),
}
SETTINGS = {"as printed": AS_PRINTED, "flown": FLOWN}
#: What steers, in the order of the columns.
FREE, LIMITED = "law, free lift", "law, own lift"
BANKS = {"bank 20 deg": 20.0, "bank 100 deg": 100.0}


@dataclass(frozen=True)
class Trial:
    """One flight: settings of the bound, errors, what steers, the response, and its inputs over L/D."""

    settings: str
    errors: str
    steering: str
    design: Design
    response: Adapted
    effort: np.ndarray

    @property
    def ratio(self) -> float:
        """Error energy over the bound."""
        return self.response.over_bound(self.design)


def all_trials(step: Callable[[], None]) -> tuple[Trial, ...]:
    """Every setting with every error under everything that steers; ``step`` is called after each."""
    found = []
    for settings, overrides in SETTINGS.items():
        loaded = load_scenario(SCENARIO, overrides)
        setting = setting_of(loaded)
        full = float(setting.onboard[0]["vehicle"]["lift_to_drag"])
        ways: dict[str, dict[str, float]] = {FREE: {}, LIMITED: {"limit": full}}
        ways |= {name: {"constant": full * cos(radians(bank))} for name, bank in BANKS.items()}
        for errors, values in ERRORS.items():
            for steering, way in ways.items():
                response, inputs = fly_free(setting, values, **way)
                found.append(Trial(settings, errors, steering, setting.design, response, inputs / full))
                step()
    return tuple(found)
