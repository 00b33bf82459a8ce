"""What is not finite ends a flight at once, named by the quantity in which it began, and never becomes an
index (``contract/test_bounds_check.py`` reads the tables with such numbers).
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

import edl6dof
from edl6dof.config.dtype import duplicate
from edl6dof.fsw.cycle import run
from edl6dof.fsw.functions import software_functions
from edl6dof.interface.sensed import SENSED
from edl6dof.records import numbers
from edl6dof.scenario import records
from edl6dof.sim.checkpoint import State
from edl6dof.sim.flight import fly
from edl6dof.sim.outcome import first_cause, works_with_finite
from edl6dof.vehicle.plant import OUTPUTS, STATE_NAMES, STATES_VEHICLE, WORKSPACE

DISPERSED = [
    "seed=7",
    "atmosphere.perturbation.enabled=true",
    "wind.gust.enabled=true",
    "truth={atmosphere.density_factor: 0.95}",
]
#: In vacuum, in lift, while the parachute inflates, below it, under power, and while avoiding hazards.
MOMENTS = (20.0, 150.0, 278.5, 300.0, 440.0, 500.0)
WRONG = (np.nan, np.inf, -np.inf)
#: What is sensed, but images: those are finite whatever the vehicle does (unit/sensors/test_eyes.py).
READ = [
    field.path
    for field in numbers(np.zeros(1, SENSED))
    if not field.is_whole and not field.path.startswith(("lidar", "stereo", "camera"))
]


@pytest.fixture(scope="module")
def loaded():
    return edl6dof.load("tianwen1", DISPERSED)


@pytest.fixture(scope="module")
def onboard(loaded):
    """For reading only."""
    return records.build_records(loaded).onboard


@pytest.fixture(scope="module")
def saved_at(loaded):
    """The state saved at a time (s); for reading only."""
    return cache(lambda time_s: fly(loaded, save_at_s=time_s).saved)


@pytest.fixture(
    scope="module",
    params=[
        pytest.param(number, marks=[] if number in (1, 5) else pytest.mark.long)
        for number in range(len(MOMENTS))
    ],
    ids=[f"{t:g} s" for t in MOMENTS],
)
def moment(request, saved_at):
    """Number of a moment, and the state saved there."""
    return request.param, saved_at(MOMENTS[request.param])


def wrong(*numbers):
    """The wrong numbers in turn: every quantity is tried at every moment, with each of them at two of six."""
    return WRONG[sum(numbers) % len(WRONG)]


def planted(state, record, path, index, value):
    """The state with one value of one record changed."""
    changed = {name: duplicate(getattr(state, name)) for name in ("plant", "peaks", "sensors", "fsw")}
    field = next(field for field in numbers(changed[record]) if field.path == path)
    field.values[index] = value
    return State(state.cycle, **changed, scenario_text=state.scenario_text)


@pytest.mark.parametrize("index", range(STATES_VEHICLE))
def test_state_is_named(loaded, moment, index):
    number, state = moment
    flight = fly(loaded, start=planted(state, "plant", "y", index, wrong(number, index)))
    assert flight.outcome.startswith(
        f"not finite: {STATE_NAMES[index]} at t = {state.plant['t'][0]:.2f} s in phase "
    )
    assert flight.cause == f"not finite: {STATE_NAMES[index]} in phase {flight.phase}"
    assert len(flight.log) == 1
    assert flight.events[-1]["name"] == flight.outcome and flight.figures


@pytest.mark.parametrize("value", WRONG)
@pytest.mark.parametrize("field", ["rate", "gain"])
def test_reading_under_way_is_named(loaded, moment, field, value):
    path = f"inertial_unit.under_way.{field}"
    flight = fly(loaded, start=planted(moment[1], "sensors", path, ..., value))
    assert flight.outcome.startswith(f"not finite: {path}[")


@pytest.mark.parametrize("path", READ)
def test_sensed_quantity_is_named(onboard, moment, path):
    number, state = moment
    changed = planted(state, "sensors", f"sensed.{path}", ..., wrong(number, READ.index(path)))
    run(
        software_functions(onboard[0]),
        onboard[0],
        changed.sensors[0]["sensed"],
        changed.cycle,
        changed.fsw[0],
    )
    assert not works_with_finite(changed.sensors.view(np.uint64), changed.fsw.view(np.uint64))
    outputs, work = np.zeros(1, OUTPUTS), np.zeros(1, WORKSPACE)
    assert first_cause(changed.plant, outputs, work, changed.sensors, changed.fsw).startswith(
        f"sensed.{path}"
    )


@pytest.mark.parametrize(
    "t, path",
    [
        (20.0, "mission.phase_start"),
        pytest.param(150.0, "guidance.entry.air.drag", marks=pytest.mark.long),
        (150.0, "guidance.entry.law.drag_tracking.tracking.scale"),
        pytest.param(465.0, "guidance.target.arrival", marks=pytest.mark.long),
        pytest.param(440.0, "vehicle.mass", marks=pytest.mark.long),
        pytest.param(300.0, "vehicle.mass", marks=pytest.mark.long),
        (510.0, "guidance.terminal.target_L"),
    ],
)
def test_memory_of_the_flight_computer_is_named(saved_at, loaded, t, path):
    flight = fly(loaded, start=planted(saved_at(t), "fsw", path, ..., np.nan))
    assert flight.outcome.startswith(f"not finite: fsw.{path}")
    assert flight.time_s == pytest.approx(t, abs=0.25)


def test_step_that_fails_is_undone_and_its_first_quantity_named():
    """Damping a billion times too stiff for the step."""
    flight = edl6dof.fly("tianwen1", ["vehicle.landing_gear.damping_n_s_m=1e12"])
    assert flight.outcome.startswith("not finite: outputs.")
    assert np.all(np.isfinite(flight.plant["y"]))
    assert np.all(np.isfinite(flight.telemetry["truth.r_I_x_m"]))
    assert np.all(np.diff(flight.telemetry["t_s"]) > 0.0)
    assert flight.telemetry["t_s"][-1] == flight.time_s


def test_last_state_before_a_failed_step_is_logged_whatever_the_rate(loaded):
    sparse = edl6dof.fly("tianwen1", ["vehicle.landing_gear.damping_n_s_m=1e12", "simulation.log_every=1000"])
    assert sparse.telemetry["t_s"][-1] == sparse.time_s
    assert np.all(np.diff(sparse.telemetry["t_s"]) > 0.0)
