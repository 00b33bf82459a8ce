"""The second process of the first flight: started where it is of use, waited for, and never in the way."""

import os
import subprocess
import sys

import pytest

from edl6dof.kernels import cache
from edl6dof.sim import functions as compile_ahead


@pytest.fixture
def started(monkeypatch, tmp_path):
    """Commands of the processes started, in a simulator that is not compiled on a machine with two cores."""
    commands, start = [], subprocess.Popen

    def popen(command, **options):
        commands.append(start([sys.executable, "-c", popen.body], **options))
        return commands[-1]

    popen.body = "raise SystemExit(1)"
    monkeypatch.setattr(compile_ahead, "_mark", lambda: tmp_path / "mark")
    monkeypatch.setattr(compile_ahead, "_cores", lambda: 2)
    monkeypatch.setattr(compile_ahead.subprocess, "Popen", popen)
    return commands, popen


def test_the_other_process_is_waited_for_even_if_it_fails(started, nominal):
    commands, _ = started
    with compile_ahead.compiling_flight_software(nominal.scenario) as members:
        assert {"drag_tracking", "radar"} <= set(members)
    assert [process.returncode for process in commands] == [1]


def test_an_interrupted_flight_does_not_leave_the_other_process_behind(started, nominal):
    commands, popen = started
    popen.body = "import time; time.sleep(600)"
    with pytest.raises(KeyboardInterrupt), compile_ahead.compiling_flight_software(nominal.scenario):
        raise KeyboardInterrupt
    assert commands[0].returncode not in (None, 0)


def test_the_other_process_has_the_same_plugins(started, nominal, monkeypatch, tmp_path):
    _, popen = started
    popen.body = f"import os; open({str(tmp_path / 'said')!r}, 'w').write(os.environ['EDL6DOF_PLUGINS'])"
    monkeypatch.setattr(cache, "received", {"/a/law.py": b"x", "/b/sensor.py": b"y"})
    with compile_ahead.compiling_flight_software(nominal.scenario):
        pass
    assert (tmp_path / "said").read_text() == os.pathsep.join(["/a/law.py", "/b/sensor.py"])


def test_no_process_is_started_when_the_simulator_was_compiled(started, nominal):
    for compiles in (True, False):
        assert compile_ahead.is_compiled() != compiles
        with compile_ahead.compiling_flight_software(nominal.scenario) as members:
            assert (members is not None) == compiles
    assert len(started[0]) == 1


def test_one_core_compiles_alone(started, nominal, monkeypatch):
    monkeypatch.setattr(compile_ahead, "_cores", lambda: 1)
    with compile_ahead.compiling_flight_software(nominal.scenario) as members:
        assert "radar" in members
    assert started[0] == [] and compile_ahead.is_compiled()


def test_what_was_not_compiled_to_its_end_is_compiled_by_the_next(started, nominal):
    with pytest.raises(KeyboardInterrupt), compile_ahead.compiling_flight_software(nominal.scenario):
        raise KeyboardInterrupt
    assert not compile_ahead.is_compiled()


def test_what_is_compiled_ahead_is_for_the_records_that_fly(nominal):
    """Another layout would leave code in the cache that no flight ever asks for."""
    misses = compile_ahead.RUN.kernel.passed.stats.cache_misses
    before = sum(misses.values())
    compile_ahead.compile_flight_software(["error_state"])
    assert sum(misses.values()) == before
