"""Verifies: margins and limit cycles of attitude control against closed forms and against frozen flights.

Closed forms: double integrator under proportional and derivative feedback with a dead time; sampled rate
feedback; limit cycle of the phase plane (Bryson; docs/theory/control.md); 2 deg of Hu et al. 2022, section 3.
"""

from dataclasses import replace
from math import atan2, degrees, log10, pi, sqrt

import numpy as np
import pytest
from in_process import called
from scipy.optimize import brentq

import edl6dof
from edl6dof.campaign.margins import AXES
from edl6dof.config.errors import ConfigError
from edl6dof.scenario.records import build_records
from edl6dof.sim.attitude_loop import AttitudeLoop, linearise, margins
from edl6dof.sim.flight_state import snapshots_at
from edl6dof.sim.frozen import FrozenFlight
from edl6dof.sim.measured_loop import Push, Relay, bisected, limit_cycles, measured, oscillation

PITCH, YAW = 1, 2


# ---- closed forms ------------------------------------------------------------------------------------------


def test_margins_of_a_double_integrator_with_a_dead_time_are_those_of_the_book():
    """L = (p + d s) e^-sT / s^2."""
    p, d, delay = 1.125, 1.375, 0.04
    found = margins(lambda w: (p + 1j * d * w) * np.exp(-1j * w * delay) / (1j * w) ** 2, 300.0)
    crossover = sqrt((d * d + sqrt(d**4 + 4.0 * p * p)) / 2.0)
    phase = atan2(d * crossover, p) - crossover * delay
    turnover = brentq(lambda w: atan2(d * w, p) - w * delay, 5.0, 60.0)
    assert found.crossover_rad_s == pytest.approx(crossover, rel=1e-6)
    assert found.phase_deg == pytest.approx(degrees(phase), rel=1e-6)
    assert found.delay_s == pytest.approx(phase / crossover, rel=1e-6)
    assert found.turnover_rad_s == pytest.approx(turnover, rel=1e-6)
    size = sqrt(p * p + (d * turnover) ** 2) / turnover**2
    assert found.gain_db == pytest.approx(-20.0 * log10(size), rel=1e-6)
    assert found.gain_down_db == np.inf


def test_disk_margin_of_an_integrator_with_a_dead_time():
    """Not larger than the classical margins allow, and the least distance of a fine grid."""
    w = np.linspace(0.05, 80.0, 400_000)
    answer = 2.0 * np.exp(-0.1j * w) / (1j * w)
    found = margins(lambda w: 2.0 * np.exp(-0.1j * w) / (1j * w), 80.0)
    assert found.disk == pytest.approx(np.min(np.abs(2.0 * (1.0 + answer) / (1.0 - answer))), rel=1e-6)
    assert found.disk_gain_db <= found.gain_db and found.disk_phase_deg <= found.phase_deg
    assert found.disk == pytest.approx(2.0 * np.tan(np.radians(found.disk_phase_deg) / 2.0))


def rate_feedback(gain, lag_s=0.0):
    """A sampled loop: torque -gain w at unit inertia, held for 40 ms; other axes alike."""
    software = np.zeros((1, 2, 3, 6))
    software[0, 0, :, 3:] = -gain * np.eye(3)
    a, b = np.zeros((6, 6)), np.zeros((6, 3))
    a[:3, 3:] = b[3:] = np.eye(3)
    ones = np.ones(3)
    return AttitudeLoop(software, np.zeros((2, 3, 3)), a, b, 0.04, lag_s, ones, 0.0 * ones)


def test_sampled_rate_feedback_is_stable_up_to_two_over_the_cycle():
    """w' = (1 - d T) w with a hold; with torque a cycle late z^2 - z + d T = 0, stable up to d T = 1."""
    assert rate_feedback(5.0).margins(0).gain_db == pytest.approx(20.0 * log10(2.0 / (5.0 * 0.04)), rel=1e-6)
    late = rate_feedback(5.0, lag_s=0.04).margins(0)
    assert late.gain_db == pytest.approx(20.0 * log10(1.0 / (5.0 * 0.04)), rel=1e-6)


