"""Events of the state are located in time, carried out in order, and none is lost: against a fall, a steady
flow and a straight line in closed form.
"""

import numpy as np
import pytest

from edl6dof.scenario import records
from edl6dof.vehicle.motion.integrate import advance, clearance, until_riser_changes
from edl6dof.vehicle.motion.runge_kutta import evaluate
from edl6dof.vehicle.parachutes.parachute import EXTRACTING, INFLATING
from edl6dof.vehicle.plant import CANOPY_POSITION, CANOPY_VELOCITY, OUTPUTS, PROPELLANT, WORKSPACE
from edl6dof.verify.case import BARE, FLAT, ONE_BODY, VACUUM, WEIGHTLESS, scenes, state_of

G, STEP_S = 3.72, 0.01
FORCE_N, ISP_S = 100.0, 250.0
FLOW = 2.0 * FORCE_N / (ISP_S * 9.80665)
#: Two thrusters in one place against each other: propellant flows, and nothing moves.
_JET = "position_m: [-1, 0, 0], group: axial, minimum_pulse_s: 0.001, "
_JET += f"thrust_n: {FORCE_N}, specific_impulse_s: {ISP_S}"
_OPPOSED = f"{{name: B, direction: [-1, 0, 0], {_JET}}}"
SCENE = (
    *BARE,
    *VACUUM,
    *ONE_BODY,
    "vehicle.tanks=[{name: main, mass_kg: 190, centre_m: [-0.85, 0, 0]}]",
    f"vehicle.rcs.thrusters=[{{name: A, direction: [1, 0, 0], {_JET}}}, {_OPPOSED}]",
    "vehicle.mass.entry_centre_m=[-0.85, 0, 0]",
    "vehicle.rcs.branches=[]",
    "flight_software.check_out.thrusters=[]",
    "initial.altitude_m=500",
    "initial.speed_m_s=0",
    "initial.rate_deg_s=[0, 0, 0]",
)


PACK = (
    *WEIGHTLESS,
    "vehicle.parts.parachute_pack.mass_kg=38",
    "vehicle.parts.parachute_pack.centre_m=[-1, 0, 0]",
    "vehicle.parts.parachute_pack.inertia_kg_m2=[0, 0, 0]",
)


class Flown:
    """A vehicle without flight software, at rest at t = 0."""

    def __init__(self, *changes):
        _, loaded = scenes([*SCENE, *changes])
        tables = records.build_tables(loaded.truth)
        self.case, self.plant = records.build_case(loaded.truth, tables), state_of(loaded).plant
        self.outputs = np.zeros(1, OUTPUTS)
        self.arrays = self.case, tables, self.plant, self.outputs, np.zeros(1, WORKSPACE)
        self.plant["valves"]["level"][0, :2] = 1.0
        self.plant["valves"]["open_time"][0, :2], self.plant["valves"]["close_time"][0, :2] = -1.0, 1e9
        evaluate(*self)

    def __iter__(self):
        return (array[0] for array in self.arrays)

    def to(self, t_end, step=STEP_S):
        for k in range(round(t_end / step)):
            assert advance(*self, step * (k + 1))
        return self


@pytest.mark.parametrize("step", [0.01, pytest.param(0.05, marks=pytest.mark.long), 1.0])
def test_touchdown_is_that_of_a_fall(step):
    flown = Flown(*FLAT)
    height = clearance(flown.case[0], flown.plant[0], flown.outputs[0])
    assert 490.0 < height < 500.0
    # gravity falls off with the square of the distance: that at a sixth of the way counts
    fall = np.sqrt(2.0 * height / (G * (1e9 / (1e9 + 500.0 - height / 6.0)) ** 2))
    flown.to(20.0, step)
    assert flown.plant["touchdown_time"][0] == pytest.approx(fall, abs=2e-8)  # places resolve 1e-7 m


@pytest.mark.parametrize("step", [0.01, 0.05, 1.0])
def test_tank_runs_dry_when_its_mass_over_the_flow_says(step):
    flown = Flown(*WEIGHTLESS)
    flown.plant["y"][0, PROPELLANT] = 7.777 * FLOW
    flown.to(10.0, step)
    assert flown.plant["exhausted_time"][0, 0] == pytest.approx(7.777, abs=2e-9)
    assert flown.plant["y"][0, PROPELLANT] == 0.0
    assert flown.plant["inputs"]["rcs_flow"][0, 0] == 0.0


#: Two tanks in one place.
LOADS_KG = np.array([3.0, 1.0])
_PLACE = "centre_m: [-0.85, 0, 0]"
TWO_TANKS = f"vehicle.tanks=[{{name: a, mass_kg: 3, {_PLACE}}}, {{name: b, mass_kg: 1, {_PLACE}}}]"


