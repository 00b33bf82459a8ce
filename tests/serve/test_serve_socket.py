"""Flights over a socket are the flights; whatever else comes through it is answered or cut off."""

import os
import random
import re
import socket
import struct
import time
from contextlib import suppress
from pathlib import Path

import msgpack
import pytest
from serving import Client, serving

import edl6dof
from edl6dof.serve import flight_server
from edl6dof.sim.checkpoint import State
from edl6dof.sim.flight import fly

WAIT_S = 120.0
ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def client(server):
    with Client(server.port, server.token, WAIT_S) as connected:
        connected.ask("reset")
        yield connected


@pytest.fixture
def line(server):
    with greeted(server) as raw:
        yield raw


def greeted(server):
    """A connection that has sent the token."""
    raw = socket.create_connection(("127.0.0.1", server.port), WAIT_S)
    raw.sendall(server.token.encode())
    return raw


def flown_to_the_end(client, portions):
    """The state at the end of a flight that is flown in portions of cycles, over and over."""
    while True:
        for cycles in portions:
            if not client.ask("step", cycles=cycles)["flying"]:
                return State.unpacked(client.ask("state")["state"], "state")


def same(state, flight):
    return all(getattr(state, name).tobytes() == getattr(flight, name).tobytes() for name in ("plant", "fsw"))


def test_the_whole_flight_over_the_socket_is_the_flight(client, nominal):
    assert same(flown_to_the_end(client, [1, 49]), nominal)


def test_two_clients_fly_side_by_side_each_its_own_flight(nominal):
    short = "simulation.time_limit_s=75"
    with (
        serving("tianwen1", short) as server,
        Client(server.port, server.token, WAIT_S) as one,
        Client(server.port, server.token, WAIT_S) as two,
    ):
        one.ask("reset")
        two.ask("reset", seed=9)
        for _ in range(3):
            one.ask("step", cycles=100)
            two.ask("step", cycles=1000, command={"bank_deg": 90.0})
        for _ in range(100):
            one.ask("step")
        assert same(flown_to_the_end(one, [7]), fly(edl6dof.load("tianwen1", [short])))


def test_requests_sent_in_one_go_are_answered_in_their_order(client):
    bodies = [msgpack.packb({"do": "step", "cycles": cycles}) for cycles in (1, 2, 3)]
    client.line.sendall(b"".join(struct.pack(">I", len(body)) + body for body in bodies))
    assert [client.answer()["cycle"] for _ in bodies] == [1, 3, 6]


def bytes_in_the_document():
    """What is sent and answered in the first exchange of docs/serve.md."""
    said = {">": b"", "<": b""}
    block = (ROOT / "docs" / "serve.md").read_text(encoding="utf-8").partition("## An exchange in bytes")[2]
    for part in re.findall(r"(?m)^    ([<>].*(?:\n      .*)*)", block)[:2]:
        for line in part[1:].splitlines():
            said[part[0]] += bytes.fromhex(re.match(r"[\s0-9a-f]*(?=\s|$)", line)[0])
    return said


def test_the_exchange_of_the_document_is_what_goes_over_the_wire(client):
    client.ask("step", cycles=2)
    said = bytes_in_the_document()
    client.line.sendall(said[">"])
    assert client.line.recv(4096) == said["<"]


def test_close_ends_the_connection(client):
    assert client.ask("close") == {"ok": True}
    with pytest.raises(ConnectionError):
        client.answer()


def answer_to(line, body):
    line.sendall(struct.pack(">I", len(body)) + body)
    return received(line)


def received(line):
    file = line.makefile("rb")
    return msgpack.unpackb(file.read(struct.unpack(">I", file.read(4))[0]))


STEP = msgpack.packb({"do": "step"})
BROKEN = {
    "nothing": (b"", "no MessagePack"),
    "truncated": (STEP[:-1], "no MessagePack"),
    "too_much": (STEP + b"\x00", "no MessagePack"),
    "never_used": (b"\xc1", "no MessagePack"),
    "noise": (random.Random(1).randbytes(200), "no MessagePack"),
    "not_utf8": (b"\x81\xa2do\xa4\xff\xfe\xfd\xfc", "a text is not UTF-8"),
    "key_not_utf8": (b"\x81\xa2\xff\xff\x01", "a text is not UTF-8"),
    "whole_number": (b"\x07", "a request is a map"),
    "extension": (b"\x81\xa2do\xd4\x05\x00", "no MessagePack"),
    "timestamp": (b"\x81\xa2do\xd6\xff\x00\x00\x00\x00", "no MessagePack"),
    "number_as_key": (b"\x81\x01\x02", "no MessagePack"),
    "deep": (b"\x81\xa2do" + b"\x91" * 100_000 + b"\x00", "no MessagePack"),
    "nested": (b"\x81\xa2do" + b"\x91" * 300 + b"\x00", "at most 256 lists and maps"),
    "many": (b"\x81\xa2do\xdc\x03\xe8" + b"\x90" * 1000, "at most 256 lists and maps"),
    "long": (b"\x81\xa2do\xdd\x00\x10\x00\x00" + b"\xc0" * 2**20, "no MessagePack"),
    "said_to_be_long": (b"\x81\xa2do\xdd\xff\xff\xff\xff", "no MessagePack"),
    "text_said_to_be_long": (b"\x81\xa2do\xdb\xff\xff\xff\xff", "no MessagePack"),
}


