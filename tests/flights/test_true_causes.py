"""A flight that fails says what truly happened, in outcome, cause and timeline."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

import edl6dof
from edl6dof.config.dtype import duplicate
from edl6dof.sim.flight import fly, log_rows
from edl6dof.sim.outcome import FLYING, LANDED, outcome_of
from edl6dof.telemetry.channels import BRIEF

CUT_HIGH = "mission.phases.slow_descent.until.latest_s=3"
SMALL_TANK = "vehicle.tanks.main.mass_kg=80"


def event(flight, key):
    return next(one for one in flight.events if one["key"] == key)


def test_tank_that_runs_empty_is_told_before_the_crash():
    flight = edl6dof.fly("tianwen1", [SMALL_TANK])
    empty = event(flight, "propellant_exhausted")
    assert empty["name"] == "propellant exhausted"
    assert empty["t_s"] < event(flight, "touchdown")["t_s"] - 1.0
    t = empty["t_s"]
    down, over = (flight.figures[f"touchdown_{way}_m_s"] for way in ("vertical", "horizontal"))
    words = f"propellant exhausted at {t:.1f} s"
    # without thrust the phases go on: the ground is met in the last one that began before it
    begun = [one["key"] for one in flight.events if one["t_s"] < event(flight, "touchdown")["t_s"]]
    phase = [key for key in begun if key.startswith("phase.")][-1].removeprefix("phase.")
    assert flight.outcome == (
        f"crashed at {down:.1f} m/s vertical and {over:.1f} m/s horizontal speed in phase {phase}: {words}"
    )
    assert flight.cause == f"crashed in phase {phase}: propellant exhausted"
    before = flight.telemetry["t_s"] < t
    left = flight.telemetry["truth.propellant_kg"]
    assert left[before].min() > 0.0 >= left[~before].max()


def test_vehicle_without_propellant_has_none_to_exhaust():
    flight = edl6dof.fly("nesc/case06")
    assert math.isnan(flight.plant["exhausted_time"][0, 0])
    assert "propellant" not in flight.outcome


def test_engine_cut_off_high_above_the_ground_is_told():
    flight = edl6dof.fly("tianwen1", [CUT_HIGH])
    cut = event(flight, "cut_off")
    height = flight.telemetry.at(cut["t_s"], "truth.height_m")[0]
    assert height > 10.0
    words = f"engine cut off {height:.1f} m above the ground at {cut['t_s']:.1f} s"
    assert flight.outcome.startswith("crashed at ") and flight.outcome.endswith(words)
    assert flight.cause == "crashed in phase landed: engine cut off above the ground"


def test_crash_belongs_to_the_phase_that_met_the_ground():
    """Contact itself brings about the phase ``landed``."""
    flight = edl6dof.fly("tianwen1", ["limits.crash_speed_m_s=1"])
    assert flight.phase == "landed"
    assert flight.cause == "crashed in phase slow_descent"
    assert " in phase slow_descent" in flight.outcome


def test_vehicle_with_folded_legs_crashes_however_slow_and_says_why():
    late = [
        f"mission.phases.{phase}.events.landing_legs.when.value=900"
        for phase in ("parachute", "powered_deceleration")
    ]
    flight = edl6dof.fly("tianwen1", late)
    assert flight.figures["touchdown_vertical_m_s"] < flight.scenario.limits.crash_speed_m_s
    assert flight.cause == "crashed in phase slow_descent with its legs folded"


def test_speed_at_first_contact_decides_about_a_crash_and_not_what_the_legs_make_of_it():
    """Legs that throw the lander up again: it met the ground slowly, and then tips over.

    Levers of 35 to 50 m throw it over or not, as the pads happen to meet; those of 55 to 80 m all did.
    """
    flight = edl6dof.fly("tianwen1", ["vehicle.landing_gear.footpads_m.1.2=80"])
    assert flight.figures["touchdown_vertical_m_s"] < 3.0
    assert flight.cause == "tipped over in phase slow_descent"


def test_lander_that_is_off_the_ground_has_not_landed(nominal):
    case, plant, outputs = nominal.case, nominal.plant, duplicate(nominal.outputs)
    assert outcome_of(case[0], plant[0], outputs[0]) == LANDED
    outputs["pads"] = 0
    assert outcome_of(case[0], plant[0], outputs[0]) == FLYING


def test_time_limit_ends_a_flight_on_the_ground_too(nominal):
    limit = math.ceil(nominal.figures["touchdown_s"]) + 1.0
    flight = edl6dof.fly("tianwen1", [f"simulation.time_limit_s={limit}"])
    assert flight.outcome == "time limit in phase landed"


ICE = [
    "terrain.slope_deg=12",
    "vehicle.landing_gear.friction=0.02",
    "simulation.time_limit_s=560",
    "simulation.log_every=10",
]


def test_lander_that_slides_has_not_landed_and_the_time_limit_says_so():
    flight = edl6dof.fly("tianwen1", ICE)
    assert flight.cause == "time limit: still moving on the ground in phase landed"
    assert flight.time_s == pytest.approx(560.0) and flight.telemetry["truth.speed_m_s"][-1] > 1.0


@pytest.mark.parametrize("seed", range(2, 6))
def test_flight_that_landed_was_at_rest_for_as_long_as_its_scenario_says(seed):
    flight = edl6dof.fly("tianwen1_hazards", [f"seed={seed}"])
    assert flight.code == LANDED
    t = flight.telemetry["t_s"]
    last = t > flight.time_s - flight.scenario.simulation.rest_s + 1e-6
    rates = [flight.telemetry[f"truth.rate_{axis}_deg_s"][last] for axis in "pqr"]
    assert flight.telemetry["truth.speed_m_s"][last].max() <= 0.05
    assert np.sqrt(np.sum(np.square(rates), axis=0)).max() <= 1.0


LATE_FAULT = "faults=[{thruster: D7, kind: stuck_off, at: {phase: hazard_avoidance, plus_s: 2}}]"
EARLY_FAULT = "faults=[{thruster: D7, kind: stuck_off, at: {time_s: 60}}]"


@pytest.mark.parametrize(
    "limit", ["entry_load_g0=3", "entry_dynamic_pressure_pa=1000", "entry_heat_flux_w_cm2=5"]
)
def test_fault_after_a_limit_was_broken_is_not_blamed_for_it(limit):
    late, early = (edl6dof.fly("tianwen1", [f"limits.{limit}", fault]) for fault in (LATE_FAULT, EARLY_FAULT))
    assert "outside limits" in late.cause and "D7" not in late.cause
    assert early.cause.endswith("after D7 stuck off")


def test_distance_missed_at_mortar_fire_is_not_blamed_on_the_descent():
    """A site 60 km off, which open-loop entry knows nothing of."""
    missed = ["terrain.site_longitude_deg=111", "flight_software.guidance.entry.law=bank_profile"]
    flight = edl6dof.fly("tianwen1", [*missed, LATE_FAULT])
    assert flight.cause == "outside limits: distance from the landing site"


@pytest.mark.parametrize(("phase", "counts"), [("parachute", True), ("hazard_avoidance", False)])
def test_distance_that_the_descent_decides_is_not_blamed_on_faults_near_the_ground(phase, counts):
    """Dense air: the parachute opens 19 km high, so the landing 11 km off is decided under it."""
    fault = f"faults=[{{thruster: F1, kind: stuck_off, at: {{phase: {phase}, plus_s: 1}}}}]"
    flight = edl6dof.fly("tianwen1", ["truth={atmosphere.density_factor: 1.6}", fault])
    assert flight.cause == "outside limits: distance from the landing site" + " after F1 stuck off" * counts


@pytest.mark.parametrize(
    "sets",
    [
        [SMALL_TANK],
        pytest.param([CUT_HIGH], marks=pytest.mark.long),
        pytest.param(["vehicle.landing_gear.damping_n_s_m=1e12"], marks=pytest.mark.long),
    ],
)
def test_brief_telemetry_tells_the_same(sets):
    """A campaign's row, and its case flown again."""
    loaded = edl6dof.load("tianwen1", sets)
    whole, brief = fly(loaded), fly(loaded, log=np.zeros(log_rows(loaded), BRIEF))
    assert (brief.outcome, brief.cause, brief.time_s) == (whole.outcome, whole.cause, whole.time_s)
    assert json.dumps(brief.figures) == json.dumps(whole.figures)
    assert json.dumps(brief.events) == json.dumps(whole.events)


def test_what_happened_before_a_saved_state_has_no_figures(nominal):
    state = fly(nominal.loaded, save_at_s=440.0).saved
    flight = fly(nominal.loaded, start=state)
    assert flight.outcome == "landed within limits"
    assert "parachute_total_alpha_deg" not in flight.figures
    assert event(flight, "mortar")["altitude_m"] is None and event(flight, "mortar")["detail"] == ""
    assert event(flight, "touchdown")["altitude_m"] is not None
    assert flight.figures["peak_load_g0"] == nominal.figures["peak_load_g0"]
