"""Faults of wing, parachute, riser, engine, throttle and tank at several moments: their physics, and an
outcome that names them.
"""

from __future__ import annotations

import numpy as np
import pytest

import edl6dof

#: Flight times (s) at which each begins; the mortar fires at 279.7 s, the backshell goes at 451 s, and
#: touchdown is at 536 s.
MOMENTS = {
    "wing_stuck": (0, 243, 250),
    "wing_lost": (100, 243, 260, 278),
    "parachute_delay": (0, 270),
    "parachute_dead": (0, 279),
    "canopy_torn": (0, 300, 440),
    "riser_torn": (0, 281, 400),
    "engine_shortfall": (0, 460, 500),
    "engine_dead": (0, 455, 480, 530),
    "ignition_delay": (0, 450),
    "engine_misaligned": (0, 460, 530),
    "throttle_stuck": (0, 455, 480, 530),
    "tank_leak": (0, 300, 480),
    "tank_blocked": (0, 300, 460, 530),
}


def flown(*faults, sets=()):
    return edl6dof.fly("tianwen1", [f"faults=[{', '.join(faults)}]", *sets])


#: One of each unit in the suite: wing, parachute, riser, engine, tank.
IN_SUITE = ("wing_lost", "parachute_dead", "riser_torn", "engine_dead", "tank_leak")


@pytest.mark.parametrize(
    ("kind", "time_s"),
    [
        pytest.param(
            kind,
            time_s,
            marks=[] if kind in IN_SUITE and time_s == times[-(number % 2)] else pytest.mark.long,
        )
        for number, (kind, times) in enumerate(MOMENTS.items())
        for time_s in times
    ],
)
def test_every_flight_ends_with_an_outcome_that_names_its_fault_and_keeps_its_telemetry(kind, time_s):
    flight = flown(f"{{kind: {kind}, at: {{time_s: {time_s}}}}}")
    words = kind.replace("_", " ")
    if flight.success:
        assert flight.outcome == "landed within limits"
    else:
        assert flight.outcome.endswith(f" {words} at {time_s:.1f} s"), flight.outcome
        assert flight.cause.endswith(f" {words}")
        assert flight.outcome.startswith(("crashed at ", "lost attitude in ", "landed outside limits ("))
    t = flight.telemetry["t_s"]
    assert t[0] == 0.0 and t[-1] == pytest.approx(flight.time_s, abs=0.03) and np.all(np.diff(t) > 0.0)


def test_lander_whose_throttle_stands_falls_lights_again_and_lands_on_what_it_gives():
    flight = flown("{kind: throttle_stuck, at: {phase: powered_deceleration, plus_s: 20}}")
    assert flight.success and flight.figures["touchdown_vertical_m_s"] < 2.0
    thrust, height = flight.telemetry["truth.engine_thrust_n"], flight.telemetry["truth.height_m"]
    held = float(flight.plant["thrust_held"][0, 0])
    last = height < 20.0
    assert thrust[last].max() == pytest.approx(held, rel=0.01) and held > 4000.0
    burnt = np.flatnonzero(np.diff((thrust > 100.0).astype(int)) == 1)
    assert len(burnt) == 2


@pytest.mark.parametrize("factor", [0.5, pytest.param(0.7, marks=pytest.mark.long)])
def test_torn_canopy_sinks_faster_by_the_root_of_the_drag_that_is_left(nominal, factor):
    """Steady descent: weight is drag; the share of the capsule stays."""
    flight = flown(
        f"{{kind: canopy_torn, canopy_torn: {{area_factor: {factor}}}, at: {{time_s: 0}}}}",
        sets=["simulation.time_limit_s=440"],
    )

    def sinks(one):
        table = one.telemetry
        i = np.argmax((table["guide.phase"] == 3) & (table["truth.height_m"] < 3000.0))
        return table["truth.v_down_m_s"][i]

    # 200 m2 at 0.640, and 9.1 m2 at about 1.4
    whole = 200.0 * 0.640
    lander = 9.1 * 1.4
    expected = np.sqrt((whole + lander) / (factor * whole + lander))
    assert sinks(flight) / sinks(nominal) == pytest.approx(expected, rel=0.05)


