"""What has left the vehicle falls as scipy's integrator says, and rests on the ground."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import edl6dof
from edl6dof.environment.gravity import central
from edl6dof.scenario import records
from edl6dof.vehicle.motion.staging import step_part
from edl6dof.vehicle.plant import INPUTS, LOOSE, RESTING
from edl6dof.vehicle.surroundings import noncentral_I, planet_rotation, surroundings

STEP_S = 0.02
AREOID = np.zeros(4)


@pytest.fixture(scope="module")
def mars():
    loaded = edl6dof.load("tianwen1")
    tables = records.build_tables(loaded.truth)
    case = records.build_case(loaded.truth, tables)
    return case[0], tables[0], records.initial_plant(loaded.truth, case)


def ground_at(altitude):
    """What is held over a step: ground at an altitude (m), on an areoid that is the ellipsoid."""
    inputs = np.zeros(1, INPUTS)[0]
    inputs["ground_altitude"] = altitude
    return inputs


def falling(mars, height, speed, drag_area):
    """A part of 100 kg moving level, eastwards in inertial axes, at ``height`` (m) above the landing site's
    latitude.
    """
    _, _, plant = mars
    part = plant[0]["debris"][0]
    out = (3.396e6 + height) * np.array([np.cos(0.43), 0.0, np.sin(0.43)])
    part["active"], part["mass"], part["drag_area"] = LOOSE, 100.0, drag_area
    part["r_I"], part["v_I"] = out, (-0.2 * speed, 240.0 + speed, 0.0)
    return part


@pytest.mark.parametrize(
    ("speed", "drag_area"), [(100.0, 9.0), pytest.param(60.0, 130.0, marks=pytest.mark.long)]
)
def test_fall_agrees_with_scipy_within_a_centimetre_in_position(mars, speed, drag_area):
    """A heat shield, and a backshell under its canopy, for 30 s from 6 km."""
    case, tables, _ = mars
    part = falling(mars, 6000.0, speed, drag_area)
    planet = case["planet"]

    def motion(t, y):
        rotation, r = planet_rotation(planet, t), tuple(y[:3])
        _, gas, _, air = surroundings(case, tables, AREOID, rotation, r)
        g = np.add(central(planet["gravity"], r), noncentral_I(planet, rotation, r))
        v = y[3:] - np.array(air)
        return np.concatenate([y[3:], g - 0.5 * gas[0] * np.linalg.norm(v) * v * drag_area / 100.0])

    span = 30.0
    start = np.concatenate([part["r_I"], part["v_I"]])
    best = solve_ivp(motion, (0.0, span), start, rtol=1e-11, atol=1e-9, method="DOP853").y[:, -1]
    inputs = ground_at(-9000.0)
    for k in range(round(span / STEP_S)):
        step_part(case, tables, inputs, part, k * STEP_S, STEP_S)
    assert np.linalg.norm(part["r_I"] - best[:3]) < 0.01
    assert np.linalg.norm(part["v_I"] - best[3:]) < 0.01


def test_on_the_ground_a_part_turns_with_the_planet(mars):
    case, tables, _ = mars
    part = falling(mars, 0.0, 50.0, 9.0)
    step_part(case, tables, ground_at(1e5), part, 0.0, STEP_S)
    assert part["active"] == RESTING
    before, hour = np.array(part["r_I"]), 3600.0
    step_part(case, tables, ground_at(1e5), part, STEP_S, hour)
    turned = np.arctan2(part["r_I"][1], part["r_I"][0]) - np.arctan2(before[1], before[0])
    assert turned == pytest.approx(case["planet"]["rotation_rate"] * hour, rel=1e-9)
    assert np.linalg.norm(part["r_I"]) == pytest.approx(np.linalg.norm(before), rel=1e-12)
