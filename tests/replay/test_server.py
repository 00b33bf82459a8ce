"""``edl6dof replay --web``: who is served, and how it ends."""

from __future__ import annotations

import http.client
import os
import signal
import socket
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

import pytest
from live_page import opened, wait_until_it_plays

from edl6dof.api.replays import ended_by_signals
from edl6dof.replay.browser import PageServer, page

ROOT = Path(__file__).parents[2]
PAGE = b"<!doctype html><title>the page</title>"


@pytest.fixture
def server() -> Iterator[PageServer]:
    with PageServer(PAGE) as running:
        thread = threading.Thread(target=running.serve_forever, daemon=True)
        thread.start()
        yield running
        running.shutdown()


def ask(
    port: int, method: str = "GET", path: str = "/", hosts: list[str] | None = None
) -> tuple[int, bytes, dict[str, str]]:
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=10.0)
    connection.putrequest(method, path, skip_host=True)
    for host in [f"127.0.0.1:{port}"] if hosts is None else hosts:
        connection.putheader("Host", host)
    connection.endheaders()
    answer = connection.getresponse()
    return answer.status, answer.read(), dict(answer.getheaders())


def port_of(server: PageServer) -> int:
    return int(server.server_address[1])


@pytest.mark.parametrize("name", ["127.0.0.1", "localhost", "LocalHost", "[::1]"])
def test_this_machine_is_served_by_its_names(server, name):
    status, content, headers = ask(port_of(server), hosts=[f"{name}:{port_of(server)}"])
    assert (status, content) == (200, PAGE)
    assert headers["Cross-Origin-Resource-Policy"] == "same-origin"
    assert "Access-Control-Allow-Origin" not in headers


@pytest.mark.parametrize(
    "hosts",
    [
        ["evil.example:{port}"],
        ["evil.example"],
        ["127.0.0.1"],
        ["127.0.0.1:1"],
        ["localhost.evil.example:{port}"],
        ["127.0.0.1:{port}", "evil.example:{port}"],
        [""],
        [],
    ],
)
def test_a_request_for_another_host_is_refused(server, hosts):
    status, content, _ = ask(port_of(server), hosts=[host.format(port=port_of(server)) for host in hosts])
    assert status == 403
    assert PAGE not in content


@pytest.mark.parametrize("path", ["/x", "/../etc/passwd", "/replay.rrd", "http://evil.example/"])
def test_there_is_one_page_only(server, path):
    assert ask(port_of(server), path=path)[0] == 404


def test_other_methods_do_nothing(server):
    assert ask(port_of(server), "HEAD")[:2] == (200, b"")
    for method in ("POST", "PUT", "DELETE", "OPTIONS"):
        assert ask(port_of(server), method)[0] == 501


def test_a_client_that_hangs_up_is_no_error(server, capfd):
    with socket.create_connection(("127.0.0.1", port_of(server))) as client:
        client.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, b"\1\0\0\0\0\0\0\0")
        client.sendall(f"GET / HTTP/1.1\r\nHost: 127.0.0.1:{port_of(server)}\r\n".encode())
    assert ask(port_of(server))[0] == 200
    assert capfd.readouterr().err == ""


@contextmanager
def command(recording: Path) -> Iterator[tuple[subprocess.Popen[str], int]]:
    """``edl6dof replay --web`` without a display, and the port that it says."""
    environment = {
        name: value for name, value in os.environ.items() if name not in ("DISPLAY", "WAYLAND_DISPLAY")
    }
    words = [sys.executable, "-c", "from edl6dof.cli import main; main()", "replay", str(recording), "--web"]
    with subprocess.Popen(
        words, stdout=subprocess.PIPE, text=True, env={**environment, "PYTHONPATH": str(ROOT)}
    ) as process:
        try:
            line = process.stdout.readline()
            assert line.startswith("http://127.0.0.1:") and line.endswith("/\n")
            assert process.stdout.readline().startswith("Ctrl-C stops it")
            yield process, int(line.split("/")[2].split(":")[1])
        finally:
            process.kill()


#: What ends the programs that serve at once; the suite has time for one of them.
ENDS = ((signal.SIGINT,), pytest.param((signal.SIGTERM, signal.SIGINT), marks=pytest.mark.long))


@pytest.fixture(scope="module", params=ENDS, ids=["one", "two"])
def serving(request, recording):
    """Programs that serve a replay, with their ports and what shall end them."""
    with ExitStack() as stack:
        yield [(*stack.enter_context(command(recording)), end) for end in request.param]


def test_all_at_once_serve_the_replay(serving, server, recording):
    """The page that is drawn from a file in test_rendered.py."""
    ports = [port for _, port, _ in serving]
    assert len({port_of(server), *ports}) == 1 + len(ports)
    written = page(recording, "edl6dof replay: replay.rrd")
    assert b"wasm_bindgen" in written
    for port in ports:
        assert ask(port)[:2] == (200, written)
        assert ask(port, hosts=["evil.example"])[0] == 403


@pytest.mark.long
def test_the_served_page_plays(serving, tmp_path):
    port = serving[0][1]
    with opened(f"http://127.0.0.1:{port}/", tmp_path / "profile", (320, 240)) as browser:
        wait_until_it_plays(browser)
        assert browser.problems == []


def test_they_end_when_told_to(serving):
    for process, port, number in serving:
        process.send_signal(number)
        assert process.wait(timeout=10.0) == 0
        with socket.socket() as probe:
            assert probe.connect_ex(("127.0.0.1", port)) != 0


@pytest.mark.parametrize("name", ["SIGTERM", "SIGHUP"])
def test_other_ends_are_as_ctrl_c(name):
    number = getattr(signal, name)
    before = signal.signal(number, signal.SIG_DFL)
    try:
        with pytest.raises(KeyboardInterrupt), ended_by_signals():
            signal.raise_signal(number)
        assert signal.getsignal(number) is signal.SIG_DFL
    finally:
        signal.signal(number, before)
