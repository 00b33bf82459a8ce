"""What may be asked of a served flight, and how everything else is refused."""

import pytest

from edl6dof.serve.session import Session


@pytest.fixture(scope="module")
def flown():
    session = Session("tianwen1")
    session.answer({"do": "step", "cycles": 1000})
    return session


def done(session, what, **fields):
    answer = session.answer({"do": what, **fields})
    assert answer["ok"], answer
    return answer


def test_description_has_every_observation_and_command(flown):
    told = done(flown, "describe")
    seen = done(flown, "observe")["observation"]
    assert list(told["observations"]) == list(seen)
    assert told["observations"]["v_N_m_s"] == {"type": "number", "shape": [3], "unit": "m/s"}
    assert told["observations"]["engine_on"]["type"] == "true or false"
    assert told["observations"]["phase"]["type"] == "whole number"
    assert told["commands"]["bank_deg"] == {"type": "number", "shape": [], "unit": "deg"}
    assert told["commands"]["duties"]["shape"] == [len(told["thrusters"])] == [22]
    assert told["commands"]["estimate"]["of"]["q_I2B"]["shape"] == [4]
    assert told["cycle_s"] == 0.02


def numbers(kind):
    return [0.1] * kind["shape"][0] if kind["shape"] else 0.1


def test_every_command_that_is_described_is_taken_in_its_shape():
    session = Session("tianwen1")
    told = done(session, "describe")
    for name, kind in told["commands"].items():
        if name == "estimate":
            value = {
                part: [0.1] * inner["shape"][0] if inner["shape"] else 0.1
                for part, inner in kind["of"].items()
            }
        elif name == "isolate":
            value = told["thrusters"][:1]
        else:
            value = numbers(kind)
        done(session, "step", command={name: value})
        if kind.get("shape"):
            assert "needs" in session.answer({"do": "step", "command": {name: [0.1]}})["error"]


def test_a_step_tells_what_was_asked_for(flown):
    answer = done(flown, "step", cycles=2, observe=["mach", "q_I2B"])
    assert list(answer["observation"]) == ["mach", "q_I2B"]
    assert "observation" not in done(flown, "step", observe=False)
    assert answer["time_s"] == pytest.approx(answer["cycle"] * 0.02)


def test_a_state_goes_back_and_the_flight_repeats_itself(flown):
    state = done(flown, "state")["state"]
    first = done(flown, "step", cycles=100, observe=True)
    assert done(flown, "restore", state=state)["cycle"] == first["cycle"] - 100
    again = done(flown, "step", cycles=100, observe=True)
    assert repr(again) == repr(first)


def test_a_reset_has_its_own_changes_and_no_others():
    session = Session("tianwen1", ["simulation.time_limit_s=50"])
    mass = session.simulation.loaded.scenario.vehicle.mass.entry_kg
    changes = {"vehicle.mass.entry_kg": mass + 9, "flight_software.guidance.entry.law": "fnpeg"}
    done(session, "reset", overrides=changes)
    scenario = session.simulation.loaded.scenario
    assert scenario.vehicle.mass.entry_kg == mass + 9
    assert scenario.flight_software.guidance.entry.law == "fnpeg"
    done(session, "reset", seed=3)
    scenario = session.simulation.loaded.scenario
    assert (scenario.vehicle.mass.entry_kg, scenario.seed) == (mass, 3)
    end = done(session, "step", cycles=10_000)
    assert (end["flying"], end["cycle"], end["outcome"]) == (False, 2500, "time limit")


