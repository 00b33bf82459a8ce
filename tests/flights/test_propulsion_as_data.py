"""Other engines and tanks by their YAML alone: a pulsed engine, two side by side, several tanks.

What each of them must do follows from sums and closed forms of its own, taken here in numpy.
"""

from __future__ import annotations

import json

import numpy as np
import pytest
from other_vehicle import at, event, phases, when
from scipy.spatial.transform import Rotation

import edl6dof
from edl6dof.vehicle.plant import PROPELLANT


def test_a_pulsed_engine_lands_on_full_pulses_of_the_thrust_that_is_asked_for(nominal):
    flight = edl6dof.fly("tianwen1", ["vehicle.engines.main.model=pulsed"])
    assert flight.outcome == "landed within limits"
    begin = next(one["t_s"] for one in flight.events if one["key"] == "phase.hover_imaging") + 1.0
    hover = [
        (one.telemetry["t_s"] > begin) & (one.telemetry["t_s"] < begin + 10.0) for one in (flight, nominal)
    ]
    thrust = flight.telemetry["truth.engine_thrust_n"][hover[0]]
    asked = nominal.telemetry["truth.engine_thrust_n"][hover[1]]
    assert thrust.max() > 0.8 * 7500.0 and thrust.min() < 0.1 * 7500.0
    assert np.ptp(asked) < 0.2 * 7500.0  # the throttled one holds a level
    assert thrust.mean() == pytest.approx(asked.mean(), rel=0.05)


# ---- two engines side by side ------------------------------------------------------------------

ARM_M = 0.3


def two_engines():
    main = edl6dof.load("tianwen1").scenario.vehicle.engines[0].model_dump(mode="json")
    halves = []
    for name, side in (("left", -1.0), ("right", 1.0)):
        half = {**main, "name": name, "group": "main", "nozzle_m": [-0.3, side * ARM_M, 0.0]}
        for key in ("full_thrust_n", "throttle_min_n", "throttle_max_n"):
            half[key] = main[key] / 2.0
        valve = main["throttled"]
        half["throttled"] = {**valve, **{key: valve[key] / 2.0 for key in ("rate_n_s", "start_rate_n_s")}}
        halves.append(half)
    return f"vehicle.engines={json.dumps(halves)}"


def test_two_engines_of_half_the_thrust_descend_as_one(nominal):
    flight = edl6dof.fly("tianwen1", [two_engines()])
    assert flight.figures["touchdown_s"] == pytest.approx(nominal.figures["touchdown_s"], abs=0.5)
    assert flight.figures["propellant_used_kg"] == pytest.approx(
        nominal.figures["propellant_used_kg"], abs=0.5
    )
    start = flight.figures["backshell_s"]
    for s in (1.5, 10.0, 25.0):
        thrust = [at(one, "truth.engine_thrust_n", start + s) for one in (flight, nominal)]
        assert thrust[0] == pytest.approx(thrust[1], rel=0.01)


def test_an_engine_that_is_cut_off_leaves_the_moment_of_the_other():
    def change(table):
        stop = event("failure", "cut_off", "left", when("phase_time_s", "above", 3.0))
        table["powered_deceleration"]["events"].append(stop)

    flight = edl6dof.fly("tianwen1", [two_engines(), phases(change)])
    t = next(one["t_s"] for one in flight.events if one["key"] == "failure")
    table, step = flight.telemetry, 0.6  # after the decay of one and the build-up of the other
    thrust = at(flight, "truth.engine_thrust_n", t + step)
    # r x F about the centre of mass, of a thrust along -x at y = ARM_M
    lever = ARM_M - at(flight, "truth.centre_y_m", t + step)
    before, after = (at(flight, "truth.disturbance_z_nm", s) for s in (t - 0.05, t + step))
    assert thrust > 500.0
    # no more is asked for than the other can give
    asked = table["guide.thrust_n"]
    rows = table["t_s"] > t + 0.2
    assert asked[rows].max() <= 3750.0 < asked[~rows].max()
    assert after - before == pytest.approx(lever * thrust, rel=0.1)
    assert np.all(np.isfinite(table["truth.disturbance_z_nm"]))


