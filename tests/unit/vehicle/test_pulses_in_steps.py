"""A body pushed and turned by thruster pulses at random places in the steps of the integrator, against the
plane motion of the same body integrated by scipy from knee to knee of the thrust.

The mean of the thrust over each step in its place errs by up to 2e-5 m and 3e-5 rad.
"""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from edl6dof.scenario import records
from edl6dof.vehicle.motion.integrate import advance
from edl6dof.vehicle.motion.runge_kutta import evaluate
from edl6dof.vehicle.plant import ATTITUDE, OUTPUTS, POSITION, WORKSPACE
from edl6dof.verify.case import BARE, ONE_BODY, VACUUM, WEIGHTLESS, scenes, state_of

THRUST, ISP, RISE, DECAY, ARM, G0 = 250.0, 270.0, 0.012, 0.019, 1.15, 9.80665
CYCLE, PULSES = 0.08, 60
_JET = "group: axial, position_m: [-2, 0, 0], minimum_pulse_s: 0.001"
_VALVE = f"thrust_n: {THRUST}, specific_impulse_s: {ISP}, rise_s: {RISE}, decay_s: {DECAY}"
SCENE = (
    *BARE,
    *VACUUM,
    *WEIGHTLESS,
    *ONE_BODY,
    "vehicle.mass.entry_centre_m=[-0.85, 0, 0]",
    "vehicle.tanks=[{name: main, mass_kg: 190, centre_m: [-0.85, 0, 0]}]",
    f"vehicle.rcs.thrusters=[{{name: up, direction: [0, 0, 1], {_JET}, {_VALVE}}}, "
    f"{{name: down, direction: [0, 0, -1], {_JET}, {_VALVE}}}]",
    "vehicle.rcs.branches=[]",
    "flight_software.check_out.thrusters=[]",
    "initial.speed_m_s=0",
    "initial.rate_deg_s=[0, 0, 0]",
)


def pulse_trains(seed):
    """When each pulse opens and shuts, up and down in turn."""
    rng = np.random.default_rng(seed)
    opens = CYCLE * np.arange(PULSES) + rng.uniform(0.0, 0.019, PULSES)
    return opens, opens + rng.uniform(RISE, 0.04, PULSES)


def flown(step, opens, closes):
    """Distance (m) and angle (rad) from the start after the pulses, and mass and moment of inertia before."""
    _, loaded = scenes(SCENE)
    tables = records.build_tables(loaded.truth)
    case, plant = records.build_case(loaded.truth, tables), state_of(loaded).plant
    body = (case[0], tables[0], plant[0], np.zeros(1, OUTPUTS)[0], np.zeros(1, WORKSPACE)[0])
    evaluate(*body)
    y0, mass, inertia = plant["y"][0].copy(), float(body[3]["mass"]), float(body[3]["inertia"][1])
    for k in range(PULSES):
        valve = k % 2
        plant["valves"]["open_time"][0, valve], plant["valves"]["close_time"][0, valve] = opens[k], closes[k]
        for j in range(round(CYCLE / step)):
            advance(*body, k * CYCLE + (j + 1) * step)
    y = plant["y"][0]
    turned = abs(np.dot(y[ATTITUDE : ATTITUDE + 4], y0[ATTITUDE : ATTITUDE + 4]))
    moved = y[POSITION : POSITION + 3] - y0[POSITION : POSITION + 3]
    moved = moved - PULSES * CYCLE * y0[POSITION + 3 : POSITION + 6]
    return np.linalg.norm(moved), 2.0 * np.arccos(min(turned, 1.0)), mass, inertia


def in_the_plane(opens, closes, mass, inertia):
    """The same by scipy: x, z, their rates, angle, its rate and mass, between the knees of the thrust."""
    knees = np.concatenate([opens, opens + RISE, closes, closes + DECAY])
    cuts = np.unique(np.concatenate([[0.0, PULSES * CYCLE], knees]))

    def level(t):
        each = np.clip(np.minimum((t - opens) / RISE, 1.0 - (t - closes) / DECAY), 0.0, 1.0)
        return np.sum(each[::2]), np.sum(each[1::2])

    def rates(t, y):
        up, down = level(t)
        push = THRUST * (up - down) / y[6]
        turn = THRUST * (up - down) * ARM / inertia
        flow = THRUST * (up + down) / (ISP * G0)
        return [y[2], y[3], push * np.sin(y[4]), push * np.cos(y[4]), y[5], turn, -flow]

    y = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, mass])
    for begin, end in zip(cuts, cuts[1:], strict=False):
        y = solve_ivp(rates, (begin, end), y, "DOP853", rtol=1e-10, atol=1e-12).y[:, -1]
    return np.hypot(y[0], y[1]), abs(y[4])


@pytest.mark.parametrize("seed", [0, *(pytest.param(n, marks=pytest.mark.long) for n in range(1, 3))])
def test_a_pulse_moves_and_turns_by_its_place_in_the_step(seed):
    opens, closes = pulse_trains(seed)
    distance, angle, mass, inertia = flown(0.02, opens, closes)
    expected = in_the_plane(opens, closes, mass, inertia)
    assert distance == pytest.approx(expected[0], abs=1e-7)
    assert angle == pytest.approx(expected[1], abs=1e-11)
