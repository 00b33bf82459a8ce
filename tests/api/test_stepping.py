"""A flight step by step is the flight; commands from outside take the place of its own."""

from dataclasses import replace

import numpy as np
import pytest

import edl6dof
from edl6dof.campaign.design.plan import load_plan
from edl6dof.campaign.run import case_scenario
from edl6dof.config.errors import ConfigError
from edl6dof.sim.checkpoint import State
from edl6dof.sim.flight import fly as fly_flight
from edl6dof.sim.simulation import SteppedFlight

#: s of flight that tells, with attitude control and the beginning of lift control in it.
SHORT = {"simulation": {"time_limit_s": 75.0}}


@pytest.fixture(scope="module")
def short():
    return edl6dof.load("tianwen1", SHORT)


@pytest.fixture
def flight(short):
    return edl6dof.Simulation(short)


def same(a, b):
    """Whether two flights have the same bits: telemetry, state and memory."""
    return all(getattr(a, name).tobytes() == getattr(b, name).tobytes() for name in ("log", "plant", "fsw"))


def test_whole_flight_step_by_step_is_the_flight(nominal):
    simulation = edl6dof.Simulation(nominal.loaded)
    while simulation.step():
        pass
    stepped = simulation.flight()
    assert same(stepped, nominal)
    assert (stepped.outcome, stepped.figures) == (nominal.outcome, nominal.figures)


@pytest.mark.parametrize("cycles", [7, 1000])
def test_portions_of_any_length_make_the_same_flight(short, flight, cycles):
    while flight.step(cycles=cycles):
        pass
    assert same(flight.flight(), fly_flight(short))


def test_a_command_that_is_taken_back_leaves_the_flight_software_its_word(flight):
    """Torque: attitude control is asked anew in every control cycle, and has no memory of what was done."""
    flight.step(cycles=3000)
    flight.step({"torque_nm": (0.0, 0.0, 0.0)}, 2)
    flight.step(cycles=2)
    fsw = flight.running.fsw
    assert not any(fsw["external"]["given"].tolist()[0])
    assert np.array_equal(fsw["demand"]["wrench"][0, 3:], fsw["own"]["torque_B"][0])


def test_a_state_goes_on_bit_for_bit(flight, short):
    flight.step(cycles=1000)
    state = flight.state()
    flight.step(cycles=500)
    later = flight.running.snapshot()
    flight.restore(state)
    assert flight.cycle == 1000
    flight.step(cycles=500)
    again = flight.running.snapshot()
    assert all(np.asarray(a).tobytes() == np.asarray(b).tobytes() for a, b in zip(again, later, strict=True))


def test_a_state_goes_through_a_file(flight, short, tmp_path):
    flight.step(cycles=500)
    flight.state().save(tmp_path / "state.npz")
    flight.restore(State.load(tmp_path / "state.npz"))
    while flight.step(cycles=100):
        pass
    assert flight.running.plant.tobytes() == fly_flight(short).plant.tobytes()


def test_a_state_holds_no_command(flight):
    flight.step({"bank_deg": 10.0}, 100)
    flight.restore(flight.state())
    flight.step()
    assert not flight.running.fsw["external"]["given"]["bank"][0]


def test_state_of_another_scenario_is_refused(flight):
    other = edl6dof.Simulation("tianwen1", {"seed": 2})
    with pytest.raises(ConfigError, match="another scenario"):
        flight.restore(other.state())
    with pytest.raises(ConfigError, match="does not fit"):
        flight.restore(replace(flight.state(), cycle=7))


def test_what_the_flight_computer_observes_holds_no_truth(short):
    """With a heavier vehicle than it was told, its mass is the one it was told."""
    heavy = edl6dof.Simulation("tianwen1", {**SHORT, "truth": {"vehicle.mass.entry_kg": 1300.0}})
    heavy.step()
    assert heavy.observe()["mass_kg"] == pytest.approx(1284.0, abs=0.1)
    assert heavy.truth()["mass_kg"] == pytest.approx(1300.0, abs=0.1)


