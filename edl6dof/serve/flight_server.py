"""The server: a flight for each connection, to this machine alone."""

from __future__ import annotations

import gc
import os
import socketserver
import sys
import traceback
from collections.abc import Callable
from contextlib import suppress
from hmac import compare_digest
from secrets import token_hex
from threading import BoundedSemaphore
from typing import Any

from edl6dof.config.errors import ConfigError, refusal
from edl6dof.serve.session import Session, refused
from edl6dof.serve.wire import Unreadable, Wire, exactly

HOST = "127.0.0.1"
#: Clients that fly at a time; each has some megabytes of records.
MOST_CLIENTS = 8
#: Connections at a time that have not sent the token, and how long (s) each may take to send it.
_MOST_STRANGERS, _GREETING_S = 64, 5.0
#: Longest time (s) between the requests of a client.
IDLE_S = 900.0


class FlightServer(socketserver.ThreadingTCPServer):
    """Answers the requests of each client in a thread of its own, in the order in which they come.

    A client first sends the token, as it stands in the token file; whoever cannot read that file is told so
    and takes nobody's place.

    Args:
        begin: makes the flight of a client.
        port: 0: any that is free.
        idle_s: longest time between the requests of a client.

    Attributes:
        port: where it listens.
        token: what a client sends first: 32 letters and digits.

    Raises:
        ImportError: msgpack is not installed.
        ConfigError: the port cannot be had.
    """

    daemon_threads = True
    #: Elsewhere it would let two servers share a port.
    allow_reuse_address = os.name == "posix"

    def __init__(self, begin: Callable[[], Session], port: int = 0, idle_s: float = IDLE_S) -> None:
        self.begin, self.wire, self.idle_s, self.token = begin, Wire(), idle_s, token_hex(16)
        self.places, self.doors = BoundedSemaphore(MOST_CLIENTS), BoundedSemaphore(_MOST_STRANGERS)
        try:
            super().__init__((HOST, port), _Client)
        except OSError as error:
            raise refusal("--port", f"{port} cannot be had: {error.strerror or error}") from None
        self.port: int = self.server_address[1]

    def handle_error(self, request: Any, client_address: Any) -> None:
        """A client that hangs up, or does not take its answer, is no error."""
        if not isinstance(sys.exception(), ConnectionError | TimeoutError):
            super().handle_error(request, client_address)


class _Client(socketserver.StreamRequestHandler):
    server: FlightServer
    disable_nagle_algorithm = True

    def handle(self) -> None:
        """Answer until the client closes, is gone, falls silent, or cannot be made out any more."""
        if not self._let_in():
            return
        if not self.server.places.acquire(blocking=False):
            self._turn_away(f"{MOST_CLIENTS} clients fly already; come back when one has closed")
            return
        try:
            self._fly()
        finally:
            self.server.places.release()
            gc.collect()  # the records of a flight refer to each other

    def _let_in(self) -> bool:
        """True once the client has sent the token, which it must within ``_GREETING_S``."""
        if not self.server.doors.acquire(blocking=False):
            return False
        try:
            token = self.server.token.encode()
            if compare_digest(exactly(self.request, len(token), _GREETING_S) or b"", token):
                return True
            self._turn_away("a connection begins with the token, as it stands in the token file")
        except TimeoutError:
            self._send(refused(f"no token within {_GREETING_S:g} s"))
        finally:
            self.server.doors.release()
        return False

    def _turn_away(self, reason: str) -> None:
        """Answer the first request, if it comes soon: left unread, it would take the answer with it."""
        with suppress(TimeoutError, Unreadable):
            self.server.wire.receive(self.request, _GREETING_S)
        self._send(refused(reason))

    def _fly(self) -> None:
        session = None
        try:
            while (body := self.server.wire.receive(self.request, self.server.idle_s)) is not None:
                session = session or self.server.begin()  # nothing is made for who says nothing
                self._send(self._answer(session, body))
                if not session.open:
                    return
        except (Unreadable, ConfigError) as error:
            self._send(refused(str(error)))
        except TimeoutError:
            self._send(refused("silent for too long: the flight is closed"))

    def _answer(self, session: Session, body: bytes) -> dict[str, Any]:
        try:
            return session.answer(self.server.wire.unpack(body))
        except ValueError as error:
            return refused(str(error))
        except Exception as error:
            traceback.print_exc()
            return refused(f"a defect of the program, not of what you sent: {type(error).__name__}: {error}")

    def _send(self, answer: dict[str, Any]) -> None:
        self.wfile.write(self.server.wire.pack(answer))
