"""A matrix of faults: its cells, moments and vehicles; what interrupts it, and what never joins it."""

from __future__ import annotations

import contextlib
import io
import json
import signal
import sys
import time
from pathlib import Path

import in_process
import numpy as np
import pytest
from campaign_run import write_drop
from forked import Forked

import edl6dof
from edl6dof.api.campaign import _continued, chosen_engine
from edl6dof.campaign import executor, fault_choice
from edl6dof.campaign.design.plan import load_plan, parse_plan
from edl6dof.campaign.fault_choice import FaultRequest, matrix_of, moments_at
from edl6dof.campaign.faults import matrix_plan
from edl6dof.campaign.store import Store
from edl6dof.config.errors import ConfigError
from edl6dof.scenario.loading import load_scenario
from edl6dof.vehicle.faults.instrument import ReadingBiasParams

#: Falls that last a moment: two thrusters, three kinds of fault, four moments.
WORDS = ("--at", "0.5,every 0.5", "--kinds", "all", "--components", "A1,D3", "--workers", "1")


def command(*words: str) -> tuple[int, str, str]:
    """Status, stdout and stderr of the program in this process."""
    out, err = io.StringIO(), io.StringIO()
    with (
        pytest.MonkeyPatch.context() as patch,
        contextlib.redirect_stdout(out),
        contextlib.redirect_stderr(err),
        pytest.raises(SystemExit) as end,
    ):
        patch.setattr(sys, "argv", ["edl6dof", *words])
        in_process.main()
    return int(end.value.code or 0), out.getvalue(), err.getvalue()


