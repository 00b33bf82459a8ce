"""The server: a flight for each connection, to this machine alone."""

from __future__ import annotations

import os
import socketserver
import sys
import traceback
from collections.abc import Callable
from contextlib import suppress
from threading import BoundedSemaphore
from typing import Any

from edl6dof.config.errors import ConfigError, refusal
from edl6dof.serve.session import Session, refused
from edl6dof.serve.wire import Unreadable, Wire

HOST = "127.0.0.1"
#: Clients at a time; each has some megabytes of records.
MOST_CLIENTS = 8
#: How long a client that finds no place may take to say something.
_PATIENCE_S = 5.0


class FlightServer(socketserver.ThreadingTCPServer):
    """Answers the requests of each client in a thread of its own, in the order in which they come.

    Args:
        begin: makes the flight of a client.
        port: 0: any that is free.

    Attributes:
        port: where it listens.

    Raises:
        ImportError: msgpack is not installed.
        ConfigError: the port cannot be had.
    """

    daemon_threads = True
    #: Elsewhere it would let two servers share a port.
    allow_reuse_address = os.name == "posix"

    def __init__(self, begin: Callable[[], Session], port: int = 0) -> None:
        self.begin, self.wire, self.places = begin, Wire(), BoundedSemaphore(MOST_CLIENTS)
        try:
            super().__init__((HOST, port), _Client)
        except OSError as error:
            raise refusal("--port", f"{port} cannot be had: {error.strerror or error}") from None
        self.port: int = self.server_address[1]

    def handle_error(self, request: Any, client_address: Any) -> None:
        """A client that hangs up is no error."""
        if not isinstance(sys.exception(), ConnectionError):
            super().handle_error(request, client_address)


class _Client(socketserver.StreamRequestHandler):
    server: FlightServer
    disable_nagle_algorithm = True

    def handle(self) -> None:
        """Answer until the client closes, is gone, or cannot be made out any more."""
        if not self.server.places.acquire(blocking=False):
            self._turn_away()
            return
        try:
            self._fly()
        finally:
            self.server.places.release()

    def _turn_away(self) -> None:
        """Answer the first request, if it comes soon: left unread, it would take the answer with it."""
        self.request.settimeout(_PATIENCE_S)
        with suppress(TimeoutError, Unreadable):
            self.server.wire.receive(self.rfile)
        self._send(refused(f"{MOST_CLIENTS} clients fly already; come back when one has closed"))

    def _fly(self) -> None:
        session = None
        try:
            while (body := self.server.wire.receive(self.rfile)) is not None:
                session = session or self.server.begin()  # nothing is made for who says nothing
                self._send(self._answer(session, body))
                if not session.open:
                    return
        except (Unreadable, ConfigError) as error:
            self._send(refused(str(error)))

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
