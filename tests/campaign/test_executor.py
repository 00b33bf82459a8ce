"""The executor: rows are those of single flights, in order, whatever the number of workers."""

from __future__ import annotations

import json

import numpy as np
import pytest

import edl6dof
from edl6dof.campaign.design.case import Case, NotApplied
from edl6dof.campaign.executor import CaseRunner, fly_rows, in_threads, table_of

GUSTY = ["atmosphere.perturbation.enabled=true", "wind.gust.enabled=true", "seed=7"]
CASES = [
    Case(0, truth={"vehicle.mass.entry_kg": 1290.0}, profile=0),
    Case(1, truth={"vehicle.mass.entry_kg": 1280.0}, profile=1),
    Case(2, truth={"vehicle.parachutes.main.drag_factor": 0.05}, profile=2, label={"what": "canopy torn"}),
    Case(3, truth={"vehicle.mass.entry_kg": 10.0}),
    Case(4, truth={"initial.flight_path_angle_deg": -9.0}, profile=4),
    Case(5, belief={"vehicle.mass.entry_kg": 1290.0}, profile=5),
]


def overrides(case):
    return [f"{path}={json.dumps(value)}" for path, value in case.changes({}).items()]


@pytest.fixture(scope="module")
def loaded():
    return edl6dof.load("tianwen1", GUSTY)


@pytest.fixture(scope="module")
def table(loaded):
    return table_of(fly_rows(loaded, CASES, workers=2, collect=lambda flight: {"rows": len(flight.log)}))


def test_rows_are_those_of_single_flights(loaded, table):
    """Every figure equals, to the last bit, that of ``edl6dof fly`` with the same changes."""
    rows = table.to_pylist()
    for case in (CASES[2], CASES[5]):
        flight = edl6dof.fly("tianwen1", [*GUSTY, *overrides(case)])
        row = rows[case.index]
        assert {name: row[name] for name in flight.figures} == pytest.approx(
            flight.figures, rel=0.0, abs=0.0, nan_ok=True
        )
        assert (row["outcome"], row["success"], row["rows"]) == (
            flight.outcome,
            flight.success,
            len(flight.log),
        )


def test_reused_telemetry_buffer_gives_the_same_log(loaded):
    """A long flight, then one that ends early, then the first again: nothing of one remains in the next."""
    logs = []
    runner = CaseRunner(loaded, lambda flight: logs.append(flight.log.tobytes()) or {})
    for case in (CASES[0], CASES[2], CASES[0], CASES[2]):
        runner.fly([case])
    fresh = edl6dof.fly("tianwen1", [*GUSTY, *overrides(CASES[2])])
    assert logs[0] == logs[2]
    assert logs[1] == logs[3] == fresh.log.tobytes()


def test_number_of_workers_does_not_matter(loaded, table):
    alone = table_of(fly_rows(loaded, CASES, workers=1, collect=lambda flight: {"rows": len(flight.log)}))
    assert alone.equals(table)


def test_changes_and_ends_are_in_the_table(table):
    rows = table.to_pylist()
    assert [row["case"] for row in rows] == [0, 1, 2, 3, 4, 5]
    assert rows[1]["truth.vehicle.mass.entry_kg"] == 1280.0
    assert rows[5]["belief.vehicle.mass.entry_kg"] == 1290.0
    assert rows[2]["what"] == "canopy torn" and not rows[2]["success"]
    assert rows[3]["cause"].startswith("could not fly: vehicle.mass") and not rows[3]["success"]
    assert rows[4]["cause"] == "skipped out in phase lift" or rows[4]["cause"]


def test_rows_are_small(table):
    assert table.nbytes / table.num_rows < 1024


def test_progress_counts_every_case(loaded):
    seen = []
    brief = {"simulation.time_limit_s": 2.0}
    cases = [Case(index, belief=brief) for index in range(3)]
    table_of(fly_rows(loaded, cases, progress=lambda done, row: seen.append((done, row["case"]))))
    assert seen == [(1, 0), (2, 1), (3, 2)]


def test_cases_are_read_only_a_little_ahead():
    read = []

    def cases():
        for index in range(1000):
            read.append(index)
            yield index

    results = in_threads(lambda item: item * item, cases(), workers=2)
    assert next(results) == 0
    assert len(read) < 50
    results.close()
    assert len(read) < 50


def test_a_few_cases_keep_all_workers_busy(loaded):
    """Cases are taken in batches for the sake of the caches; few ones are spread over the workers
    instead.
    """
    runner, taken = CaseRunner(loaded), []
    runner.fly = lambda cases: taken.append(len(cases)) or [{"case": case.index} for case in cases]
    rows = list(runner.rows((Case(index) for index in range(30)), workers=3))
    assert [row["case"] for row in rows] == list(range(30))
    assert taken.count(1) == 12 and sorted(taken)[12:] == [2, 4, 4, 4, 4]


def test_caller_may_not_hide_a_figure(loaded):
    with pytest.raises(ValueError, match="column given twice: touchdown_s"):
        table_of(fly_rows(loaded, CASES[:1], collect=lambda flight: {"touchdown_s": 0.0}))


def test_value_that_did_not_arrive_is_noticed(loaded):
    """The classic failure: a dispersion that nobody applies."""
    variant = CaseRunner(loaded).variants.build(CASES[0])
    assert variant.applied(CASES[0]) == {"truth.vehicle.mass.entry_kg": 1290.0, "profile": 0}
    with pytest.raises(NotApplied, match=r"should be 1200.0 and is 1290.0"):
        variant.applied(Case(0, truth={"vehicle.mass.entry_kg": 1200.0}))


def test_changes_of_list_elements_reach_the_record_in_its_units(loaded):
    case = Case(
        0,
        truth={
            "vehicle.rcs.thrusters.D3.thrust_n": 240.0,
            "vehicle.mass.entry_centre_m.2": -0.035,
            "vehicle.engines.main.misalignment_y_deg": 0.1,
        },
    )
    variant = CaseRunner(loaded).variants.build(case)
    assert variant.applied(case) == {f"truth.{path}": value for path, value in case.truth.items()}
    record = variant.parts.case[0]["vehicle"]
    assert record["rcs"]["thrusters"][2]["thrust"] == 240.0
    assert record["engines"][0]["misalignment_y"] == pytest.approx(np.radians(0.1))


def test_whole_sections_and_values_of_unlike_shape_make_a_column(loaded):
    """Sections are JSON text, also where they could not fly; lists of numbers stay lists."""
    changes = [
        {"wind": {"model": "none"}},
        {"wind": {"scale": 1.0, "weight": 2.0}},
        {"wind": {"scale": "x"}},
        {"wind": 3.0},
    ]
    brief = {"simulation.time_limit_s": 2.0}
    cases = [Case(index, truth=truth, belief=brief) for index, truth in enumerate(changes)]
    found = table_of(fly_rows(loaded, cases, workers=1))
    assert found["truth.wind"].to_pylist() == [
        '{"model": "none"}',
        '{"scale": 1.0, "weight": 2.0}',
        '{"scale": "x"}',
        "3.0",
    ]
    assert [cause.startswith("could not fly") for cause in found["cause"].to_pylist()] == [
        False,
        True,
        True,
        True,
    ]
    listed = table_of(
        fly_rows(loaded, [Case(0, truth={"initial.rate_deg_s": [0.1, 0, 0.0]}, belief=brief)], workers=1)
    )
    assert listed["truth.initial.rate_deg_s"].to_pylist() == [[0.1, 0.0, 0.0]]
