"""The second process of the first flight: started where it is of use, waited for, and never in the way."""

import os
import subprocess
import sys

import pytest

from edl6dof import jit
from edl6dof.sim import compile_ahead


@pytest.fixture
def started(monkeypatch):
    """Commands of the processes started, in a simulator that is not compiled on a machine with two cores."""
    commands, start = [], subprocess.Popen

    def popen(command, **options):
        commands.append(start([sys.executable, "-c", popen.body], **options))
        return commands[-1]

    popen.body = "raise SystemExit(1)"
    monkeypatch.setattr(jit, "is_cached", lambda kernel: False)
    monkeypatch.setattr(compile_ahead, "_cores", lambda: 2)
    monkeypatch.setattr(compile_ahead.subprocess, "Popen", popen)
    return commands, popen


def test_the_other_process_is_waited_for_even_if_it_fails(started, nominal):
    commands, _ = started
    with compile_ahead.flight_software_beside(nominal.scenario) as members:
        assert {"drag_tracking", "radar"} <= set(members)
    assert [process.returncode for process in commands] == [1]


def test_an_interrupted_flight_does_not_leave_the_other_process_behind(started, nominal):
    commands, popen = started
    popen.body = "import time; time.sleep(600)"
    with pytest.raises(KeyboardInterrupt), compile_ahead.flight_software_beside(nominal.scenario):
        raise KeyboardInterrupt
    assert commands[0].returncode not in (None, 0)


def test_the_other_process_has_the_same_plugins(started, nominal, monkeypatch, tmp_path):
    _, popen = started
    popen.body = f"import os; open({str(tmp_path / 'said')!r}, 'w').write(os.environ['EDL6DOF_PLUGINS'])"
    monkeypatch.setattr(jit, "outside_sources", {"/a/law.py": "x.py", "/b/sensor.py": "y.py"})
    with compile_ahead.flight_software_beside(nominal.scenario):
        pass
    assert (tmp_path / "said").read_text() == os.pathsep.join(["/a/law.py", "/b/sensor.py"])


@pytest.mark.parametrize("reason", ["compiled", "one core"])
def test_no_process_is_started_where_it_is_of_no_use(started, nominal, monkeypatch, reason):
    if reason == "compiled":
        monkeypatch.setattr(jit, "is_cached", lambda kernel: True)
    else:
        monkeypatch.setattr(compile_ahead, "_cores", lambda: 1)
    with compile_ahead.flight_software_beside(nominal.scenario) as members:
        assert members is None
    assert started[0] == []


@pytest.mark.parametrize("name", ["run", "sense"])
def test_what_is_compiled_ahead_is_for_the_records_that_fly(nominal, name):
    """Another layout would leave code in the cache that no flight ever asks for."""
    misses = getattr(compile_ahead, name).stats.cache_misses
    before = sum(misses.values())
    compile_ahead.compile_flight_software(["error_state", "radar"])
    assert sum(misses.values()) == before
