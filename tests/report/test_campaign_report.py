"""The report of a campaign: what it says, what it refuses to say, and where its words stand."""

from __future__ import annotations

import subprocess
import sys
from types import SimpleNamespace

import numpy as np
import pytest

from edl6dof.metrics.figures import figure_of_merit
from edl6dof.report.campaign import drivers, footprint, margins
from edl6dof.report.campaign.campaign_results import Results
from edl6dof.report.document import Table, Text, aligned
from edl6dof.report.figure import Figure
from edl6dof.report.flight import landing

LIMITS = [(figure_of_merit("parachute_mach"), 2.1)]


def results(flights: int, **columns: np.ndarray) -> Results:
    """A campaign of which only these columns are known."""
    found = SimpleNamespace(
        cases=np.arange(flights),
        ok=np.ones(flights, bool),
        limits=LIMITS,
        folder="runs/mc",
        is_sample=True,
        groups={},
        has=columns.__contains__,
    )
    methods = {"__getitem__": lambda _, name: columns[name], "nearest": Results.nearest}
    return type("Known", (SimpleNamespace,), methods)(**vars(found))


def words(blocks) -> str:
    return " ".join(block.words for block in blocks if isinstance(block, Text))


@pytest.mark.parametrize(
    "flights, heads",
    [
        (5, []),
        (10, ["50 %>"]),
        (100, ["50 %>", "95 %>"]),
        (1000, ["50 %>", "99 %>"]),
        (3000, ["50 %>", "99.87 %>"]),
    ],
)
def test_quantiles_go_as_far_as_flights_bound_them(flights, heads):
    rng = np.random.default_rng(1)
    known = results(flights, parachute_mach=rng.normal(1.85, 0.02, flights))
    blocks = list(margins.limits(known))
    table = next(block for block in blocks if isinstance(block, Table))
    assert table.columns[2:-3] == heads
    assert ("99.87 % needs 2,836" in words(blocks)) is (flights < 2836)
    assert all("(" in cell and ".." in cell for cell in table.rows[0][2:-3])


def test_a_figure_that_few_flights_reach_says_how_many_it_takes():
    mach = np.full(100, np.nan)
    mach[:30] = np.linspace(1.8, 1.9, 30)
    table = next(
        block for block in margins.limits(results(100, parachute_mach=mach)) if isinstance(block, Table)
    )
    assert table.rows[0][3] == "needs 72 flights" and ".." in table.rows[0][2]


def test_a_grid_is_no_sample():
    known = results(100, parachute_mach=np.linspace(1.8, 1.9, 100))
    known.is_sample = False
    table = next(block for block in margins.limits(known) if isinstance(block, Table))
    assert table.columns[2:4] == ["50 %>", "largest>"] and table.rows[0][2:4] == ["1.85", "1.9"]
    assert "no random sample" in words(margins.limits(known))


def test_units_and_shares_are_printed_as_in_the_report_of_a_flight():
    known = results(100, peak_heat_flux_w_cm2=np.linspace(30.0, 35.0, 100))
    known.limits = [(figure_of_merit("peak_heat_flux_w_cm2"), 70.0)]
    for blocks in (margins.limits(known), margins.worst(known)):
        assert next(block for block in blocks if isinstance(block, Table)).rows[0][1] == "W/cm²"
    table = next(block for block in margins.limits(known) if isinstance(block, Table))
    assert table.rows[0][-2].text == "50 %"


def test_clearance_is_judged_by_its_smallest_values():
    """From 90 to 130 m in 1,000 flights: one of 100 is below 90.4 m, and 60 m leave a third unused."""
    known = results(1000, min_drift_distance_m=np.linspace(90.0, 130.0, 1000))
    known.limits = [(figure_of_merit("min_drift_distance_m"), 60.0)]
    table = next(block for block in margins.limits(known) if isinstance(block, Table))
    assert table.rows[0][3].startswith("90.4") and table.rows[0][-1] == "0"
    assert table.rows[0][-2].text == "67 %" and table.rows[0][-3] == "at least 60"
    assert "its share of the flights exceeds" in words(margins.limits(known))
    known.limits = [(figure_of_merit("min_drift_distance_m"), 91.0)]
    worst = next(block for block in margins.worst(known) if isinstance(block, Table)).rows[0]
    assert worst[2].mood == "bad" and worst[4].startswith("0, 1")


@pytest.mark.parametrize("goal, name", [("time", "landing site"), ("landing", "target")])
def test_what_flies_until_its_time_is_up_has_no_target(goal, name):
    class Known(dict):
        scenario, summary, when = {"mission": {"goal": goal}}, {"figures": {}}, {}

    assert landing.target(Known()).name == name


