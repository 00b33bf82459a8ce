"""The noncentral part of gravitation is held over a step: what that costs, against scipy with it at every
evaluation.
"""

import numpy as np
import pytest
from plain_python import integrate, setting

from edl6dof.sim.flight import fly
from edl6dof.verify.case import VACUUM, scenes, state_of

SECONDS = 60.0


@pytest.mark.parametrize(
    "degree", [pytest.param(2, marks=pytest.mark.long), pytest.param(4, marks=pytest.mark.long), 12]
)
def test_holding_the_noncentral_part_over_a_step_displaces_by_less_than_a_micrometre_in_a_minute(degree):
    """At 4.8 km/s and 125 km, tumbling; the field without it displaces by metres."""
    changes = ("mission.phases=[]", "wind.model=none", *VACUUM, f"planet.gravity.degree={degree}")
    _, loaded = scenes([*changes, f"simulation.time_limit_s={SECONDS}"])
    start = state_of(loaded)
    flown = fly(loaded, start=start).plant["y"][0]
    best = integrate(setting(loaded, start), SECONDS, 1e-13)["y"]
    assert np.linalg.norm(flown[:3] - best[:3]) < 1e-6
    assert np.linalg.norm(flown[3:6] - best[3:6]) < 1e-7

    _, central = scenes([*changes, f"simulation.time_limit_s={SECONDS}", "planet.gravity.model=central"])
    assert np.linalg.norm(fly(central, start=start).plant["y"][0, :3] - best[:3]) > 1.0
