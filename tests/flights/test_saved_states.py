"""A saved state is never trusted: it is refused in a clear line, or flown to a named end."""

from __future__ import annotations

import io
import json
import re
import subprocess
import sys
import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from edl6dof.config.dtype import duplicate
from edl6dof.config.errors import ConfigError
from edl6dof.records import first_not_finite, numbers
from edl6dof.sim.checkpoint import State
from edl6dof.sim.flight import continue_from, fly
from edl6dof.vehicle.plant import STATE

MOMENTS = (150.0, 300.0, 500.0)
RECORDS = ("plant", "peaks", "sensors", "fsw")


@pytest.fixture(scope="module")
def saved(nominal):
    return {t: fly(nominal.loaded, save_at_s=t).saved for t in MOMENTS}


@pytest.fixture
def state(saved):
    """A state that may be spoilt."""
    one = saved[300.0]
    return State(one.cycle, *(duplicate(getattr(one, name)) for name in RECORDS), one.scenario_text)


@pytest.fixture
def path(tmp_path):
    return tmp_path / "state.npz"


def complaint(state, path):
    state.save(path)
    with pytest.raises(ConfigError) as caught:
        State.load(path)
    return str(caught.value)


def repacked(path, **members):
    """The file with other members; ``None`` takes one out."""
    with zipfile.ZipFile(path) as archive:
        data = {name: archive.read(name) for name in archive.namelist()}
    for name, content in members.items():
        data[f"{name}.npy"] = content
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in data.items():
            if content is not None:
                archive.writestr(name, content)


def npy(array):
    buffer = io.BytesIO()
    np.save(buffer, array)
    return buffer.getvalue()


def refused(path):
    with pytest.raises(ConfigError) as caught:
        State.load(path)
    return str(caught.value)


@pytest.mark.parametrize(("first", "last"), [(60, 140), pytest.param(0, 240, marks=pytest.mark.long)])
def test_corrupted_states_are_refused_or_flown(saved, tmp_path, first, last):
    """About one seed in fifteen gives a state that can be flown; the test asks for more than one in fifty."""
    files = []
    for t, one in saved.items():
        files.append(str(tmp_path / f"at_{t:.0f}.npz"))
        one.save(Path(files[-1]))
    command = [sys.executable, str(Path(__file__).with_name("corrupted.py")), str(first), str(last)]
    done = subprocess.run([*command, *files], capture_output=True, text=True, timeout=300)
    lines = [json.loads(line) for line in done.stdout.splitlines()]
    assert done.returncode == 0, (lines[-1], done.stderr[-2000:])
    ends = {number: (kind, words) for number, _, kind, words in lines}
    assert len(ends) == last - first
    kinds = [kind for kind, _ in ends.values()]
    # both happen often enough for the test to mean something
    assert kinds.count("refused") > 15 and kinds.count("flown") > len(kinds) // 50
    assert all(words and "flying" not in words for _, words in ends.values())


@pytest.mark.parametrize("value", [-(10**6), -1, 10**6])
@pytest.mark.parametrize("record", RECORDS)
def test_every_whole_number_out_of_range_is_named(state, path, record, value):
    """All of them at once: each has its line."""
    spoilt = []
    for field in numbers(getattr(state, record)):
        if not field.is_whole or field.declared["low"] <= value <= field.declared["high"]:
            continue
        if not np.iinfo(field.values.dtype).min <= value <= np.iinfo(field.values.dtype).max:
            continue  # no file can say so
        field.values.flat[-1] = value
        spoilt.append(field)
    if not spoilt:
        return
    lines = complaint(state, path).splitlines()
    for field in spoilt:
        words = next(line for line in lines if re.search(rf"{record}\.{re.escape(field.path)}\b", line))
        assert f"must be {field.declared['low']} .. {field.declared['high']} (got {value})" in words


@pytest.mark.parametrize("record", RECORDS)
def test_every_float_that_is_not_finite_is_named(state, path, record):
    """Each by what looks at a record, the first and the last of them in a file too."""
    floats = [field for field in numbers(getattr(state, record)) if must_be_finite(field)]
    for field in floats:
        values = field.values.flat
        before, values[0] = values[0], np.nan
        assert re.fullmatch(rf"{re.escape(field.path)}(\[.*\])?", first_not_finite(getattr(state, record)))
        if field in (floats[0], floats[-1]):
            assert f"{record}.{field.path}" in complaint(state, path)
        values[0] = before


def must_be_finite(field):
    return not field.is_whole and "if_ever" not in field.declared


@pytest.mark.parametrize("cycle", [-1, 10**9])
def test_cycle_out_of_range_is_named(state, path, cycle):
    assert "cycle: must be 0 .. " in complaint(replace(state, cycle=cycle), path)


