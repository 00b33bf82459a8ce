"""The viewer's program ends with its parent, whatever ends that; and what it lacks is said."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import pytest

from edl6dof.cli.group import UNAVAILABLE
from edl6dof.cli.run_outputs import replay
from edl6dof.replay import viewer
from edl6dof.replay.viewer import HOST, NoViewer, ViewerFailed, free_port, running

ROOT = Path(__file__).parents[2]
WEB = ("--serve-web", "--web-viewer-port")


def listens(port: int) -> bool:
    with socket.socket() as probe:
        return probe.connect_ex((HOST, port)) == 0


def test_servers_listen_on_this_machine_only():
    """The web viewer answers on the loopback address and on no other address of this machine."""
    port, data = free_port(), free_port()
    with running(*WEB, str(port), "--port", str(data)) as started:
        started.wait_for(port)
        with open("/proc/net/tcp", encoding="ascii") as table:
            rows = [line.split() for line in table.readlines()[1:]]
        listening = {
            row[1].split(":")[0]
            for row in rows
            if row[3] == "0A" and int(row[1].split(":")[1], 16) in (port, data)
        }
        assert listening == {"0100007F"}
    assert not listens(port), "and it is gone afterwards"


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux ends a program with its parent")
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGKILL])
def test_the_program_ends_with_its_parent(number):
    port, data = free_port(), free_port()
    text = (
        "from edl6dof.replay.viewer import running\n"
        f"with running('--serve-web', '--web-viewer-port', '{port}', '--port', '{data}') as started:\n"
        f"    started.wait_for({port})\n    print('ready', flush=True)\n    input()\n"
    )
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    parent = subprocess.Popen(
        [sys.executable, "-c", text],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        env=environment,
    )
    with parent:
        assert parent.stdout.readline() == "ready\n"
        assert listens(port)
        parent.send_signal(number)
        parent.wait(timeout=10.0)
    end = time.monotonic() + 10.0
    while listens(port) and time.monotonic() < end:
        time.sleep(0.05)
    assert not listens(port)


@pytest.fixture
def pretended(tmp_path, monkeypatch):
    """A program that says something in place of the viewer and fails."""

    def pretend(said: str) -> None:
        script = tmp_path / "viewer"
        script.write_text(f"#!/bin/sh\ncat >&2 <<'END'\n{said}\nEND\nexit 3\n", encoding="utf-8")
        script.chmod(0o755)
        monkeypatch.setattr(viewer, "_path", lambda: script)

    return pretend


@pytest.mark.parametrize(
    ("said", "words"),
    [
        (
            "INFO fine\nthread 'main' panicked at 'Failed to get render context'\nstack backtrace:",
            "mesa-vulkan-drivers",
        ),
        (
            "thread 'main' panicked at 'Failed to create render state: CustomNativeAdapterSelectionError("
            '"No graphics adapter was found for the enabled graphics backends (Backends(VULKAN | GL))")\'',
            "mesa-vulkan-drivers",
        ),
        ("Error: winit EventLoopError: neither WAYLAND_DISPLAY nor DISPLAY is set.", "no display"),
        ("rerun: error while loading shared libraries: libfoo.so.1: cannot open", "libfoo.so.1"),
    ],
)
def test_what_the_machine_lacks_is_said(said, words, pretended, tmp_path):
    pretended(said)
    for action in (
        lambda: viewer.show(tmp_path),
        lambda: viewer.screenshot(tmp_path, tmp_path / "x.png", 1.0),
    ):
        with pytest.raises(NoViewer, match=words):
            action()


def test_another_failure_is_not_taken_for_a_missing_driver(pretended, tmp_path):
    pretended("INFO fine\nError: it hurts\nsee the manual")
    with pytest.raises(ViewerFailed, match="status 3: Error: it hurts") as caught:
        viewer.show(tmp_path)
    assert not isinstance(caught.value, NoViewer)


def test_no_display_is_said_in_one_line_with_status_1(tmp_path, monkeypatch, capsys):
    """The real viewer, on a machine (or in an environment) without a display."""
    for name in ("DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"):
        monkeypatch.delenv(name, raising=False)
    if sys.platform != "linux":
        pytest.skip("a window needs no such variable here")
    recording = tmp_path / "replay.rrd"
    recording.write_bytes(b"RRF2")
    assert replay([recording]) == UNAVAILABLE
    said = capsys.readouterr()
    assert said.out == "" and len(said.err.splitlines()) == 1
    assert "there is no display to open a window on; --web" in said.err
