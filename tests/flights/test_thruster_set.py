"""An engine made of thrusters: what is shared out over them, what is refused, and landings on it."""

import numpy as np
import pytest
from given_functions import allocate

import edl6dof
from edl6dof.config.errors import ConfigError
from edl6dof.fsw.allocation.effectiveness import EFFECTIVENESS, update_effectiveness
from edl6dof.fsw.allocation.registry import ALLOCATION, DEMAND
from edl6dof.fsw.vehicle_state import HEALTH
from edl6dof.interface.capacities import MAX_THRUSTERS
from edl6dof.interface.effectors import ATTITUDE, AXIAL, FINE
from edl6dof.scenario.onboard import believe
from edl6dof.scenario.records import build_tables


@pytest.fixture(scope="module", params=["phoenix", "schiaparelli"])
def landed(request):
    overrides = ["sensors.inertial_unit.gyros.range_deg_s=400"] if request.param == "schiaparelli" else []
    return edl6dof.fly(request.param, overrides)


def test_landers_on_pulsed_engines_come_down_within_limits(landed):
    assert landed.success
    published = landed.scenario.published
    if landed.scenario.name == "phoenix":
        figure = "touchdown_vertical_m_s"
        assert landed.figures[figure] == pytest.approx(published[figure].value, abs=0.3)


def test_engine_thrust_is_the_axial_force_of_the_thrusters(landed):
    """As the valves were open, from the telemetry of each: off before ignition, on pulses after it."""
    log, scenario = landed.telemetry, landed.scenario
    axial = [jet for jet in scenario.vehicle.rcs.thrusters if jet.group == "axial"]
    given = sum(-jet.direction[0] * jet.thrust_n * log[f"rcs.{jet.name}"] for jet in axial)
    lit = (log["t_s"] > landed.figures["backshell_s"] + 3.0) & (log["t_s"] < landed.figures["touchdown_s"])
    shown = log["truth.engine_thrust_n"]
    assert shown[~lit & (log["t_s"] < landed.figures["backshell_s"])].max() == 0.0
    assert shown[lit].mean() == pytest.approx(given[lit].mean(), rel=0.02)
    assert np.count_nonzero(np.diff(shown[lit])) > 100


@pytest.mark.parametrize("torque", [(0.0, 0.0, 0.0), (0.0, 60.0, -40.0)])
def test_thrust_and_torque_are_shared_out_together(torque):
    loaded = edl6dof.load("phoenix")
    onboard = believe(loaded.scenario, build_tables(loaded.scenario))[0]
    effectiveness, demand, out = (np.zeros(1, kind)[0] for kind in (EFFECTIVENESS, DEMAND, ALLOCATION))
    bare = (1 << len(loaded.scenario.vehicle.parts)) - 1
    update_effectiveness(onboard["vehicle"], bare, np.zeros(MAX_THRUSTERS), effectiveness)
    demand["wrench"][0], demand["wrench"][3:] = -1700.0, torque
    demand["groups"] = 1 << AXIAL | 1 << ATTITUDE | 1 << FINE
    demand["boosting"] = 1
    count = onboard["vehicle"]["n_thrusters"]
    health = np.ones(1, HEALTH)[0]
    allocate(onboard["allocation"], onboard["vehicle"], health, effectiveness, demand, out)
    duty = out["duty"][:count]
    given = duty @ effectiveness["matrix"][:count]
    assert np.all((duty >= 0.0) & (duty <= 1.0))
    assert given[0] == pytest.approx(-1700.0, rel=0.05)
    assert given[3:] == pytest.approx(torque, abs=8.0)


@pytest.mark.parametrize(
    "change, said",
    [
        ("vehicle.engines.descent.full_thrust_n=4000", "must be what the axial thrusters give"),
        ("vehicle.rcs.thrusters=[]", "must be what the axial thrusters give"),
        ("flight_software.allocation.method=table", "does not steer"),
    ],
)
def test_what_does_not_fit_an_engine_of_thrusters_is_refused(change, said):
    with pytest.raises(ConfigError, match=said):
        edl6dof.load("phoenix", [change])