def test_oscillation_of_a_triangle():
    t = np.arange(0.0, 90.0, 0.04)
    found = oscillation(np.radians(2.0 * np.abs((t / 10.0) % 2.0 - 1.0) + 0.3), 0.04)
    assert found.amplitude_deg == pytest.approx(1.0, abs=0.01) and found.period_s == pytest.approx(20.0)


# ---- a linear law in flight --------------------------------------------------------------------------------


def frozen_at(loaded, start):
    """A flight of a scenario frozen in a state of another one."""
    return FrozenFlight(loaded, build_records(loaded), start)


def settled(frozen, seconds):
    for _ in frozen.flown(seconds):
        pass
    return frozen.flight.snapshot()


#: Thrusters that give any impulse, and an allocation that is linear: pulses of at least 1 ms without rise.
_VALVES = ("minimum_pulse_s=0.001", "rise_s=0.0005", "decay_s=0.0005")
_SOFTWARE = (
    *("modulation.deadband=0", "modulation.opening_share=0.5", "modulation.shortest_gap_s=0"),
    *("estimation.valve_lag_s=0.00025", "allocation.least_squares.use_cost=0"),
    "allocation.least_squares.tolerance=1e-5",
)
_GAINS = "proportional=0.5", "derivative=1", "integral=0", "near_deg=60", "far_deg=120", "rate_deg_s=60"


def with_linear_thrusters(name, changes):
    count = len(edl6dof.load(name).scenario.thruster_names)
    sets = [f"vehicle.rcs.thrusters.{i}.{one}" for i in range(count) for one in _VALVES]
    return edl6dof.load(name, [*sets, *(f"flight_software.{one}" for one in (*_SOFTWARE, *changes))])


@pytest.fixture(scope="module")
def braking(nominal):
    """Tianwen-1 at 460 s, in powered deceleration."""
    return snapshots_at(nominal.loaded, [460.0])[0]


@pytest.fixture(scope="module")
def linear_flight(braking):
    """The same under a proportional and derivative law, with nearly linear thrusters."""
    law = "control.thrust_vector"
    gains = [f"{law}.{zone}.{one}" for zone in ("pitch_yaw", "roll") for one in _GAINS]
    loaded = with_linear_thrusters("tianwen1", [f"{law}.against_disturbance=integral", *gains])
    return frozen_at(loaded, settled(frozen_at(loaded, braking), 40.0))


def test_measured_margins_are_those_of_the_linear_loop(linear_flight):
    """Within 0.5 dB and 2 deg; the gain with valves that are 0.3 s late, where a cycle counts little."""
    loop = linearise(linear_flight)
    own = [margins(loop.locus(i), loop.highest) for i in range(3)]
    found = measured(linear_flight, loop)
    weakest = min(own, key=lambda one: one.delay_s)
    assert found.linear_delay_s == weakest.delay_s == pytest.approx(0.96, abs=0.02)
    assert degrees((found.delay_s - weakest.delay_s) * weakest.crossover_rad_s) == pytest.approx(0.0, abs=2.0)
    late = replace(loop, lag_s=loop.lag_s + 0.3)
    weakest = min((margins(late.locus(i), late.highest) for i in range(3)), key=lambda one: one.gain_db)
    push = Push.of(linear_flight, loop, PITCH, weakest.turnover_rad_s)
    gain = bisected(lambda db: push.lasts(gain_db=db, delay_s=0.3), weakest.gain_db, 0.05)
    assert gain == pytest.approx(weakest.gain_db, abs=0.5)


def test_linear_law_has_the_margins_of_its_gains(linear_flight):
    """Double integrator with p = 0.5, d = 1, late by the instruments (20 ms) and half a cycle (20 ms); the
    true inertia is a few per cent smaller than the believed one.
    """
    loop = linearise(linear_flight)
    excess = abs(loop.software[:, :, PITCH, 3 + PITCH].sum()) * loop.b[3 + PITCH, PITCH]
    assert excess == pytest.approx(1.0, abs=0.05)
    p, d, dead_time, stiffness = 0.5 * excess, excess, 0.04, -loop.a[3 + PITCH, PITCH]
    found = loop.margins(PITCH)
    crossover = brentq(lambda w: abs(p + 1j * d * w) - abs(w * w - stiffness), 0.5, 2.0)
    assert found.crossover_rad_s == pytest.approx(crossover, rel=0.01)
    phase = degrees(atan2(d * crossover, p) - crossover * dead_time)
    assert found.phase_deg == pytest.approx(phase, abs=1.0)