def test_torn_riser_leaves_no_tension_and_free_fall():
    flight = flown("{kind: riser_torn, at: {time_s: 400}}", sets=["simulation.time_limit_s=410"])
    table = flight.telemetry
    after = table["t_s"] > 400.05
    assert np.all(table["truth.riser_tension_n"][after] == 0.0)
    assert table["truth.riser_tension_n"][table["t_s"] < 399.9][-10:].min() > 1000.0
    fell = np.diff(table["truth.v_down_m_s"][after])[:5] / np.diff(table["t_s"][after])[:5]
    assert np.all(fell > 2.0)  # m/s2, of 3.7


def test_leak_empties_the_tank_at_its_rate(nominal):
    flight = flown(
        "{kind: tank_leak, tank_leak: {flow_kg_s: 0.25}, at: {time_s: 100}}",
        sets=["simulation.time_limit_s=250"],
    )
    t, left = flight.telemetry["t_s"], flight.telemetry["truth.propellant_kg"]
    sound = np.interp(t, nominal.telemetry["t_s"], nominal.telemetry["truth.propellant_kg"])
    # beside what the thrusters use, which differs by a little as the vehicle grows lighter
    assert np.interp(200.0, t, sound - left) == pytest.approx(25.0, abs=0.5)
    assert np.interp(240.0, t, flight.telemetry["truth.mass_kg"]) < np.interp(
        240.0, nominal.telemetry["t_s"], nominal.telemetry["truth.mass_kg"]
    )


def test_blocked_tank_gives_no_thrust_and_keeps_its_propellant():
    flight = flown("{kind: tank_blocked, at: {time_s: 460}}")
    table = flight.telemetry
    after = table["t_s"] > 461.0
    assert np.ptp(table["truth.propellant_kg"][after]) == 0.0 < table["truth.propellant_kg"][-1]
    assert table["truth.engine_thrust_n"][after].max() < 10.0
    assert max(table[f"rcs.{name}"][after].max() for name in flight.scenario.thruster_names) == 0.0


def test_dead_engine_gives_no_thrust_from_its_moment_on():
    flight = flown("{kind: engine_dead, at: {time_s: 480}}")
    thrust, t = flight.telemetry["truth.engine_thrust_n"], flight.telemetry["t_s"]
    assert thrust[t > 480.03].max() == 0.0 < thrust[(t > 470.0) & (t < 480.0)].min()


def test_turned_thrust_turns_the_vehicle_by_its_lever(nominal):
    """Thrust at the nozzle, 1 deg about y: its moment about the centre of mass is that of the side force."""
    flight = flown(
        "{kind: engine_misaligned, engine_misaligned: {turn_y_deg: 1.0}, at: {time_s: 470}}",
        sets=["simulation.time_limit_s=471"],
    )

    def at(one, name):
        return one.telemetry.at(470.04, name)[0]

    lever = at(flight, "truth.centre_x_m") - flight.scenario.vehicle.engines[0].nozzle_m[0]
    turned = at(flight, "truth.disturbance_y_nm") - at(nominal, "truth.disturbance_y_nm")
    expected = at(flight, "truth.engine_thrust_n") * np.sin(np.radians(1.0)) * abs(lever)
    assert abs(turned) == pytest.approx(expected, rel=0.02)


def test_late_engine_lights_late_and_lands(nominal):
    flight = flown("{kind: ignition_delay, ignition_delay: {delay_s: 2}, at: {time_s: 0}}")
    ignition = {one["key"]: one["t_s"] for one in flight.events}["ignition"]
    assert ignition == pytest.approx({one["key"]: one["t_s"] for one in nominal.events}["ignition"] + 2.0)
    assert flight.success, flight.outcome


# ---- what the phase table and guidance make of them --------------------------------------------------------


