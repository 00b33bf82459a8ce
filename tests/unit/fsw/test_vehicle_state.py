"""What the flight computer believes of its vehicle follows the events it commands, whatever their order."""

import numpy as np
import pytest

from edl6dof.fsw.mission import MISSION
from edl6dof.fsw.onboard import ONBOARD
from edl6dof.fsw.vehicle_state import VEHICLE_STATE, follow_events, share_thrust
from edl6dof.interface.capacities import MAX_ENGINES
from edl6dof.interface.effectors import ACTIONS, group_of

#: Full thrust, ends of the throttle band (N), specific impulse (s), shares by thrusters and along the axis of
#: two unlike engines.
LARGE, SMALL = (6000.0, 1200.0, 4000.0, 310.0, 0.0, 1.0), (1500.0, 300.0, 1500.0, 220.0, 0.0, 1.0)
BOTH = group_of((0, 1))
DO = (("ignite", 0), ("ignite", 1), ("cut_off", 0), ("cut_off", 1), ("ignite", BOTH), ("cut_off", BOTH))


class Computer:
    """A flight computer that believes in two engines and is told events by their action and component."""

    def __init__(self):
        self.vehicle, self.mission, self.state = (
            np.zeros(1, dtype)[0] for dtype in (ONBOARD["vehicle"], MISSION, VEHICLE_STATE)
        )
        self.vehicle["n_engines"], self.vehicle["engines"][:2] = 2, [LARGE, SMALL]
        self.mission["n_events"] = len(DO)
        for slot, (action, component) in zip(self.mission["events"], DO, strict=False):
            slot["action"], slot["component"] = ACTIONS.index(action), component

    def tell(self, *events):
        request = np.array([event in events for event in DO], dtype=np.int64)
        follow_events(self.vehicle, self.mission, 100.0, request, self.state)
        return self.state["engine"]

    def shares(self, thrust):
        command = np.full(MAX_ENGINES, np.nan)
        share_thrust(self.vehicle, thrust, self.state, command)
        return command[:2]


def test_the_throttle_band_is_that_of_the_engines_that_burn():
    computer = Computer()
    assert computer.tell(("ignite", 1)).tolist() == pytest.approx(SMALL)
    assert computer.tell(("ignite", 0)).tolist()[:3] == pytest.approx(np.add(LARGE, SMALL)[:3])
    assert computer.tell(("cut_off", 1)).tolist() == pytest.approx(LARGE)
    assert computer.state["ignited"] == 1
    assert computer.tell(("cut_off", 0)).tolist()[:4] == (0.0,) * 4
    assert computer.state["ignited"] == 0


def test_engines_together_use_what_each_uses():
    computer = Computer()
    both = computer.tell(("ignite", 0), ("ignite", 1))
    thrust = 3000.0
    own = computer.shares(thrust)
    assert own.sum() == pytest.approx(thrust)
    assert thrust / both["specific_impulse"] == pytest.approx(own[0] / LARGE[3] + own[1] / SMALL[3])


def test_an_engine_that_does_not_burn_is_asked_for_nothing():
    computer = Computer()
    computer.tell(("ignite", 1))
    assert computer.shares(9000.0).tolist() == [0.0, SMALL[0]]
    computer.tell(("cut_off", 1))
    assert computer.shares(9000.0).tolist() == [0.0, 0.0]


def test_engines_of_a_group_are_lit_and_cut_off_together():
    computer = Computer()
    assert computer.tell(("ignite", BOTH)).tolist()[:3] == pytest.approx(np.add(LARGE, SMALL)[:3])
    assert computer.tell(("cut_off", 0)).tolist() == pytest.approx(SMALL)
    computer.tell(("ignite", BOTH))
    assert computer.tell(("cut_off", BOTH)).tolist()[:4] == (0.0,) * 4


def test_a_canted_engine_gives_more_than_it_brings():
    """60 deg from the axis: half of its thrust counts, at half of its specific impulse."""
    computer = Computer()
    computer.vehicle["engines"][1] = (750.0, 150.0, 750.0, 110.0, 0.0, 0.5)
    both = computer.tell(("ignite", BOTH))
    own = computer.shares(3000.0)
    assert own[0] + 0.5 * own[1] == pytest.approx(3000.0)
    assert 3000.0 / both["specific_impulse"] == pytest.approx(own[0] / LARGE[3] + own[1] / 220.0)
    assert computer.shares(1e9)[1] == pytest.approx(1500.0)
