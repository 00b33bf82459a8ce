"""Every whole number that a saved state brings back has a declared range, and what need not be finite is
declared too.
"""

import numpy as np
import pytest

import edl6dof
from edl6dof.fsw.onboard import FSW, RateParams
from edl6dof.interface.command import COMMAND
from edl6dof.interface.sensed import SENSED
from edl6dof.records import FLAG, TIME_IF_EVER, first_not_finite, numbers, out_of_range, whole
from edl6dof.scenario import records
from edl6dof.scenario.schema import SimulationParams
from edl6dof.sensors.registry import SENSORS
from edl6dof.sim import checkpoint as state
from edl6dof.sim.flight import fly
from edl6dof.vehicle.plant import PEAKS, STATE

FIELDS = {
    f"{name}.{field.path}": field
    for name, dtype in (("plant", STATE), ("peaks", PEAKS), ("sensors", SENSORS), ("fsw", FSW))
    for field in numbers(np.zeros(1, dtype))
}


def test_every_number_is_a_float_or_a_whole_number_that_declares_its_range():
    assert len(FIELDS) > 500
    assert [path for path, field in FIELDS.items() if field.values.dtype.kind not in "if"] == []
    assert [path for path, field in FIELDS.items() if field.is_whole != ("low" in field.declared)] == []


def test_undeclared_whole_number_would_be_found():
    (field,) = numbers(np.zeros(1, [("index", "i8")]))
    assert field.is_whole and "low" not in field.declared


def test_new_records_keep_what_is_declared():
    loaded = edl6dof.load("tianwen1")
    built = records.build_records(loaded)
    for record in (
        records.initial_plant(loaded.truth, built.case),
        records.initial_peaks(),
        records.initial_sensors(),
        records.initial_fsw(built.onboard),
    ):
        assert list(out_of_range(record, {"phases": 1, "thrusters": 1})) == []
        assert first_not_finite(record) is None


@pytest.mark.parametrize(
    "t", [70.0, 500.0, *(pytest.param(t, marks=pytest.mark.long) for t in (0.0, 278.5, 300.0, 431.9, 522.0))]
)
def test_every_moment_of_a_flight_keeps_the_ranges(nominal, t):
    saved = fly(nominal.loaded, save_at_s=t).saved
    assert list(saved._impossible()) == []
    saved.check_fits(nominal.scenario)


def test_ranges_are_read_wherever_a_field_stands():
    inner = np.dtype(
        [("kind", whole(-1, 3)), ("flags", FLAG, (2,)), ("when", TIME_IF_EVER), ("share", "f8")], align=True
    )
    record = np.zeros(1, [("slots", inner, (2,)), ("phase", whole(0, 9, of="phases"))])
    assert list(out_of_range(record, {})) == []
    record["slots"]["when"] = np.nan
    assert first_not_finite(record) is None
    record["slots"]["kind"][0, 1], record["slots"]["flags"][0, 1, 0], record["phase"] = 4, -1, 7
    assert list(out_of_range(record, {"phases": 7})) == [
        ("slots.kind[1]", "must be -1 .. 3 (got 4)"),
        ("slots.flags[1, 0]", "must be 0 .. 1 (got -1)"),
        ("phase", "must be 0 .. 6 (got 7)"),
    ]
    record["slots"]["share"][0, 0] = -np.inf
    assert first_not_finite(record) == "slots.share[0]"


def test_words_that_every_cycle_looks_at_hold_no_negative_whole_number():
    """One would look infinite."""
    watched = [SENSED, FSW["nav"], FSW["guide"], FSW["vehicle"], FSW["disturbance"], FSW["demand"], COMMAND]
    for dtype in watched:
        for field in numbers(np.zeros(1, dtype)):
            assert field.declared.get("low", 0) >= 0


def test_longest_flight_is_the_longest_that_a_scenario_may_ask_for():
    def most(model, name):
        return next(bound.le for bound in model.model_fields[name].metadata if hasattr(bound, "le"))

    assert most(SimulationParams, "time_limit_s") * most(RateParams, "base_hz") == state._LAST_CYCLE