def test_estimator_in_the_loop_is_the_pid_law_of_the_theory(nominal, braking):
    """(P + lambda D) e + lambda P int e dt + (D + lambda) e' with P = 1.4, D = 1.9, lambda = 8."""
    found = linearise(frozen_at(nominal.loaded, braking)).margins(PITCH)
    p, i, d = 1.4 + 8.0 * 1.9, 8.0 * 1.4, 1.9 + 8.0
    w = found.crossover_rad_s
    loop = (p + 1j * w * d + i / (1j * w)) / (1j * w) ** 2
    assert 5.0 < w < abs(loop) * w  # the estimator is late: less gain than the continuous law has there
    assert found.gain_db == pytest.approx(14.2, abs=1.0) and found.gain_down_db == pytest.approx(
        20.4, abs=1.0
    )


def test_a_gain_of_the_yaml_file_changes_the_margins(braking):
    name = "flight_software.control.thrust_vector.pitch_yaw.derivative"
    slow, fast = (
        linearise(frozen_at(edl6dof.load("tianwen1", [f"{name}={gain}"]), braking)) for gain in (1.9, 3.8)
    )
    assert fast.margins(PITCH).gain_db < slow.margins(PITCH).gain_db - 1.0
    assert fast.margins(0) == pytest.approx(slow.margins(0), rel=0.05)  # roll has gains of its own


def test_gain_margin_shrinks_by_the_thrust_that_the_flight_software_does_not_know(nominal, braking):
    count = len(nominal.scenario.thruster_names)
    strong = {f"vehicle.rcs.thrusters.{i}.thrust_factor": 1.25 for i in range(count)}
    truth = edl6dof.load("tianwen1", {"truth": strong})
    weak, more = (linearise(frozen_at(one, braking)).margins(PITCH) for one in (nominal.loaded, truth))
    assert weak.gain_db - more.gain_db == pytest.approx(20.0 * log10(1.25), abs=0.02)


def test_a_frozen_flight_stays_where_it_is(nominal, braking):
    frozen = frozen_at(nominal.loaded, braking)
    heights = []
    for _ in frozen.flown(10.0):
        heights.append(float(frozen.flight.outputs["altitude"][0]))
    assert np.ptp(heights) < 10.0  # it falls by 100 m/s otherwise
    assert frozen.flight.phase == "powered_deceleration"
    assert frozen.flight.plant["y"][0, 6:10] == pytest.approx(braking.plant["y"][0, 6:10], abs=0.1)


# ---- limit cycles ------------------------------------------------------------------------------------------


def test_limit_cycle_of_the_phase_plane_has_the_closed_form():
    """2 T w + w^2 / a = (1 - h) d, amplitude d - T w, period 4 (d - T w) / w + 2 w / a, with firings that are
    long against the control cycle.
    """
    d, h, lead, a = 2.0, 0.5, 0.5, 0.2
    plane = {"deadband_deg": d, "hysteresis": h, "lead_s": lead, "acceleration_deg_s2": a}
    changes = [f"control.phase_plane.{name}={value}" for name, value in plane.items()]
    loaded = with_linear_thrusters("viking1", changes)
    frozen = frozen_at(loaded, snapshots_at(edl6dof.load("viking1"), [20.0])[0])
    w = a * (sqrt(lead**2 + (1.0 - h) * d / a) - lead)
    for found in limit_cycles(frozen, YAW):
        assert found.amplitude_deg == pytest.approx(d - lead * w, rel=0.02)
        assert found.period_s == pytest.approx(4.0 * (d - lead * w) / w + 2.0 * w / a, rel=0.02)