@pytest.fixture
def here(tmp_path, monkeypatch):
    """A folder of its own, in which the program runs."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture(scope="module")
def tianwen1():
    return load_scenario("tianwen1")


def plan(wanted, scenario="tianwen1", sets=(), vehicles=None, seed=None):
    loaded = load_scenario(scenario, sets)
    return matrix_plan(scenario, matrix_of(loaded, FaultRequest(**wanted)), sets, vehicles, seed)


def test_moments_are_times_intervals_and_events_of_the_nominal_flight(tianwen1, nominal):
    found = {
        one.name: one.at.time_s for one in moments_at("mortar, 129.5,every 100 s,bank_reversal", tianwen1)
    }
    assert list(found.values()) == sorted(found.values())
    times = [found.pop(f"{k} s") for k in (0, 100, 200, 300, 400, 500)]
    assert times == [0.0, 100.0, 200.0, 300.0, 400.0, 500.0]  # touchdown is before 600 s
    assert found.pop("129.5 s") == 129.5 and found.pop("mortar") == nominal.figures["parachute_s"]
    reversals = [event["t_s"] for event in nominal.events if event["key"] == "bank_reversal"]
    assert len(reversals) > 1
    assert found == {f"bank_reversal {k}": t for k, t in enumerate(reversals, start=1)}


def test_an_event_that_does_not_happen_is_refused():
    loaded = load_scenario("tianwen1", ["simulation.time_limit_s=20"])
    with pytest.raises(ConfigError) as caught:
        moments_at("mortar,touchdown,every 5", loaded)
    assert str(caught.value).splitlines() == [
        "--at: there is no mortar in the nominal flight",
        "--at: there is no touchdown in the nominal flight",
    ]


def test_every_two_thrusters_make_a_cell_that_names_both():
    pairs = plan(dict(pairs=True, kinds="stuck_off,degraded", at="450,500"))
    assert pairs.count == 231 * 2 * 2
    cases = list(pairs.cases())
    assert [case.index for case in cases] == list(range(pairs.count))
    labels = [tuple(case.label.values()) for case in cases]
    assert len(set(labels)) == pairs.count and labels[0] == ("D1 + D2", "stuck_off", "450 s")
    for case in (cases[0], cases[-1]):
        names = " + ".join(fault["thruster"] for fault in case.truth["faults"])
        kinds = {(fault["kind"], fault["at"]["time_s"]) for fault in case.truth["faults"]}
        assert names == case.label["component"] and len(kinds) == 1


def test_every_cell_is_flown_on_the_same_dispersed_vehicles_and_on_no_fault_of_the_campaign(tmp_path):
    file = tmp_path / "c.yaml"
    lost = "{chance: 1.0, one_of: [{kind: wing_lost, at: {time_s: 0}}]}"
    file.write_text(f"extends: tianwen1_mc\ncampaign:\n  faults: [{lost}]\n")
    dispersed = plan(dict(components="D1,D2", at="60"), str(file), vehicles=3, seed=9)
    first, second = (
        [{path: value for path, value in case.truth.items() if path != "faults"} for case in cases]
        for cases in (dispersed.cases(0, 3), dispersed.cases(3, 6))
    )
    assert dispersed.count == 6 and first == second and len(first[0]) > 20 and first[0] != first[1]
    assert [case.profile for case in dispersed.cases()] == [0, 1, 2, 0, 1, 2]
    faults = [case.truth["faults"] for case in dispersed.cases()]
    assert [[fault["thruster"] for fault in some] for some in faults] == [["D1"]] * 3 + [["D2"]] * 3
    other = plan(dict(components="D1,D2", at="60"), str(file), vehicles=3, seed=10)
    assert next(other.cases()).truth != next(dispersed.cases()).truth
    nominal = plan(dict(components="D1,D2", at="60"), str(file))
    assert nominal.count == 2 and set(next(nominal.cases()).truth) == {"faults"}


def test_plan_written_out_gives_the_same_cells(tmp_path):
    first = plan(dict(kinds="all", at="60,129.5", pairs=True), "tianwen1_mc", vehicles=2)
    again = parse_plan(first.text, "again")
    assert again.text == first.text and list(again.cases(500, 520)) == list(first.cases(500, 520))


def test_each_reading_of_an_instrument_is_swept_alone_in_equal_ratios():
    swept = plan(dict(sensors=True, kinds="reading_bias,reading_outage", components="b1,g2", at="60"))
    faults = [(case.label, case.truth["faults"][0]) for case in swept.cases()]
    assert [fault["kind"] for _, fault in faults] == ["reading_bias"] * 21 + ["reading_outage"] * 2
    for names, some in (("rate_deg_s", faults[:7]), ("range_m", faults[7:14]), ("speed_m_s", faults[14:21])):
        sizes = np.array([fault["reading_bias"][names] for _, fault in some])
        assert sizes[0] == getattr(ReadingBiasParams(), names)
        np.testing.assert_allclose(sizes[:-1] / sizes[1:], 10.0 ** (1.0 / 3.0), rtol=5e-3)
        assert [label["size"] for label, _ in some] == [f"{names}={size:g}" for size in sizes]
    assert all(fault["reading_bias"]["range_m"] == 0.0 for _, fault in faults[14:21])
    assert all("size" not in label for label, _ in faults[21:])


def test_a_parameter_that_a_kind_of_fault_does_not_have_is_refused(tmp_path):
    group = "{kind: reading_bias, component: gyro, names: [g1], moments: [{name: b, at: {time_s: 1.0}}], "
    file = tmp_path / "m.yaml"
    group += "settings: {reading_bias: {rate_deg: 1.0}}}"
    file.write_text(f"extends: tianwen1\nfault_matrix: {{groups: [{group}]}}\n")
    with pytest.raises(ConfigError, match=r"fault_matrix\.groups\.0\.settings\.reading_bias\.rate_deg: "):
        load_plan(str(file))


def test_settings_are_those_of_every_fault_of_the_matrix():
    settings = "{degraded: {flow_factor: 1.0}, duration_s: 20.0}"
    some = plan(dict(kinds="degraded", components="D1,D2", at="60", settings=settings))
    for case, name in zip(some.cases(), ("D1", "D2"), strict=True):
        [fault] = case.truth["faults"]
        assert fault["thruster"] == name and fault["duration_s"] == 20.0
        assert fault["degraded"]["flow_factor"] == 1.0


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ("{duration_s: -1}", "fault_matrix.groups.0.settings.duration_s: must be > 0 s (got -1)"),
        ("{slow: {rise_s: 1}, x: 2}", "fault_matrix.groups.0.settings.x: unknown"),
        ("12", "--with: must be keys of a fault, such as 'duration_s: 20' (got 12)"),
        ("{a: [", "--with: must be keys of a fault"),
    ],
)
def test_settings_that_cannot_be_are_refused_at_their_key(settings, words):
    with pytest.raises(ConfigError) as caught:
        plan(dict(components="D1", at="60", settings=settings))
    assert words in str(caught.value)


def test_a_cell_that_cannot_be_is_refused(tmp_path):
    text = """
fault_matrix:
  together: 2
  groups:
    - {kind: stuck_off, component: thruster, names: [A1, A9], moments: [{name: soon, at: {time_s: 1.0}}]}
    - {kind: stuck_off, component: surface, names: [trim_wing, x], moments: [{name: b, at: {time_s: 1.0}}]}
    - {kind: stuck_on, component: thruster, names: [A1], moments: [{name: b, at: {time_s: 1.0}}]}
