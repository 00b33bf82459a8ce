"""The example in C, compiled and flown: flight software of its own lands the lander."""

import re
import shutil
import socket
import subprocess

import pytest
from serving import EXAMPLES, serving

COMPILER = shutil.which("cc")
pytestmark = pytest.mark.skipif(COMPILER is None, reason="no C compiler on this machine")


@pytest.fixture(scope="module")
def lander(tmp_path_factory):
    program = tmp_path_factory.mktemp("lander") / "lander"
    flags = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-O1"]
    subprocess.run([COMPILER, *flags, "-o", program, EXAMPLES / "lander.c", "-lm"], check=True, timeout=120)
    return program


def flown(program, *words):
    return subprocess.run([program, *map(str, words)], capture_output=True, text=True, timeout=300)


def test_it_lands_by_its_own_guidance(lander, nominal, tmp_path):
    """It does not hover as the flight software does, and is down half a minute earlier."""
    with serving("tianwen1") as server:
        (tmp_path / "token").write_text(server.token)
        done = flown(lander, server.port, tmp_path / "token")
    assert (done.returncode, done.stderr) == (0, ""), done
    found = re.search(r"landed at ([\d.]+) s, ([\d.]+) kg left", done.stdout)
    own = next(event["t_s"] for event in nominal.events if event.get("phase") == "landed")
    assert own - 50.0 < float(found[1]) < own - 20.0
    assert 850.0 < float(found[2]) < 900.0


def test_it_tells_what_the_server_refuses(lander, server, tmp_path):
    (tmp_path / "token").write_text(server.token)
    done = flown(lander, server.port, tmp_path / "token", 2**31)
    assert (done.returncode, done.stdout) == (1, "")
    assert done.stderr.startswith("lander: seed must be a whole number from 0 to 2147483647")


def test_it_tells_that_nobody_serves(lander):
    with socket.socket() as silent:
        silent.bind(("127.0.0.1", 0))  # taken, so that nobody else listens there meanwhile
        done = flown(lander, silent.getsockname()[1], "token")
    assert (done.returncode, done.stderr) == (1, "lander: nobody serves flights at this port\n")