def test_reset_observes_the_start_and_flies_nothing(flight, short):
    flight.step(cycles=100)
    seen = flight.reset()
    assert flight.cycle == 0
    assert seen["speed_m_s"] == pytest.approx(4800.0, rel=0.05)
    while flight.step(cycles=500):
        pass
    assert same(flight.flight(), fly_flight(short))


def test_seeds_of_a_scenario_are_its_random_profiles():
    simulation = edl6dof.Simulation("tianwen1", {**SHORT, "atmosphere.perturbation.enabled": True})
    simulation.reset(seed=4)
    while simulation.step(cycles=500):
        pass
    plain = fly_flight(
        edl6dof.load("tianwen1", {**SHORT, "atmosphere.perturbation.enabled": True, "seed": 4})
    )
    assert simulation.running.plant.tobytes() == plain.plant.tobytes()


def test_seeds_of_a_campaign_are_its_cases():
    """The flight of a seed is the case of its number, of a campaign that samples at random."""
    simulation = edl6dof.Simulation("tianwen1_mc", SHORT)
    simulation.reset(seed=3)
    plan = load_plan("tianwen1_mc", ("simulation.time_limit_s=75.0",), cases=5, sampling="monte_carlo")
    case = SteppedFlight(case_scenario(plan, 3))
    simulation.step(cycles=600)
    case.step(cycles=600)
    assert simulation.running.plant.tobytes() == case.running.plant.tobytes()
    assert simulation.reset(seed=4) != simulation.reset(seed=3)


# commands


def test_bank_turns_the_vehicle_at_no_more_than_its_rate(nominal):
    simulation = edl6dof.Simulation(nominal.loaded)
    simulation.step(cycles=5000)  # 100 s: lift control
    assert simulation.phase == "lift"
    begin = float(simulation.running.fsw["command"]["bank"][0])
    simulation.step({"bank_deg": 0.0})
    moved = abs(float(simulation.running.fsw["command"]["bank"][0]) - begin)
    assert np.degrees(moved) == pytest.approx(20.0 * simulation.cycle_s, rel=1e-9)
    simulation.step({"bank_deg": -30.0}, 750)
    assert simulation.observe()["bank_deg"] == pytest.approx(-30.0, abs=3.0)
    wanted = simulation.own()["bank_deg"]
    assert wanted != pytest.approx(-30.0, abs=1.0)  # entry guidance still knows what it would do
    simulation.step(
        cycles=750
    )  # handed back: the command is guidance's own again, and the vehicle has turned
    own = simulation.own()["bank_deg"]
    assert np.degrees(simulation.running.fsw["command"]["bank"][0]) == pytest.approx(own, rel=1e-12)
    assert abs(simulation.observe()["bank_deg"] - own) < 0.5 * abs(-30.0 - own)


def test_bank_rate_moves_the_command(nominal):
    simulation = edl6dof.Simulation(nominal.loaded)
    simulation.step(cycles=5000)
    begin = np.degrees(simulation.running.fsw["command"]["bank"][0])
    simulation.step({"bank_rate_deg_s": 2.0}, 50)
    assert np.degrees(simulation.running.fsw["command"]["bank"][0]) - begin == pytest.approx(2.0, rel=1e-9)


@pytest.fixture(scope="module")
def burning(nominal):
    """The nominal flight two seconds before the hover ends: the engine throttles, and lateral speed is
    small.
    """
    simulation = SteppedFlight(nominal.loaded)
    hover = next(event["t_s"] for event in nominal.events if event.get("phase") == "hover_imaging")
    simulation.step(cycles=round((hover + 4.0) / simulation.cycle_s))
    return simulation, simulation.running.snapshot()


def test_thrust_vector_accelerates_the_lander(burning):
    simulation, moment = burning
    simulation.restore(moment)
    before = simulation.observe()
    weight = before["mass_kg"] * before["gravity_m_s2"]
    simulation.step({"thrust_n": (0.08 * weight, 0.0, -weight)}, 200)
    after = simulation.observe()
    gained = (after["v_N_m_s"] - before["v_N_m_s"]) / (200 * simulation.cycle_s)
    assert gained[0] == pytest.approx(0.08 * before["gravity_m_s2"], rel=0.35)  # it has to tilt first
    assert abs(gained[1]) < 0.08
    assert abs(gained[2]) < 0.1