"""
    file = Path(write_drop(tmp_path))
    file.write_text(file.read_text() + text)
    with pytest.raises(ConfigError) as caught:
        load_plan(str(file))
    lines = [line[line.index("fault_matrix") :] for line in str(caught.value).splitlines()]
    assert [line[: len("fault_matrix.groups.0: ")] for line in lines] == [
        f"fault_matrix.groups.{k}: " for k in (0, 1, 1, 2)
    ]
    assert "no thruster named 'A9'; names: " in lines[0] and "stuck_off is about one thruster" in lines[1]
    assert lines[3].endswith("names 1 of the 2 that fail together")


def test_killed_matrix_goes_on_to_the_same_table(here):
    words = ("faults", write_drop(here), *WORDS, "-n", "14")
    running = Forked(*words, "--out", "m", cwd=here)
    deadline = time.monotonic() + 120.0
    while not list(here.glob("m/parts/*.parquet")) and time.monotonic() < deadline:
        time.sleep(0.002)
    running.send_signal(signal.SIGKILL)
    running.communicate(timeout=30)
    assert list(here.glob("m/parts/*.parquet")) and not (here / "m" / "cases.parquet").exists()
    assert "go on with --resume" in command(*words, "--out", "m")[2]
    status, out, err = command(*words, "--out", "m", "--resume")
    assert status == 0 and "336 flights within limits" in out, err
    assert command(*words, "--out", "undisturbed")[0] == 0
    tables = [(here / name / "cases.parquet").read_bytes() for name in ("m", "undisturbed")]
    assert tables[0] == tables[1]
    status, out, _ = command("faults", "m", "--resume", "--json")
    assert status == 0 and json.loads(out)["all"]["flights"] == len(json.loads(out)["rows"]) == 336


def test_what_flies_another_matrix_does_not_join_a_folder(here):
    words = ("faults", write_drop(here), "--components", "A1,D3", "--at", "0.5", "-n", "1", "--out", "m")
    assert command(*words)[0] == 0
    before = (here / "m" / "cases.parquet").read_bytes()
    for changed in (
        ("--at", "0.5,1.5"),
        ("--seed", "4"),
        ("-n", "2"),
        ("--set", "vehicle.mass.entry_kg=1290"),
        ("--pairs",),
        ("--kinds", "stuck_on"),
    ):
        status, _, err = command(*words, *changed, "--resume")
        other = "m: was begun with another plan; go on with it by: edl6dof faults m --resume"
        assert status == 2 and other in err
        assert command(*words, *changed)[0] == 2
        status, _, err = command("faults", "m", *changed, "--resume")
        assert status == 2 and "has its plan; it accepts no other values" in err
    assert (here / "m" / "cases.parquet").read_bytes() == before


@pytest.mark.parametrize("given", [0, 0.0, "D7", ("seed=3",), True])
def test_a_campaign_that_goes_on_takes_no_value_not_even_zero(given):
    engine = chosen_engine()
    _continued("m", engine, None, (), "", False)
    with pytest.raises(ConfigError, match="m: has its plan; it accepts no other values"):
        _continued("m", engine, None, given)


@pytest.mark.parametrize("owner, name", [(fault_choice, "matrix_of"), (executor.CaseRunner, "prepared")])
def test_interruption_tells_how_to_go_on(here, monkeypatch, owner, name):
    def interrupt(*_, **__):
        raise KeyboardInterrupt

    words = ("faults", write_drop(here), "--components", "A1,D3", "--at", "0.5")
    begun = owner is executor.CaseRunner
    go_on = "interrupted; what has flown is kept; go on with: edl6dof faults "
    with monkeypatch.context() as patch:
        patch.setattr(owner, name, interrupt)
        status, _, err = command(*words)
        assert status == 130
        assert err == (
            f"{go_on}runs/faults-drops --resume\n" if begun else "interrupted; nothing was written\n"
        )
        status, _, err = command(*words, "--resume")
        assert (status, begun or err == f"{go_on}{words[1]} --resume\n") == (130, True)
    assert command(*words, *["--resume"] * begun)[0] == 0


@pytest.mark.long
def test_row_has_the_bits_of_the_same_fault_flown_alone(here):
    """Among other cells, after another in the same thread; the fault comes and goes at random."""
    words = ("--kinds", "stuck_off", "--components", "D5,F3", "--at", "129.5", "--workers", "1", "--out", "m")
    assert command("faults", "tianwen1", *words, "--with", "{presence: 0.5}")[0] in (0, 1)
    row = Store(Path("m")).table().to_pylist()[1]
    fault = "{thruster: F3, kind: stuck_off, presence: 0.5, at: {time_s: 129.5}}"
    alone = edl6dof.fly("tianwen1", [f"faults=[{fault}]"])
    assert row["component"] == "F3" and row["outcome"] == alone.outcome and row["end_s"] == alone.time_s
    assert {name: row[name] for name in alone.figures} == alone.figures
    status, out, _ = command("refly", "m", "1", "--no-replay")
    assert status == 0 and "identical to its row" in out