@pytest.mark.parametrize("height", [14_000.0, 9_000.0])
def test_limits_lie_inside_their_axes(height):
    rng = np.random.default_rng(2)
    known = results(
        100,
        parachute_mach=rng.normal(1.85, 0.02, 100),
        parachute_dynamic_pressure_pa=rng.normal(530.0, 20.0, 100),
        parachute_height_m=rng.normal(height, 500.0, 100),
        parachute_total_alpha_deg=rng.exponential(1.0, 100),
    )
    figure = footprint.deployment(known)
    for panel in figure.panels:
        for mark in panel.marks:
            low, high = panel.span(mark.axis)
            assert low < mark.at < high
    assert [mark.at for mark in figure.panels[0].marks] == [2.1]


def test_words_at_points_stand_apart():
    """Of five outermost points two lie side by side: one of these has its number."""
    x = np.array([0.0, 0.0, 0.0, -5.0, 5.0, 5.05])
    y = np.array([0.1, -0.1, 0.0, 0.0, 0.0, 0.1])
    (trace,) = footprint._points(results(6), x, y, (10.0, 10.0))
    assert sum(label in ("case 4", "case 5") for label in trace.labels) == 1
    assert "case 3" in trace.labels


def test_drivers_that_cannot_be_told_are_said_to_be_so():
    rng = np.random.default_rng(3)
    known = results(100, parachute_mach=rng.normal(1.85, 0.02, 100))
    known.groups = {f"vehicle.x{k}": rng.standard_normal((100, 1)) for k in range(20)}
    blocks = list(drivers.blocks(known))
    table = blocks[-1]
    assert not any(isinstance(block, Figure) for block in blocks)
    (row,) = table.rows
    assert row[0].startswith("Mach at mortar fire: not significant with 100 flights, no share above 1")


def test_drivers_are_ranked_with_their_intervals():
    rng = np.random.default_rng(4)
    groups = {f"vehicle.x{k}": rng.standard_normal((100, 1)) for k in range(20)}
    mach = 1.85 + 0.02 * groups["vehicle.x3"][:, 0] - 0.01 * groups["vehicle.x5"][:, 0]
    known = results(100, parachute_mach=mach + 0.003 * rng.standard_normal(100))
    known.groups = groups
    _, figure, table = drivers.blocks(known)
    head, *rows = table.rows
    assert [row[0].strip() for row in rows] == ["vehicle.x3", "vehicle.x5"]
    assert [row[3] for row in rows] == ["rises", "falls"]
    assert "remains, shares below" in head[0]
    first, second = figure.panels[0].bands
    assert first.x[0] == 0.0 and first.x[1] == second.x[0] < second.x[1] <= 100.0
    assert [trace.name for trace in figure.panels[0].traces] == ["x3", "x5"]


def test_few_flights_are_not_asked():
    known = results(19, parachute_mach=np.linspace(1.8, 1.9, 19))
    known.groups = {"a": np.linspace(0.0, 1.0, 19)[:, None]}
    assert words(drivers.blocks(known)) == "Needs at least 20 flights."


@pytest.mark.parametrize(
    "values, shown",
    [
        ((86.12345, 86.0, 86.9), ["86.12", "86.00", "86.90"]),
        ((0.123456, 0.123401, 0.123499), ["0.1235", "0.1234", "0.1235"]),
        ((1216.3, 1216.1, 1216.6), ["1216", "1216", "1217"]),
        ((0.0, 0.0, 0.0), ["0.0", "0.0", "0.0"]),
        ((-3.0, -4.0, 20.0), ["-3", "-4", "20"]),
    ],
)
def test_numbers_beside_each_other_have_the_same_decimals(values, shown):
    assert aligned(*values) == shown


def test_a_report_loads_neither_the_simulator_nor_what_takes_longer_than_the_report():
    """Half of the time of a campaign's report once went into importing these."""
    heavy = ("numba", "pandas", "scipy.stats", "scipy.optimize")
    loaded = f"print(sys.modules.keys() & {set(heavy)})"
    words = f"import sys, edl6dof.report.campaign.campaign_report, edl6dof.report.page; {loaded}"
    said = subprocess.run([sys.executable, "-c", words], check=True, capture_output=True, text=True)
    assert said.stdout == "set()\n"


def test_faults_that_every_flight_carries_are_told_with_how_many_flights_isolated_them():
    faults = [
        {"kind": "stuck_off", "thruster": "D7", "at": {"phase": "hazard_avoidance", "plus_s": 2.0}},
        {"kind": "weak_thrusters", "at": {"time_s": 129.5}},
    ]
    missed = np.array([0.0] * 38 + [1.0, np.nan])  # the last one crashed before any of them began
    known = results(40, missed_isolations=missed, time_to_detect_s=np.linspace(0.1, 0.5, 40))
    known.has_faults, known.document = False, {"faults": faults}
    assert margins.injected(known) == [
        "D7 stuck off at hazard avoidance + 2 s",
        "weak thrusters at 129.5 s",
    ]
    shares, times = margins.isolation(known)
    assert shares.rows == [["every failed thruster isolated", "38 of 39", "97.44 % (86.82 .. 99.55 %)"]]
    assert times.rows[0][1:] == ["s", "0.30 (0.23 .. 0.37)"]
    known.document = {}
    assert not margins.injected(known) and not list(margins.isolation(known))