def test_tanks_drawn_on_together_run_empty_together():
    flown = Flown(*WEIGHTLESS, TWO_TANKS)
    left = flown.plant["y"][0, PROPELLANT : PROPELLANT + 2]
    flown.to(20.0, 0.05)
    assert left == pytest.approx(LOADS_KG * (1.0 - 20.0 * FLOW / LOADS_KG.sum()), rel=1e-12)
    flown = Flown(*WEIGHTLESS, TWO_TANKS).to(60.0, 1.0)
    assert flown.plant["exhausted_time"][0, :2] == pytest.approx(LOADS_KG.sum() / FLOW, abs=3e-9)
    assert flown.plant["y"][0, PROPELLANT : PROPELLANT + 2].tolist() == [0.0, 0.0]


@pytest.mark.parametrize("step", [0.1, 1.0])
def test_an_empty_tank_starves_what_it_alone_feeds_and_the_others_give_all(step):
    """A draws on both tanks, B on the small one: that is empty first, B goes out, and A pushes alone on what
    is left in the other.
    """
    flown = Flown(*WEIGHTLESS, TWO_TANKS, "vehicle.rcs.thrusters.B.draws_from=[b]")
    start = flown.plant["y"][0, 3:6].copy()
    each, (a, b) = FLOW / 2.0, LOADS_KG
    b_empty = b / (each + b / (a + b) * each)
    a_empty = b_empty + (a - a / (a + b) * each * b_empty) / each
    flown.to(100.0, step)
    assert flown.plant["exhausted_time"][0, :2] == pytest.approx([a_empty, b_empty], abs=3e-9)
    mass = flown.case["vehicle"]["mass"]["entry"][0]
    gained = ISP_S * 9.80665 * np.log((mass - 2.0 * each * b_empty) / (mass - a - b))  # Tsiolkovsky
    assert flown.plant["y"][0, 3:6] - start == pytest.approx(thrust_axis(flown) * gained, rel=1e-9, abs=1e-9)
    assert flown.plant["valves"]["mean"][0, :2].tolist() == [0.0, 0.0]


def thrust_axis(flown):
    """Unit vector of +x of B in I."""
    w, x, y, z = flown.plant["y"][0, 6:10]
    return np.array([1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y)])


def test_line_stretch_is_that_of_a_straight_line():
    flown = Flown(*PACK)
    y, velocity = flown.plant["y"][0], np.array([29.0, 3.0, -2.0])
    y[CANOPY_POSITION : CANOPY_POSITION + 3] = y[0:3] + (1.0, 2.0, 0.5)
    y[CANOPY_VELOCITY : CANOPY_VELOCITY + 3] = y[3:6] + velocity
    flown.plant["canopy"] = EXTRACTING
    evaluate(*flown)
    length = flown.case["vehicle"]["parachutes"]["line_length"][0, 0]
    distance = length - until_riser_changes(flown.plant[0], flown.outputs[0])
    # |d + v t| = length, with d from two slacks
    later = Flown(*PACK)
    later.plant[:] = flown.plant
    evaluate(*later)
    later.to(0.1)
    then = length - until_riser_changes(later.plant[0], later.outputs[0])
    v2 = velocity @ velocity
    along = (then**2 - distance**2 - v2 * 0.01) / 0.2
    time = (-along + np.sqrt(along**2 - v2 * (distance**2 - length**2))) / v2
    flown.to(2.0)
    assert flown.plant["canopy"][0] == INFLATING
    assert flown.plant["line_stretch_time"][0, 0] == pytest.approx(time, abs=5e-9)


@pytest.fixture(scope="module")
def fall():
    """When the vehicle touches down."""
    return Flown(*FLAT).to(20.0, 0.01).plant["touchdown_time"][0]


@pytest.mark.parametrize(
    "apart",
    [
        -6e-3,
        pytest.param(-1e-6, marks=pytest.mark.long),
        pytest.param(-2e-9, marks=pytest.mark.long),
        0.0,
        2e-9,
        pytest.param(1e-6, marks=pytest.mark.long),
        pytest.param(5e-3, marks=pytest.mark.long),
    ],
)
def test_two_events_in_one_step_both_come_each_in_its_time(fall, apart):
    flown = Flown(*FLAT)
    flown.plant["y"][0, PROPELLANT] = (fall + apart) * FLOW
    evaluate(*flown)
    flown.to(20.0, 1.0)
    assert flown.plant["touchdown_time"][0] == pytest.approx(fall, abs=3e-9)
    assert flown.plant["exhausted_time"][0, 0] == pytest.approx(fall + apart, abs=3e-9)
    assert flown.plant["touched"][0] == 1


def test_event_that_has_come_already_is_not_lost():
    """Below the ground from the start, as when legs unfold into it."""
    flown = Flown(*FLAT, "initial.altitude_m=-1")
    flown.to(0.02)
    assert flown.plant["touched"][0] == 1 and flown.plant["touchdown_time"][0] <= STEP_S
