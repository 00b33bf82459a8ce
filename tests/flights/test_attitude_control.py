"""Verifies: what the attitude control promises in flight (Hu et al. 2022, sections 4 and 6).

Bank reversal at peak dynamic pressure, trim-wing failure, roll in the powered descent.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import edl6dof
from edl6dof.interface.roles import LIFT
from edl6dof.scenario.records import build_onboard
from edl6dof.sim.checkpoint import State
from edl6dof.sim.flight import continue_from, fly
from edl6dof.telemetry.timeline import first_times

PERTURBED = ["atmosphere.perturbation.enabled=true", "wind.gust.enabled=true"]
HELD_BANK = ["mission.phases.lift.guidance=hold_bank", "flight_software.guidance.entry.preset_bank_deg=60"]


@pytest.fixture(scope="module")
def reversal():
    """A bank held at 60 deg whose command changes sign 3 s before peak dynamic pressure: (time, bank error,
    flight).
    """
    scouted = edl6dof.fly("tianwen1", [*HELD_BANK, "simulation.time_limit_s=180"]).telemetry
    peak = scouted["t_s"][np.argmax(scouted["truth.dynamic_pressure_pa"])]
    saved = edl6dof.fly("tianwen1", HELD_BANK, save_at_s=peak - 3.0).saved
    saved.fsw["guide"]["bank"] *= -1.0
    saved.fsw["own"]["bank"] *= -1.0  # what guidance holds
    flight = fly(continue_from(saved, (f"simulation.time_limit_s={peak + 12.0}",)), start=saved)
    table = flight.telemetry
    goal = np.degrees(saved.fsw["guide"]["bank"][0])
    return table["t_s"] - table["t_s"][0], np.sign(goal) * (table["truth.bank_deg"] - goal), flight


def test_bank_reversal_of_120_degrees_at_peak_dynamic_pressure_settles_within_nine_seconds(reversal):
    t, error, flight = reversal
    assert error[0] == pytest.approx(-120.0, abs=0.5)
    assert flight.telemetry["truth.dynamic_pressure_pa"].max() > 5000.0
    assert t[np.flatnonzero(np.abs(error) > 1.0)[-1]] < 9.0
    assert np.max(error) < 3.0


def test_reversal_takes_the_time_of_its_rate_limit(reversal):
    """120 deg at 20 deg/s with the spin-up lag 1/k of the rate loop and the parabola down to the PID zone;
    see test_zones.
    """
    t, error, flight = reversal
    bank = flight.scenario.flight_software.control.bank_to_steer.bank
    inner = bank.proportional / bank.derivative * bank.near_deg
    parabola = (bank.rate_deg_s - inner) / bank.deceleration_deg_s2
    start = bank.near_deg + (bank.rate_deg_s**2 - inner**2) / (2.0 * bank.deceleration_deg_s2)
    predicted = (120.0 - start) / bank.rate_deg_s + parabola
    assert t[np.argmax(np.abs(error) < bank.near_deg)] == pytest.approx(predicted, abs=0.25)
    assert np.max(np.abs(flight.telemetry["truth.rate_p_deg_s"])) < 1.02 * bank.rate_deg_s


def test_angle_of_attack_and_sideslip_stay_put_in_a_reversal(reversal):
    """The velocity-frame control (S1 eq. 1) banks about the velocity: it does not drive sideslip."""
    table = reversal[2].telemetry
    assert np.max(np.abs(table["truth.beta_deg"])) < 1.0
    assert np.ptp(table["truth.alpha_deg"]) < 2.0


# ---- a failed trim wing, and a guard on the total angle of attack ------------------------------------------

STUCK = "{kind: wing_stuck, at: {time_s: 0}}"


def with_wing_fault(fault, *changes):
    return edl6dof.fly("tianwen1", [f"faults=[{fault}]", *changes])


def branched_s(flight):
    """Time from the command of the trim wing to the branch, s; none if it was not taken."""
    times = first_times(flight.events)
    return times["phase.alpha_held"] - times["trim_wing"] if "phase.alpha_held" in times else None


@pytest.mark.parametrize(
    "fault, after_s",
    [
        pytest.param(STUCK, 2.0, id="stuck"),
        pytest.param(
            "{kind: wing_stuck, wing_stuck: {opening: 0.9}, at: {time_s: 0}}",
            2.0,
            id="partly",
            marks=pytest.mark.long,
        ),
        pytest.param(
            "{kind: wing_lost, at: {phase: lift, plus_s: 1}}", 2.0, id="lost", marks=pytest.mark.long
        ),
        pytest.param("{kind: wing_lost, at: {time_s: 250}}", None, id="lost once open"),
    ],
)
def test_a_wing_that_is_not_open_two_seconds_after_its_command_is_a_branch(fault, after_s):
    flight = with_wing_fault(fault)
    if after_s is None:
        after_s = 250.0 - flight.figures["trim_wing_s"]
    assert branched_s(flight) == pytest.approx(after_s, abs=0.03)
    branch, after = (flight.phase_names.index(name) for name in ("alpha_held", "parachute"))
    flown = flight.telemetry["guide.phase"]
    assert list(dict.fromkeys(flown))[1:4] == [branch - 1, branch, after]
    # by the flight computer's own air, which is not that of the day
    believed = flight.telemetry.at(flight.figures["parachute_s"], "nav.mach")[0]
    assert believed == pytest.approx(1.8, abs=0.02)
    assert flight.figures["parachute_total_alpha_deg"] < 7.0
    assert flight.success, flight.outcome


@pytest.mark.parametrize(
    "fault",
    [
        pytest.param("{kind: wing_stuck, wing_stuck: {opening: 0.97}, at: {time_s: 0}}", id="open enough"),
        pytest.param("{kind: wing_lost, at: {phase: parachute}}", id="no longer needed"),
    ],
)
def test_a_wing_that_reported_itself_open_while_it_was_needed_is_none(fault):
    flight = with_wing_fault(fault)
    assert branched_s(flight) is None
    assert flight.success, flight.outcome


def test_the_branch_counts_as_lift(nominal):
    """Its role is that of the phase it leaves, so the figures of lift reach to the parachute."""
    flight = with_wing_fault(STUCK)
    lift, t = flight.during(LIFT), flight.telemetry["t_s"]
    assert t[lift][0] == nominal.figures["lift_start_s"] == flight.figures["lift_start_s"]
    assert t[lift][-1] == pytest.approx(flight.figures["parachute_s"], abs=0.1)


@pytest.mark.parametrize("seed", [1, *(pytest.param(seed, marks=pytest.mark.long) for seed in (2, 3))])
def test_parachute_opens_below_seven_degrees_although_the_trim_wing_does_not(seed):
    flight = with_wing_fault(STUCK, f"seed={seed}", *PERTURBED, "mission.goal=deployment")
    assert branched_s(flight) == pytest.approx(2.0, abs=0.03)
    assert flight.figures["parachute_total_alpha_deg"] < 7.0
    assert flight.success, flight.outcome


def test_without_the_alpha_loop_the_failed_wing_leaves_the_trim_angle():
    """What the loop is for: with thrusters that do nothing about it, the total angle of attack stays near the
    trim angle.
    """
    flight = with_wing_fault(STUCK, "mission.phases.alpha_held.hold_alpha=false")
    assert flight.figures["parachute_total_alpha_deg"] > 8.0


@pytest.mark.parametrize(
    "time_s", [278, *(pytest.param(t, marks=pytest.mark.long) for t in (274, 276, 277, 278.5, 279, 279.5))]
)
def test_a_wing_lost_in_the_last_seconds_delays_the_mortar_until_the_angle_of_attack_is_good(nominal, time_s):
    """The mortar would fire at 279.7 s; from the trim angle of 10 deg the thrusters need 4 s."""
    flight = with_wing_fault(f"{{kind: wing_lost, at: {{time_s: {time_s}}}}}")
    waited = flight.figures["parachute_s"] - nominal.figures["parachute_s"]
    assert -0.1 < waited < 5.0
    assert flight.figures["parachute_total_alpha_deg"] < 5.0
    assert flight.success, flight.outcome


@pytest.mark.parametrize(
    ("thruster", "time_s"),
    [
        pytest.param(thruster, time_s, marks=[] if number == place < 2 else pytest.mark.long)
        for number, thruster in enumerate(("A1", "A2", "A3", "A4"))
        for place, time_s in enumerate((128, 260, 277, 279))
    ],
)
def test_the_mortar_fires_at_a_good_angle_of_attack_against_a_thruster_that_is_stuck_on(thruster, time_s):
    """Undiagnosed it holds the capsule at 8 to 10 deg; no loop of one axis closes there."""
    flight = edl6dof.fly(
        "tianwen1",
        [
            f"faults=[{{kind: stuck_on, thruster: {thruster}, at: {{time_s: {time_s}}}}}]",
            "flight_software.diagnosis.enabled=false",
            "mission.goal=deployment",
        ],
    )
    assert flight.figures["parachute_total_alpha_deg"] < 5.0
    assert flight.success, flight.outcome


def test_an_angle_of_attack_that_is_never_good_does_not_keep_the_parachute_for_ever():
    """Thrusters rest, and no angle is good enough: the mortar fires at the end of its window."""
    flight = edl6dof.fly(
        "tianwen1",
        [
            "faults=[{kind: wing_lost, at: {time_s: 276}}]",
            "mission.phases.alpha_held.thrusters=[]",
            "mission.phases.alpha_held.transitions.0.when.1.value=0",
            "mission.goal=deployment",
        ],
    )
    assert flight.telemetry.at(flight.figures["parachute_s"], "nav.mach")[0] == pytest.approx(1.6, abs=0.01)
    assert flight.outcome.startswith("deployed")


def test_the_guard_leaves_sound_flights_alone(nominal):
    """A flight in the wind and gusts of another day as well."""
    windy = edl6dof.fly(
        "tianwen1", ["truth={wind.scale: 1.5}", "seed=3", *PERTURBED, "mission.goal=deployment"]
    )
    for flight in (nominal, windy):
        assert branched_s(flight) is None
        assert flight.success, flight.outcome


@pytest.mark.parametrize(
    ("north_m_s", "east_m_s"),
    [
        (0, -45),
        (-42, -42),
        *(
            pytest.param(speed * n, speed * e, marks=pytest.mark.long)
            for speed in (15, 30, 45, 60)
            for n, e in ((1, 0), (0.7, 0.7), (0, 1), (-0.7, 0.7), (-1, 0), (-0.7, -0.7), (0, -1), (0.7, -0.7))
        ),
    ],
)
def test_the_guard_leaves_sound_flights_alone_in_a_wind_that_is_not_expected(north_m_s, east_m_s):
    """The wind moves the angle that navigation works out; the capsule turns into it and meets it head on."""
    wind = f"wind={{model: constant, constant: {{north_m_s: {north_m_s}, east_m_s: {east_m_s}}}}}"
    flight = edl6dof.fly("tianwen1", [wind, *PERTURBED, "mission.goal=deployment"])
    assert branched_s(flight) is None
    assert flight.figures["parachute_total_alpha_deg"] < 4.0


@pytest.mark.parametrize(
    ("thruster", "time_s"),
    [
        *(("A1", 270), ("P1", 277), ("P2", 272)),
        *(pytest.param(name, 270, marks=pytest.mark.long) for name in ("D1", "D5", "P3", "P4")),
    ],
)
def test_a_leak_that_meters_show_at_once_does_not_call_the_guard(thruster, time_s):
    """Its branch is shut before the smoothed direction of the force shows it; the wind is unexpected."""
    flight = edl6dof.fly(
        "tianwen1_meters",
        [
            f"faults=[{{kind: stuck_on, thruster: {thruster}, at: {{time_s: {time_s}}}}}]",
            "wind={model: constant, constant: {east_m_s: -45}}",
            "mission.goal=deployment",
        ],
    )
    assert branched_s(flight) is None
    assert flight.figures["parachute_total_alpha_deg"] < 4.0


@pytest.mark.long  # of the suite: test_repeatable.py
def test_a_flight_broken_off_on_the_branch_goes_on_with_the_same_bits(tmp_path):
    whole = fly(edl6dof.load("tianwen1", [f"faults=[{STUCK}]"]), save_at_s=250.0)
    whole.saved.save(tmp_path / "state.npz")
    state = State.load(tmp_path / "state.npz")
    rest = fly(continue_from(state), start=state)
    assert state.fsw["mission"]["phase"][0] == whole.phase_names.index("alpha_held")
    assert rest.log.tobytes() == whole.log[-len(rest.log) :].tobytes()


# ---- limit cycles, roll and damping ------------------------------------------------------------------------


def test_limit_cycle_of_the_trim_phase_stays_within_its_deadband(nominal):
    deadband = nominal.scenario.flight_software.control.phase_plane.deadband_deg
    assert 0.5 * deadband < nominal.figures["trim_aoa_limit_cycle_deg"] < 1.05 * deadband < 5.0
    assert 0.0 < nominal.figures["trim_aoa_propellant_kg"] < 0.2


def test_roll_keeps_within_half_a_degree_in_the_powered_descent(nominal):
    assert nominal.figures["max_roll_error_powered_deg"] < 0.5


def under_the_parachute(flight):
    """Time since the parachute phase began, s, and the telemetry."""
    table = flight.telemetry
    began = np.argmax(table["guide.phase"] == flight.phase_names.index("parachute"))
    return table["t_s"] - table["t_s"][began], table


def test_thrusters_rest_for_thirteen_seconds_under_the_parachute(nominal):
    """S1 section 5: nothing for 13 s."""
    t, table = under_the_parachute(nominal)
    fired = sum(table[f"rcs.{name}"] for name in nominal.scenario.thruster_names)
    rest_s = nominal.scenario.flight_software.control.rate_damping.rest_s
    assert np.all(fired[(t > 0.3) & (t < rest_s)] == 0.0)


FLIGHTS = 6


def smallest_roll_deg_s():
    """What the shortest pulse of the 25 N thrusters that roll does to the vehicle without its heat shield."""
    vehicle = build_onboard(edl6dof.load("tianwen1").scenario)[0]["vehicle"]
    body, fine = vehicle["configuration"][0b001], vehicle["thrusters"][:22]
    fine = fine[fine["thrust"] == 25.0]
    force = fine["thrust"][:, None] * fine["direction"]
    roll = np.abs(np.cross(fine["position"] - body["centre"], force)[:, 0])
    i = np.argmax(roll)
    return np.degrees(roll[i] * fine["minimum_pulse"][i] / body["inertia"][0])


def turned_by_swinging_deg(table, rows):
    """Angle by which the swinging of its axis alone turns the vehicle about the vertical, to the right.

    An axis that goes round a cone brings its vehicle back turned by the solid angle of that cone, without
    any rate about the axis.
    """
    attitude = Rotation.from_quat(np.stack([table[f"truth.q_I2B_{part}"][rows] for part in "xyzw"], axis=1))
    down = -np.stack([table[f"truth.r_I_{axis}_m"][rows] for axis in "xyz"], axis=1)
    down /= np.linalg.norm(down, axis=1)[:, None]
    east = np.cross(down, (0.0, 0.0, 1.0))
    east /= np.linalg.norm(east, axis=1)[:, None]
    axis = attitude.apply((1.0, 0.0, 0.0))
    n, e, d = (np.sum(axis * one, axis=1) for one in (np.cross(east, down), east, down))
    assert d.min() > 0.8
    area = (0.5 * (n[1:] + n[:-1]) * np.diff(e) - 0.5 * (e[1:] + e[:-1]) * np.diff(n)) / (
        1.0 + 0.5 * (d[1:] + d[:-1])
    )
    return np.degrees(np.concatenate(([0.0], np.cumsum(area))))


def test_roll_under_the_parachute_goes_at_the_commanded_rate():
    """S1 section 5: about 0.5 deg/s towards the local geographic frame.

    The smallest pulse turns the vehicle by a quarter of a degree per second.  One flight is a sample of a
    limit cycle within half a pulse of the command; many that differ by 1e-6 m/s in speed keep it in their
    mean, within three standard errors.  The rate is that about the vehicle's own axis, which gyros measure;
    the heading also goes as the axis swings: gliding, it swings round a cone, by 0.08 deg/s.
    """
    slopes = []
    for k in range(FLIGHTS):
        speed = f"initial.speed_m_s={4800.24 + k * 1e-6}"
        flight = edl6dof.fly("tianwen1", [speed, "simulation.time_limit_s=385"])
        t, table = under_the_parachute(flight)
        steady = (t > 40.0) & (t < 100.0)
        swung = turned_by_swinging_deg(table, steady)
        heading = table["control.error_roll_deg"][steady]
        assert t[-1] > 100.0 and np.all(heading < 0.0)  # it turns to the left
        slopes.append(np.polyfit(t[steady], heading + swung, 1)[0])
    rate, pulse = flight.scenario.flight_software.control.rate_damping.roll.rate_deg_s, smallest_roll_deg_s()
    assert slopes == pytest.approx([rate] * FLIGHTS, abs=pulse / 2.0)
    assert np.mean(slopes) == pytest.approx(rate, abs=3.0 * pulse / np.sqrt(12.0 * FLIGHTS))


def test_free_swing_of_the_angle_of_attack_dies_out_faster_with_the_larger_gain_after_the_trim_wing():
    """S1 section 4.2: the channel is weakly damped then; the derivative gain is there to suppress its
    vibration.
    """
    peak = {}
    for gain in (0.0, 2.0):
        table = edl6dof.fly(
            "tianwen1",
            [f"flight_software.control.bank_to_steer.damping_after_wing={gain}", "mission.goal=deployment"],
        ).telemetry
        wing = table["t_s"][np.argmax(table["truth.trim_wing"] > 0.0)]
        late = (table["t_s"] > wing + 6.0) & (table["t_s"] < wing + 15.0)
        peak[gain] = np.max(np.abs(table["truth.rate_q_deg_s"][late]))
    assert peak[2.0] < 0.5 * peak[0.0]
