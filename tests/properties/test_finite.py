"""Whatever valid vehicle in whatever state: the derivatives are finite numbers.

Vehicles are drawn inside the bounds of the scenario file (those the file refuses are not counted), states far
beyond what a flight meets: from below the ground to orbit, from rest to 20 km/s, any attitude, 20 rad/s, with
the canopy packed, in tow, open or gone.
"""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from edl6dof.config.errors import ConfigError
from edl6dof.scenario import records
from edl6dof.scenario.loading import load_scenario
from edl6dof.sim.loop import prepare
from edl6dof.vehicle.motion.runge_kutta import evaluate
from edl6dof.vehicle.plant import (
    CANOPY_POSITION,
    CANOPY_VELOCITY,
    OUTPUTS,
    PROPELLANT,
    STATES,
    STATES_VEHICLE,
    THRUST,
    WORKSPACE,
)

LIMITS = settings(max_examples=8, deadline=None, derandomize=True)
MANY = settings(LIMITS, max_examples=25)
STATES_EACH = 20


def number(low, high):
    return st.floats(low, high, allow_nan=False, allow_infinity=False)


VEHICLE = st.fixed_dictionaries(
    {
        "vehicle.aero.model": st.sampled_from(["capsule", "constant", "none"]),
        "vehicle.mass.entry_kg": number(700.0, 5000.0),
        "vehicle.aero.capsule.axial_factor": number(0.01, 10.0),
        "vehicle.aero.capsule.moment_factor": number(-10.0, 10.0),
        "vehicle.aero.capsule.damping_factor": number(-10.0, 10.0),
        "vehicle.aero.constant.drag_coefficient": number(0.0, 10.0),
        "vehicle.parachutes.main.diameter_m": number(0.1, 60.0),
        "vehicle.parachutes.main.trim_angle_deg": number(0.0, 30.0),
        "vehicle.parachutes.main.disk_gap_band.inflation_exponent": number(0.1, 10.0),
        "vehicle.parachutes.main.apparent_mass_factor": number(0.0, 5.0),
        "vehicle.engines.main.misalignment_y_deg": number(-5.0, 5.0),
        "vehicle.surfaces.trim_wing.normal_tilt_deg": number(-89.0, 89.0),
        "atmosphere.model": st.sampled_from(["table", "exponential", "us76", "none"]),
        "planet.gravity.model": st.sampled_from(["harmonics", "j2", "central", "none"]),
        "wind.model": st.sampled_from(["table", "constant", "none"]),
    }
)


def disturb(plant, rng):
    """A random state, and a random stage of the mission."""
    y = plant["y"][0]
    place = rng.normal(size=3)
    radius = 3.39e6 + rng.choice([-5e3, 0.0, 1e3, 2e4, 1.3e5, 5e6])
    y[0:3] = radius * place / np.linalg.norm(place)
    y[3:6] = rng.normal(size=3) * rng.choice([0.0, 1e-9, 1.0, 500.0, 1e4])
    q = rng.normal(size=4)
    y[6:10] = q / np.linalg.norm(q)
    y[10:13] = rng.normal(size=3) * rng.choice([0.0, 0.1, 20.0])
    y[PROPELLANT], y[THRUST] = rng.choice([0.0, 1e-12, 50.0, 190.0]), rng.choice([0.0, 1500.0, 7500.0])
    y[CANOPY_POSITION : CANOPY_POSITION + 3] = y[0:3] + rng.normal(size=3) * rng.choice([0.0, 1.0, 30.0, 1e4])
    y[CANOPY_VELOCITY : CANOPY_VELOCITY + 3] = y[3:6] + rng.normal(size=3) * rng.choice([0.0, 30.0])
    plant["attached"][0] = rng.integers(0, 2, plant["attached"].shape[1])
    plant["canopy"], plant["running"], plant["legs"], plant["touched"] = (
        rng.integers(0, 4),
        *rng.integers(0, 2, 3),
    )
    plant["line_stretch_time"], plant["wing_start"] = (
        rng.choice([-100.0, -0.1, 0.0, np.nan]),
        rng.choice([-5.0, -0.3, 1e99]),
    )


def assert_finite(drawn, seed):
    """Of one vehicle, in many states."""
    try:
        loaded = load_scenario("tianwen1", [f"{path}={value}" for path, value in drawn.items()])
    except ConfigError:
        assume(False)
    tables = records.build_tables(loaded.truth)
    case, rng = records.build_case(loaded.truth, tables), np.random.default_rng(seed)
    outputs, work = np.zeros(1, OUTPUTS), np.zeros(1, WORKSPACE)
    for _ in range(STATES_EACH):
        plant = records.initial_plant(loaded.truth, case)
        disturb(plant, rng)
        prepare(case, plant)
        evaluate(case[0], tables[0], plant[0], outputs[0], work[0])
        out = work["k"][0, 0]
        live = STATES if plant["canopy"][0] in (1, 2) else STATES_VEHICLE
        assert np.all(np.isfinite(out[:live])), (drawn, plant["y"][0].tolist(), out.tolist())


@LIMITS
@given(VEHICLE, st.integers(0, 2**32 - 1))
def test_derivatives_are_finite(drawn, seed):
    assert_finite(drawn, seed)


@pytest.mark.long
@MANY
@given(VEHICLE, st.integers(0, 2**32 - 1))
def test_derivatives_of_many_vehicles_are_finite(drawn, seed):
    assert_finite(drawn, seed)