@pytest.mark.parametrize(
    "time_s",
    [281, 446, *(pytest.param(t, marks=pytest.mark.long) for t in (300, 350, 400, 415, 420, 430, 440))],
)
def test_lander_whose_riser_tears_leaves_early_and_comes_down_on_its_engine(time_s):
    """Far up it leaves the backshell at 4 km, faster than it was ever meant to; without that branch it met
    the ground at 85 to 160 m/s.
    """
    flight = flown(f"{{kind: riser_torn, at: {{time_s: {time_s}}}}}")
    assert flight.landed, flight.outcome
    assert flight.figures["touchdown_vertical_m_s"] < 3.0
    assert flight.figures["backshell_height_m"] < 4100.0
    # without a parachute the backshell falls near the lander, too close at the ground
    beyond = "at backshell release" if time_s < 410 else "least distance from backshell and canopy"
    assert flight.success or beyond in flight.cause
    straight_on = flown(
        f"{{kind: riser_torn, at: {{time_s: {time_s}}}}}", sets=["mission.phases.parachute.transitions=[]"]
    )
    assert straight_on.landed == (time_s >= 430)


@pytest.mark.parametrize("time_s", [460, *(pytest.param(t, marks=pytest.mark.long) for t in (0, 480, 500))])
def test_engine_with_a_fifth_of_its_thrust_gone_goes_back_to_full_level_and_lands(time_s):
    flight = flown(f"{{kind: engine_shortfall, at: {{time_s: {time_s}}}}}")
    assert flight.success, flight.outcome


def test_sound_flight_keeps_its_parachute_to_the_usual_height(nominal):
    assert nominal.figures["backshell_height_m"] == pytest.approx(1231.0, abs=10.0)


# ---- several faults ----------------------------------------------------------------------------------------


def test_propellant_that_two_open_thrusters_burnt_is_told_with_both():
    flight = flown(
        "{kind: stuck_on, thruster: A3, at: {time_s: 210}}",
        "{kind: stuck_on, thruster: A1, at: {time_s: 200}}",
        sets=["flight_software.diagnosis.enabled=false"],
    )
    empty = float(flight.plant["exhausted_time"][0][0])
    assert flight.outcome.endswith(
        f": propellant exhausted at {empty:.1f} s after A1 and A3 stuck on at 200.0 and 210.0 s"
    )
    assert flight.cause.endswith(": propellant exhausted after A1 and A3 stuck on")


def test_only_what_had_to_do_with_it_is_named():
    """Wing and mortar did no harm up to the deployment, and what fails after the end none at all."""
    flight = flown(
        "{kind: wing_lost, at: {time_s: 270}}",
        "{kind: parachute_dead, at: {time_s: 300}}",
        "{kind: engine_dead, at: {time_s: 480}}",
        "{kind: tank_leak, at: {time_s: 800}}",
    )
    assert flight.cause.endswith(" after main engine dead")


def test_faults_after_the_mortar_do_not_count_for_a_limit_at_the_mortar():
    at_mach = "quantity: mach, crosses: below, value: 1.8"
    flight = flown(
        "{kind: wing_lost, at: {time_s: 276}}",
        "{kind: stuck_off, thruster: F6, at: {time_s: 400}}",
        sets=[f"mission.phases.lift.transitions=[{{when: [{{{at_mach}}}], next: parachute}}]"],
    )
    assert flight.cause == ("outside limits: total angle of attack at mortar fire after trim_wing wing lost")


def test_order_of_the_sentence_is_that_of_time():
    flight = flown(
        "{kind: engine_dead, at: {time_s: 480}}",
        "{kind: stuck_off, thruster: D7, at: {time_s: 100}}",
        "{kind: canopy_torn, at: {time_s: 300}}",
    )
    assert flight.cause.endswith(" after D7 stuck off, main canopy torn and main engine dead")


def test_a_parachute_that_never_came_is_a_consequence_of_its_dead_mortar():
    flight = flown(
        "{kind: parachute_dead, at: {time_s: 100}}", sets=["mission.phases.parachute.transitions=[]"]
    )
    assert "no parachute deployed after main parachute dead at 100.0 s" in flight.outcome
    assert "mortar" not in {one["key"] for one in flight.events}
