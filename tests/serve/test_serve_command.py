"""``edl6dof serve`` in a process of its own: where it listens, how it ends, what it refuses."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from in_process import called
from serving import Client, main

ROOT = Path(__file__).resolve().parents[2]
SHORT = ("serve", "tianwen1", "--set", "simulation.time_limit_s=5")


def test_it_says_where_it_listens_flies_and_ends_with_ctrl_c(monkeypatch, capsys):
    program = [sys.executable, "-c", "from edl6dof.cli import main; main()", *SHORT]
    pipe, environment = subprocess.PIPE, {**os.environ, "PYTHONPATH": str(ROOT)}
    process = subprocess.Popen(program, stdout=pipe, stderr=pipe, text=True, env=environment)
    try:
        host, _, port = process.stdout.readline().strip().partition(":")
        words, _, file = process.stdout.readline().strip().partition(": ")
        assert (host, words, process.stdout.readline()[:6]) == ("127.0.0.1", "token file", "Ctrl-C")
        assert Path(file).parent.stat().st_mode & 0o77 == 0
        token = Path(file).read_text()
        monkeypatch.setattr(sys, "argv", ["client.py", port, file])
        main()
        with Client(int(port), token, 120.0) as still_there:
            still_there.ask("step")
            process.send_signal(signal.SIGINT)
            out, err = process.communicate(timeout=120)
    finally:
        process.kill()
    assert (process.returncode, out, err) == (0, "", "")
    assert not Path(file).exists()
    said = capsys.readouterr().out.splitlines()
    assert [line.partition(",")[0] for line in said] == [
        "under no command: time limit at 5.00 s",
        "bank commanded: time limit at 5.00 s",
    ]


def test_a_scenario_that_is_wrong_is_refused_before_anything_is_served():
    done = called("serve", "tianwen1", "--set", "vehicle.mass.entry_kg=-1")
    assert (done.returncode, done.stdout) == (2, "")
    assert "vehicle.mass.entry_kg: must be > 0 kg (got -1)" in done.stderr


@pytest.mark.parametrize("port", ["-1", "65536", "ssh"])
def test_a_port_that_is_none_is_refused(port):
    done = called(*SHORT, "--port", port)
    assert done.returncode == 2
    assert "--port" in done.stderr


def test_without_msgpack_it_says_what_to_install(monkeypatch):
    def missing(name):
        raise ImportError(name)

    monkeypatch.setattr("edl6dof.api.arguments.import_module", missing)
    done = called(*SHORT)
    assert (done.returncode, done.stdout) == (69, "")
    assert done.stderr == "edl6dof serve needs msgpack: pip install 'edl6dof[serve]'\n"