@pytest.mark.parametrize("axis", [0, YAW, pytest.param(PITCH, marks=pytest.mark.long)])
def test_predicted_and_flown_limit_cycle_agree_in_a_coast(axis):
    loaded = edl6dof.load("viking1")
    predicted, flown = limit_cycles(frozen_at(loaded, snapshots_at(loaded, [20.0])[0]), axis)
    assert predicted == pytest.approx(flown, rel=0.05)


@pytest.mark.parametrize("torque_deg_s2", [0.003, 0.008])
def test_limit_cycle_against_a_constant_torque_has_the_closed_form(nominal, torque_deg_s2):
    """Pulses of one sign against an acceleration a, each a change of the rate dw: the error is a parabola
    over a period dw / a, of a range dw^2 / (8 a).
    """
    relay = Relay(frozen_at(nominal.loaded, snapshots_at(nominal.loaded, [11.0])[0]), PITCH)
    relay.stiffness = relay.damping = 0.0
    relay.steady, relay.angle = np.radians([-torque_deg_s2, -1.5])
    rate = relay.symmetric_rate()
    before, after = np.degrees(relay.firing(relay.angle, rate))
    assert after == pytest.approx(-before, rel=0.02) and 0.2 < after - before < 0.4
    errors = np.array([error for error, *_ in relay.motion(relay.angle, rate, 400.0)])
    found, change = oscillation(errors, relay.frozen.control_s), after - before
    assert found.period_s == pytest.approx(change / torque_deg_s2, rel=0.01)
    assert found.amplitude_deg == pytest.approx(change**2 / (16.0 * torque_deg_s2), rel=0.02)


@pytest.mark.parametrize("axis", [0, PITCH, YAW])
def test_predicted_and_flown_limit_cycle_agree_in_the_trim_phase(nominal, axis):
    """Air pushes the nose to one side, and the thrusters of each axis turn the others; the amplitude of yaw
    is the published one (Hu et al. 2022, section 3).
    """
    found = limit_cycles(frozen_at(nominal.loaded, snapshots_at(nominal.loaded, [11.0])[0]), axis)
    assert found[0] == pytest.approx(found[1], rel=0.1)
    if axis == YAW:
        assert [one.amplitude_deg for one in found] == pytest.approx([2.0, 2.0], rel=0.05)


# ---- the analysis of a scenario ----------------------------------------------------------------------------


def test_rows_of_phases_and_vehicles():
    rows = edl6dof.margins("tianwen1_mc", phases=["slow_descent"], moments=1, vehicles=2)
    assert [(row.phase, row.axis) for row in rows] == [("slow_descent", axis) for axis in AXES]
    for row in rows:
        assert row.vehicle in (0, 1) and not row.rests
        assert row.phase_deg > 45.0 and row.gain_db > 10.0 and row.gain_down_db > 10.0
        assert row.delay_s > 0.1 and row.disk > 0.8
        assert row.crossover_rad_s < pi / 0.04


def test_what_has_no_margins_is_refused():
    with pytest.raises(ConfigError, match="phase with attitude control"):
        edl6dof.margins("tianwen1", phases=["landed"])
    with pytest.raises(ConfigError, match="no phase in which thrusters control"):
        edl6dof.margins("wu2013")
    with pytest.raises(ConfigError, match="no campaign"):
        edl6dof.margins("tianwen1", vehicles=2)


def test_the_command_prints_and_writes_the_rows(tmp_path):
    words = ("tianwen1", "--phases", "hover_imaging", "--moments", "1", "--out", "m.csv")
    done = called("margins", *words, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "hover_imaging" in done.stdout and "pitch" in done.stdout
    lines = (tmp_path / "m.csv").read_text().splitlines()
    assert len(lines) == 4 and lines[0].startswith("phase,axis,gain_db,")


def test_a_crossing_that_is_zero_but_for_rounding_is_a_crossing():
    """A loop whose imaginary part changes its sign by rounding between one call and the next."""
    calls = []

    def loop(w):
        calls.append(len(w))
        noise = 1e-18 * (-1.0) ** np.arange(len(w)) if len(w) > 1 else 1e-18
        return -2.0 / w**2 + 1j * noise

    found = margins(loop, 50.0)
    assert found.crossover_rad_s == pytest.approx(np.sqrt(2.0))