@pytest.mark.parametrize("name", BROKEN)
def test_a_message_that_is_none_is_answered_and_the_next_one_done(line, name, capfd):
    body, words = BROKEN[name]
    answer = answer_to(line, body)
    assert not answer["ok"]
    assert words in answer["error"]
    assert answer_to(line, STEP)["cycle"] == 1
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize("head", [b"\xff\xff\xff\xff", b"\x01\x00\x00\x01", b"GET / HTTP/1.1\r\n\r\n"])
def test_a_length_that_no_message_has_ends_the_connection(line, head, capfd):
    line.sendall(head)
    answer = received(line)
    assert "a message has at most 16777216 bytes" in answer["error"]
    assert line.recv(1) == b""
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize("sent", [b"", b"\x00\x00", b"\x00\x00\x00\x64half", b"\x00\x00\x00\x09" + STEP])
def test_a_client_that_hangs_up_leaves_its_place(server, sent, capfd):
    """More often than there are places: they would run out."""
    for _ in range(10):
        with greeted(server) as raw:
            raw.sendall(sent)
    wait_for_places(server)
    assert capfd.readouterr().err == ""


def wait_for_places(server):
    """Until a client gets one again: those that hung up leave when the server sees it."""
    end = time.monotonic() + WAIT_S
    while True:
        with Client(server.port, server.token, WAIT_S) as client:
            try:
                return client.ask("describe")
            except (ValueError, ConnectionError):
                assert time.monotonic() < end


def test_a_ninth_client_is_told_to_come_back():
    from contextlib import ExitStack

    with serving("tianwen1") as server, ExitStack() as stack:
        clients = [stack.enter_context(Client(server.port, server.token, WAIT_S)) for _ in range(8)]
        for client in clients:
            client.ask("step")
        with (
            Client(server.port, server.token, WAIT_S) as ninth,
            pytest.raises(ValueError, match="8 clients fly already"),
        ):
            ninth.ask("describe")
        clients[3].ask("close")
        wait_for_places(server)


def test_a_thousand_mutated_requests_get_an_answer_each(line, capfd):
    rng = random.Random(7)
    sound = [
        msgpack.packb(request)
        for request in (
            {"do": "step", "cycles": 3, "observe": ["mach"], "command": {"bank_deg": 20.0}},
            {
                "do": "step",
                "command": {"thrust_n": [1.0, 2.0, 3.0], "duties": {"D7": 1.0}, "isolate": ["D1"]},
            },
            {"do": "observe", "names": True},
            {"do": "restore", "state": b"PK\x03\x04"},
            {"do": "describe"},
        )
    ]
    answered = []
    for _ in range(1000):
        body = bytearray(rng.choice(sound))
        for _ in range(rng.randint(1, 4)):
            body[rng.randrange(len(body))] = rng.randrange(256)
        answer = answer_to(line, bytes(body))
        assert answer["ok"] or answer["error"]
        assert "defect" not in answer.get("error", "")
        answered.append(answer["ok"])
    assert 0 < sum(answered) < 1000
    assert capfd.readouterr().err == ""


def test_a_defect_is_called_one_and_the_server_lives_on(line, monkeypatch, capfd):
    monkeypatch.setattr("edl6dof.serve.session.Session._standing", lambda self: 1 // 0)
    assert "a defect of the program" in answer_to(line, STEP)["error"]
    assert "ZeroDivisionError" in capfd.readouterr().err
    monkeypatch.undo()
    assert answer_to(line, STEP)["ok"]


def test_a_port_that_is_taken_is_refused(server):
    from edl6dof.serve.flight_server import FlightServer

    with pytest.raises(edl6dof.ConfigError, match="--port: .* cannot be had: Address already in use"):
        FlightServer(lambda: None, server.port)


def refusal(raw):
    return received(raw)["error"]


@pytest.mark.parametrize("sent", [b"", b"x" * 32, b"\x00\x00\x00\x0b" + STEP + b"more than that....."])
def test_whoever_has_no_token_is_told_so_and_flies_nothing(sent):
    begun = []
    with serving("tianwen1") as server:
        server.begin = lambda: begun.append(1)
        with socket.create_connection(("127.0.0.1", server.port), WAIT_S) as raw:
            raw.sendall(sent)
            assert "token" in refusal(raw)
    assert not begun


def test_silent_strangers_take_no_place():
    """More of them than there are places; eight blocked the server for ever."""
    with serving("tianwen1") as server:
        silent = [socket.create_connection(("127.0.0.1", server.port), WAIT_S) for _ in range(12)]
        with Client(server.port, server.token, WAIT_S) as client:
            assert client.ask("describe")["ok"]
        assert all(refusal(raw) == "no token within 5 s" for raw in silent)
        for raw in silent:
            raw.close()


def test_client_that_falls_silent_loses_its_place():
    with serving("tianwen1", idle_s=0.3) as server:
        silent = [Client(server.port, server.token, WAIT_S) for _ in range(8)]
        for client in silent:
            assert "silent for too long" in client.answer()["error"]
            client.close()
        wait_for_places(server)


def test_message_that_drips_is_not_waited_for(monkeypatch):
    monkeypatch.setattr(flight_server, "_MESSAGE_S", 0.5)
    with serving("tianwen1") as server, greeted(server) as raw:
        raw.sendall(struct.pack(">I", 1000))
        began = time.monotonic()
        with suppress(ConnectionError):
            while time.monotonic() < began + 3.0:
                raw.sendall(b"x")
                time.sleep(0.05)
        assert "silent for too long" in refusal(raw)


@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="this system does not tell")
def test_flights_that_are_closed_leave_no_memory():
    """Their records were kept until Python happened to look: 1.3 GB after some hundred."""

    def resident_mb():
        return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 2**20

    with serving("tianwen1") as server:
        for count in range(60):
            if count == 20:
                before = resident_mb()
            with Client(server.port, server.token, WAIT_S) as client:
                client.ask("step")
                client.ask("close")
    assert resident_mb() < before + 30.0