def test_throttle_is_limited_to_what_the_engine_can(burning):
    simulation, moment = burning
    simulation.restore(moment)
    full = float(simulation.running.fsw["vehicle"]["engine"]["full_thrust"][0])
    low = float(simulation.running.fsw["vehicle"]["engine"]["throttle_min"][0])
    simulation.step({"throttle": 0.5})
    assert simulation.running.fsw["guide"]["thrust"][0] == pytest.approx(0.5 * full)
    simulation.step({"throttle": 0.0})
    assert simulation.running.fsw["guide"]["thrust"][0] == pytest.approx(low)


def test_lander_goes_to_the_spot_that_is_commanded(burning, nominal):
    simulation, moment = burning
    simulation.restore(moment)
    east, north = simulation.observe()["site_L_m"][:2]
    spot = (float(north) + 30.0, float(east) - 20.0)
    while simulation.step({"safe_spot_m": spot}, 50):
        pass
    assert simulation.outcome == "landed"
    east, north = simulation.observe()["site_L_m"][:2]
    assert (north, east) == (pytest.approx(spot[0], abs=1.0), pytest.approx(spot[1], abs=1.0))


def test_duties_open_the_valves_of_the_thrusters_named(flight):
    flight.step(cycles=3000)  # check-out of the thrusters is over
    flight.step({"duties": {"D1": 1.0, "D7": 0.0}}, 20)  # pulses under way come to their ends
    names = flight.loaded.scenario.thruster_names
    command = flight.running.fsw["command"]
    open_s = (command["valve_close_time"] - command["valve_open_time"])[0, : len(names)]
    assert {name for name, on in zip(names, open_s, strict=True) if on > 0.0} == {"D1"}
    assert np.array_equal(
        flight.running.fsw["external"]["duty"][0, : len(names)] > 0.0, [n == "D1" for n in names]
    )


def test_torque_gives_way_to_the_one_commanded(flight):
    flight.step(cycles=3000)
    flight.step({"torque_nm": (1.0, 2.0, 3.0)}, 2)
    assert flight.running.fsw["demand"]["wrench"][0, 3:].tolist() == [1.0, 2.0, 3.0]


def test_isolated_thrusters_are_used_no_more(flight):
    flight.step({"isolate": ["D7"]}, 2)
    flight.step(cycles=2)
    assert flight.running.fsw["health"]["thruster"][0, flight.loaded.scenario.thruster_names.index("D7")] == 0


def test_estimate_is_what_flight_software_works_with(flight):
    flight.step(cycles=10)
    seen, true = flight.observe(), flight.truth()
    told = {
        "r_I_m": true["r_I_m"] * 1.001,
        "v_I_m_s": true["v_I_m_s"],
        "q_I2B": seen["q_I2B"],
        "w_B_rad_s": seen["w_B_rad_s"],
        "height_m": 5000.0,
    }
    flight.step({"estimate": told})
    assert flight.observe()["height_m"] == 5000.0
    assert flight.observe()["altitude_m"] == pytest.approx(true["altitude_m"] + 3500.0, rel=0.02)


@pytest.mark.parametrize(
    "command, words",
    [
        ({"bank": 1.0}, "did you mean 'bank_deg'"),
        ({"duties": {"D17": 1.0}}, "no thruster 'D17'"),
        ({"duties": [1.0]}, "needs .* numbers"),
        ({"torque_nm": (1.0, float("nan"), 0.0)}, "finite"),
        ({"bank_deg": float("inf")}, "finite"),
        ({"estimate": {"r_I_m": (0.0, 0.0, 0.0)}}, "needs v_I_m_s"),
        ({"estimate": {"r_I": (0.0, 0.0, 0.0)}}, "did you mean 'r_I_m'"),
    ],
)
def test_a_command_that_is_none_is_refused(flight, command, words):
    with pytest.raises(ValueError, match=words):
        flight.step(command)


def test_flight_without_telemetry_says_so(short):
    simulation = edl6dof.Simulation(short, telemetry=False)
    simulation.step()
    with pytest.raises(ValueError, match="no telemetry is kept"):
        simulation.flight()
    with pytest.raises(ValueError, match="no cycle has been flown"):
        edl6dof.Simulation(short).flight()
