"""Linear models of a flight against closed forms and against the flight itself."""

import numpy as np
import pytest
from scipy.linalg import expm

from edl6dof.sim.linear import linear_plant
from edl6dof.sim.simulation import SteppedFlight

#: m3/s2, Mars.
MU = 4.282837e13
#: No thruster fires.
REST = {"duties": np.zeros(22)}


@pytest.fixture(scope="module")
def flight(nominal):
    """The nominal flight under lift control."""
    flight = SteppedFlight(nominal.loaded, telemetry=False)
    flight.step(cycles=6000)
    return flight


def test_torque_turns_the_vehicle_by_its_inertia(flight):
    plant = linear_plant(flight.running)
    flight.running.look()
    xx, yy, zz, xy, xz, yz = flight.running.outputs["inertia"][0]
    inertia = np.array([[xx, -xy, -xz], [-xy, yy, -yz], [-xz, -yz, zz]])
    turned = np.abs(plant.b[9:, :3] @ inertia)
    assert np.diag(turned) == pytest.approx(turned[0, 0], rel=0.02)  # less what the flow takes off


def test_gravity_gradient_is_newtons(nominal):
    """Above the air, where nothing else depends on the place."""
    flight = SteppedFlight(nominal.loaded, telemetry=False)
    r = flight.truth()["r_I_m"]
    expected = MU / np.linalg.norm(r) ** 3 * (3.0 * np.outer(r, r) / (r @ r) - np.eye(3))
    found = linear_plant(flight.running).a[3:6, :3]
    assert np.allclose(found, expected, atol=0.02 * np.abs(expected).max())


def test_small_deviations_go_the_way_of_the_linear_model(flight):
    """A second of flight without thrusters, from a rate a little off: the difference is that of the matrix
    exponential, though the flight path bends meanwhile.
    """
    begin, plant = flight.running.snapshot(), linear_plant(flight.running)
    ends = []
    for sign in (1.0, -1.0):
        flight.restore(begin)
        flight.running.plant["y"][0, 11] += sign * 1e-4
        flight.step(REST, 25)
        ends.append(flight.running.plant["y"][0, 10:13].copy())
    flight.restore(begin)
    change = expm(0.5 * plant.a)[9:, 10] * 1e-4
    assert (ends[0] - ends[1]) / 2.0 == pytest.approx(change, abs=0.03 * np.abs(change).max())


def test_a_flight_is_as_it_was_after_it_was_looked_at(flight):
    before = flight.running.snapshot()
    flight.linear_plant()
    flight.attitude_margins()
    after = flight.running.snapshot()
    assert all(np.asarray(a).tobytes() == np.asarray(b).tobytes() for a, b in zip(before, after, strict=True))


def test_attitude_loop_of_powered_descent_has_margins(nominal):
    flight = SteppedFlight(nominal.loaded, telemetry=False)
    burns = next(event["t_s"] for event in nominal.events if event["key"] == "ignition")
    flight.step(cycles=round((burns + 15.0) / flight.cycle_s))
    found = flight.attitude_margins()
    assert all(one.phase_deg > 30.0 and one.gain_db > 6.0 and one.delay_s > 0.1 for one in found.values())


def test_python_control_takes_it(flight):
    control = pytest.importorskip("control")
    plant = flight.linear_plant()
    system = plant.to_control()
    assert isinstance(system, control.StateSpace)
    assert system.input_labels[0] == "torque_x_nm"
    assert np.allclose(np.sort(system.poles().real), np.sort(plant.poles().real))


def test_without_python_control_it_says_what_to_install(flight, monkeypatch):
    import sys

    monkeypatch.setitem(sys.modules, "control", None)
    with pytest.raises(ImportError, match="pip install control"):
        flight.linear_plant().to_control()