NAN, INF = float("nan"), float("inf")
REFUSED = [
    (["step"], "a request is a map"),
    (None, "a request is a map"),
    ({}, "a request is a map"),
    ({"do": ["step"]}, "a request is a map"),
    ({"do": "stepp"}, "no request 'stepp'; did you mean 'step'?"),
    ({"do": "step", "cycels": 2}, "no field of step 'cycels'; did you mean 'cycles'?"),
    ({"do": "describe", "x": 1}, "describe has no fields"),
    ({"do": "step", b"cycles": 2}, "no field of step"),
    ({"do": "step", "cycles": 0}, "cycles must be a whole number from 1"),
    ({"do": "step", "cycles": 10**9}, "cycles must be a whole number from 1"),
    ({"do": "step", "cycles": 1.0}, "cycles must be a whole number from 1 to 10000000 (got 1.0)"),
    ({"do": "step", "cycles": True}, "(got true)"),
    ({"do": "step", "cycles": NAN}, "cycles must be a whole number"),
    ({"do": "step", "command": [1]}, "command must be a map"),
    ({"do": "step", "command": {"bank": 1.0}}, "no command 'bank'; did you mean 'bank_deg'?"),
    ({"do": "step", "command": {b"bank_deg": 1.0}}, "no command"),
    ({"do": "step", "command": {"bank_deg": NAN}}, "bank_deg: a command must be finite (got nan)"),
    ({"do": "step", "command": {"bank_deg": -INF}}, "bank_deg: a command must be finite"),
    ({"do": "step", "command": {"bank_deg": "60"}}, "bank_deg: a command must be a number (got '60')"),
    ({"do": "step", "command": {"bank_deg": None}}, "bank_deg:"),
    ({"do": "step", "command": {"bank_deg": [1.0]}}, "bank_deg:"),
    ({"do": "step", "command": {"thrust_n": [0.0, NAN, 0.0]}}, "thrust_n: a command must be finite"),
    ({"do": "step", "command": {"thrust_n": [0.0, 1.0]}}, "thrust_n: a command needs 3 numbers"),
    (
        {"do": "step", "command": {"thrust_n": [[1.0], 1.0, [2.0]]}},
        "thrust_n: a command needs 3 numbers",
    ),
    ({"do": "step", "command": {"thrust_n": ["1", "2", "3"]}}, "thrust_n: a command needs 3 numbers"),
    ({"do": "step", "command": {"torque_nm": {"x": 1}}}, "torque_nm: a command needs 3 numbers"),
    ({"do": "step", "command": {"duties": {"D77": 1.0}}}, "duties: no thruster 'D77'; did you mean 'D7'?"),
    ({"do": "step", "command": {"duties": {"D7": "1"}}}, "duties: a command needs 22 numbers"),
    ({"do": "step", "command": {"isolate": "D7"}}, "isolate: names of thrusters are needed, in a list"),
    ({"do": "step", "command": {"isolate": [7]}}, "isolate: no thruster 7"),
    ({"do": "step", "command": {"estimate": 1.0}}, "estimate: an estimate needs r_I_m"),
    ({"do": "step", "command": {"estimate": {"r_I": 1}}}, "estimate: no quantity of an estimate 'r_I'"),
    ({"do": "step", "command": {"estimate": {"height_m": 1}}}, "estimate: an estimate needs r_I_m"),
    ({"do": "step", "observe": ["altitude"]}, "no observation 'altitude'; did you mean 'altitude_m'?"),
    ({"do": "step", "observe": "altitude_m"}, "what is to be observed is true, or a list of names"),
    ({"do": "observe", "names": [[]]}, "no observation '[]'"),
    ({"do": "reset", "seed": -1}, "seed must be a whole number from 0"),
    ({"do": "reset", "seed": 2**40}, "seed must be a whole number from 0"),
    ({"do": "reset", "overrides": ["a=1"]}, "overrides must be a map"),
    ({"do": "reset", "overrides": {"vehicle.mass.entry_kgs": 1}}, "did you mean 'entry_kg'?"),
    ({"do": "reset", "overrides": {"vehicle.mass.entry_kg": -1}}, "must be > 0 kg (got -1)"),
    ({"do": "reset", "overrides": {"vehicle.mass.entry_kg": NAN}}, "must be finite"),
    ({"do": "reset", "overrides": {"atmosphere.table": "/etc/passwd"}}, "may be set to a word"),
    ({"do": "reset", "overrides": {"seed=1 #": 1}}, "no dotted path"),
    ({"do": "reset", "overrides": {"vehicle.mass": {"entry_kg": 1}}}, "may be set to a number"),
    ({"do": "reset", "overrides": {"plugins": ["evil"]}}, "plugins: must be named in the scenario file"),
    ({"do": "restore"}, "state must be the bytes"),
    ({"do": "restore", "state": "x"}, "state must be the bytes"),
    ({"do": "restore", "state": b"x"}, "is not a state saved by"),
]


@pytest.mark.parametrize(("request_", "words"), REFUSED, ids=lambda value: str(value)[:60])
def test_what_is_wrong_is_told_and_the_flight_stays_as_it_was(flown, request_, words):
    before = flown.simulation.running.snapshot()
    answer = flown.answer(request_)
    assert not answer["ok"]
    assert words in answer["error"]
    assert len(answer["error"]) <= 500
    after = flown.simulation.running.snapshot()
    assert (before.cycle, before.plant.tobytes()) == (after.cycle, after.plant.tobytes())


def test_a_refused_command_leaves_none_behind(flown):
    """Though the first of the two is right."""
    state = done(flown, "state")["state"]
    after = done(flown, "step", cycles=5, observe=True)
    done(flown, "restore", state=state)
    assert not flown.answer({"do": "step", "command": {"torque_nm": [9.0, 0.0, 0.0], "bank_deg": NAN}})["ok"]
    assert repr(done(flown, "step", cycles=5, observe=True)) == repr(after)


def test_a_state_with_values_that_no_flight_has_is_refused(flown):
    from edl6dof.sim.checkpoint import State

    state = State.unpacked(done(flown, "state")["state"], "state")
    state.plant["y"][0, 3] = NAN
    error = flown.answer({"do": "restore", "state": state.packed()})["error"]
    assert error == "state: plant.y[3]: must be finite"


def test_a_state_of_another_scenario_is_refused(flown):
    other = Session("tianwen1", ["vehicle.mass.entry_kg=1300"])
    state = done(other, "state")["state"]
    assert "another scenario" in flown.answer({"do": "restore", "state": state})["error"]