def test_isolated_fault_of_no_kind_is_named(state, path):
    state.fsw["diagnosis"]["n_isolated"] = 1
    assert "fsw.diagnosis.isolated.kind[0]: must be one of 1, 2, 3 (got 0)" in complaint(state, path)


def test_archive_that_unpacks_to_gigabytes_is_not_unpacked(state, path):
    state.save(path)
    repacked(path, scenario=bytes(3_000_000))
    assert path.stat().st_size < 100_000
    assert "is not a state saved by" in refused(path)


def test_member_that_claims_an_enormous_shape_is_refused(state, path):
    state.save(path)
    honest = npy(np.zeros(9, np.uint8))
    repacked(path, plant=honest.replace(b"(9,), }" + b" " * 12, b"(9999999999999,), }"))
    assert "is not a state saved by" in refused(path)


@pytest.mark.parametrize("name", [*RECORDS, "cycle", "scenario", "layout"])
def test_missing_member_is_refused(state, path, name):
    state.save(path)
    repacked(path, **{name: None})
    assert "is not a state saved by" in refused(path)


@pytest.mark.parametrize(
    "array", [np.zeros(STATE.itemsize // 8), np.zeros(STATE.itemsize - 1, np.uint8), np.zeros((2, 3))]
)
def test_record_of_another_form_is_refused(state, path, array):
    state.save(path)
    repacked(path, plant=npy(array))
    assert "is not a state saved by" in refused(path)


def test_scenario_that_is_no_text_is_refused(state, path):
    state.save(path)
    repacked(path, scenario=npy(np.frombuffer(b"name: \xff\xfe", np.uint8)))
    assert "not UTF-8 (byte 6)" in refused(path)


def test_enormous_file_is_not_read(path):
    with path.open("wb") as file:
        file.truncate(17_000_000)
    assert "at most 16000000 are allowed" in refused(path)


def test_state_never_loads_code(state, path, tmp_path):
    code = tmp_path / "evil.py"
    code.write_text(f"open({str(tmp_path / 'ran')!r}, 'w')\n")
    replace(state, scenario_text=f"plugins: [{code}]\n{state.scenario_text}").save(path)
    loaded = State.load(path)
    with pytest.raises(ConfigError):
        continue_from(loaded)
    text = state.scenario_text.replace("plugins: []", f"plugins: [{code}]")
    assert text != state.scenario_text
    with pytest.raises(ConfigError, match="comes too late"):
        continue_from(replace(state, scenario_text=text))
    assert not (tmp_path / "ran").exists()


def test_fewer_phases_than_the_state_has_flown_are_refused(saved):
    state = saved[500.0]
    few = continue_from(state, ("mission.phases=[{name: falling}]",))
    with pytest.raises(
        ConfigError, match=r"fsw.mission.phase: does not fit the scenario: must be 0 .. 0 \(got [56]\)"
    ):
        fly(few, start=state)


def test_thrusters_that_the_state_knows_must_exist(saved):
    state = saved[300.0]
    without = (
        "vehicle.rcs.thrusters=[]",
        "vehicle.rcs.branches=[]",
        "flight_software.check_out.thrusters=[]",
    )
    none = continue_from(state, without)
    with pytest.raises(ConfigError, match="does not fit the scenario"):
        fly(none, start=state)


def test_another_base_rate_is_refused(saved):
    state = saved[300.0]
    other = continue_from(state, ("flight_software.rates.base_hz=100", "simulation.step_s=0.01"))
    with pytest.raises(ConfigError, match="base_hz: does not fit the scenario"):
        fly(other, start=state)


def test_other_thrusters_act_from_where_they_now_are(saved):
    """What was worked out from the old places is forgotten: the flight is that of a state which never knew
    them.
    """
    state = saved[500.0]
    moved = continue_from(state, ("vehicle.rcs.thrusters.0.position_m=[-1.3, 1.0, 0.4]",))
    first = fly(moved, start=state)
    unknowing = replace(state, fsw=duplicate(state.fsw))
    unknowing.fsw["effectiveness"]["matrix"] = 0.0
    unknowing.fsw["allocation"]["method"]["least_squares"]["gram"] = 0.0
    assert fly(moved, start=unknowing).plant["y"].tobytes() == first.plant["y"].tobytes()


def test_state_beyond_the_time_limit_ends_at_once_and_says_so(saved):
    state = saved[300.0]
    flight = fly(continue_from(state, ("simulation.time_limit_s=100",)), start=state)
    assert flight.outcome == "time limit in phase parachute"
    assert len(flight.log) == 1
    assert flight.attitude(300.0).norm == pytest.approx(1.0)