def test_a_fault_of_one_engine_leaves_the_other_all_its_thrust(nominal):
    """Forces and moments balance: the velocity lacks the share of one engine, which no longer turns it."""
    fault = (
        "faults=[{kind: engine_shortfall, engine: left, engine_shortfall: {thrust_factor: 0.7}, "
        "at: {phase: powered_deceleration, plus_s: 6}}]"
    )
    limit = f"simulation.time_limit_s={nominal.figures['backshell_s'] + 10.0}"
    flight = edl6dof.fly("tianwen1", [two_engines(), fault, limit])
    event = next(one for one in flight.events if one["key"] == "fault")
    assert event["name"] == "fault: left engine shortfall"
    table, t, span = flight.telemetry, event["t_s"], 0.2

    def mean_force(begin):
        """Force (N, I) over a short while, from velocity and mass, without that of the thrusters."""
        velocities = [
            np.array([at(flight, f"truth.v_I_{axis}_m_s", s) for axis in "xyz"])
            for s in (begin, begin + span)
        ]
        rows = (table["t_s"] > begin) & (table["t_s"] <= begin + span)
        gas = np.array([table[f"truth.rcs_force_{axis}_n"][rows].mean() for axis in "xyz"])
        return at(flight, "truth.mass_kg", begin) * (velocities[1] - velocities[0]) / span, gas

    # x of B points down, against the thrust; gravity and air are the same before and after
    (before, gas_before), (after, gas_after) = mean_force(t - span - 0.02), mean_force(t + 0.02)
    attitude = np.array([at(flight, f"truth.q_I2B_{part}", t) for part in "xyzw"])
    lost = Rotation.from_quat(attitude).inv().apply(after - before)[0] - (gas_after - gas_before)[0]
    share = 0.3 * at(flight, "truth.engine_thrust_n", t - 0.02) / 2.0
    assert lost == pytest.approx(share, rel=0.01)
    # r x F of what the left engine, at y = -ARM_M, no longer pushes along -x
    turned = at(flight, "truth.disturbance_z_nm", t + 0.04) - at(flight, "truth.disturbance_z_nm", t - 0.02)
    assert turned == pytest.approx(share * (ARM_M + at(flight, "truth.centre_y_m", t)), rel=0.01)


# ---- tanks -------------------------------------------------------------------------------------


def tanks(**loads):
    """Override: tanks of these loads (kg), all in the place of the one."""
    own = edl6dof.load("tianwen1").scenario.vehicle.tanks[0].model_dump(mode="json")
    whole = np.array(own["inertia_kg_m2"]) / own["mass_kg"]
    rows = [
        {**own, "name": name, "mass_kg": load, "inertia_kg_m2": (whole * load).tolist()}
        for name, load in loads.items()
    ]
    return f"vehicle.tanks={json.dumps(rows)}"


def test_tanks_that_share_a_place_fly_as_one(nominal):
    flight = edl6dof.fly("tianwen1", [tanks(front=120.0, aft=70.0)])
    assert flight.outcome == "landed within limits"
    for name in ("parachute_height_m", "backshell_height_m", "touchdown_s", "propellant_used_kg"):
        assert flight.figures[name] == pytest.approx(nominal.figures[name], rel=1e-2)
    left = flight.plant["y"][0, PROPELLANT : PROPELLANT + 2]
    assert left / (120.0, 70.0) == pytest.approx(
        np.full(2, 1.0 - flight.figures["propellant_used_kg"] / 190.0), rel=1e-9
    )
    # the first minute, before chaos: masses, truth and belief
    for column in ("truth.mass_kg", "nav.mass_kg", "truth.centre_y_m"):
        assert at(flight, column, 60.0) == pytest.approx(at(nominal, column, 60.0), rel=1e-9)


def test_thrusters_on_a_small_tank_of_their_own_starve_and_the_engine_does_not():
    scenario = edl6dof.load("tianwen1").scenario.vehicle
    own = [{**jet.model_dump(mode="json"), "draws_from": ["rcs"]} for jet in scenario.rcs.thrusters]
    flight = edl6dof.fly(
        "tianwen1",
        [
            tanks(main=180.0, rcs=10.0),
            f"vehicle.rcs.thrusters={json.dumps(own)}",
            "vehicle.engines.main.draws_from=[main]",
        ],
    )
    empty = next(one for one in flight.events if one["key"] == "propellant_exhausted")
    assert empty["name"] == "tank rcs empty"
    assert f"tank rcs empty at {empty['t_s']:.1f} s" in flight.outcome
    t, table = flight.telemetry["t_s"], flight.telemetry
    after = t > empty["t_s"] + 0.02
    jets = np.stack([table[f"rcs.{jet['name']}"] for jet in own])
    assert jets[:, ~after].max() == pytest.approx(1.0) and np.all(jets[:, after] == 0.0)
    assert table["truth.engine_thrust_n"][after].max() > 1000.0
    used = -np.diff(table["truth.propellant_kg"][after])
    assert used.min() >= 0.0 and used.sum() > 5.0
