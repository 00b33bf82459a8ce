"""The server: a flight for each connection of this machine, and its messages.

A message is a length in four bytes, the highest first, and that many bytes of MessagePack.  Anybody who can
connect may have written it: its size, unpacked size, depth and time are bounded.
"""

from __future__ import annotations

import gc
import os
import socketserver
import struct
import sys
import traceback
from collections.abc import Callable
from contextlib import suppress
from hmac import compare_digest
from secrets import token_hex
from socket import socket
from threading import BoundedSemaphore
from time import monotonic
from typing import Any

import numpy as np

from edl6dof.api.arguments import library
from edl6dof.config.errors import ConfigError, refusal
from edl6dof.serve.session import Session, refused

HOST = "127.0.0.1"
#: Clients that fly at a time; each has some megabytes of records.
MOST_CLIENTS = 8
#: Connections at a time that have not sent the token, and how long (s) each may take to send it.
_MOST_STRANGERS, _GREETING_S = 64, 5.0
#: Longest time (s) between the requests of a client, and for a message to be complete once it has begun.
IDLE_S, _MESSAGE_S = 900.0, 30.0
#: Bytes of a message; the largest saved state fits.
LARGEST = 16 * 1024 * 1024
#: Lists and maps of a message, nested or not, and the entries of each: an empty one takes a byte on the wire
#: and a hundred in memory.
_CONTAINERS, _LONGEST = 256, 1024
_LENGTH = struct.Struct(">I")


class Unreadable(ValueError):
    """The rest of the stream cannot be read: the start of the next message is unknown."""


class Wire:
    """Packs and unpacks messages.

    Raises:
        ImportError: msgpack is not installed.
    """

    def __init__(self) -> None:
        self._msgpack = library("msgpack", "edl6dof serve", extra="serve")

    def receive(self, line: socket, idle_s: float) -> bytes | None:
        """Return the next message, which begins within ``idle_s`` (s); ``None`` if its sender is gone.

        Raises:
            Unreadable: the message would be too long.
            TimeoutError: the message does not begin, or is not complete, in time.
        """
        head = exactly(line, _LENGTH.size, idle_s)
        if head is None:
            return None
        (size,) = _LENGTH.unpack(head)
        if size > LARGEST:
            raise Unreadable(
                f"a message has at most {LARGEST} bytes (this one says {size}: does it begin with its "
                "length, four bytes, the highest first?)"
            )
        return exactly(line, size, _MESSAGE_S)

    def unpack(self, body: bytes) -> Any:
        """Unpack the content of a message.

        Raises:
            ValueError: the content is no MessagePack, or has types that no request may have.
        """
        left = iter(range(_CONTAINERS))

        def count(container: Any) -> Any:
            if next(left, None) is None:
                raise _TooMany(f"a request holds at most {_CONTAINERS} lists and maps")
            return container

        try:
            return self._msgpack.unpackb(
                body,
                list_hook=count,
                object_hook=count,
                max_array_len=_LONGEST,
                max_map_len=_LONGEST,
                max_ext_len=0,
            )
        except UnicodeDecodeError as error:
            raise ValueError(f"a text is not UTF-8 ({error.reason})") from None
        except _TooMany as error:
            raise ValueError(str(error)) from None
        except Exception as error:  # msgpack raises a dozen kinds, some without text
            reason = str(error) or type(error).__name__
            raise ValueError(f"the message is no MessagePack that a request is made of ({reason})") from None

    def pack(self, message: dict[str, Any]) -> bytes:
        """Return a message with its length."""
        body = self._msgpack.packb(message, default=_listed)
        return _LENGTH.pack(len(body)) + body


def exactly(line: socket, size: int, within_s: float) -> bytes | None:
    """Receive ``size`` bytes; ``None`` if the sender is gone before.

    Raises:
        TimeoutError: they are not complete ``within_s`` (s), however slowly they come.
    """
    found, until = bytearray(), monotonic() + within_s
    while len(found) < size:
        if (left := until - monotonic()) <= 0.0:
            raise TimeoutError
        line.settimeout(left)
        part = line.recv(min(size - len(found), 65536))
        if not part:
            return None
        found += part
    return bytes(found)


class _TooMany(Exception):
    """A message unpacks to more items than any request has."""


def _listed(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return value.tolist()
    raise TypeError(f"{value!r} cannot be sent")


class FlightServer(socketserver.ThreadingTCPServer):
    """Answers the requests of each client in a thread of its own, in the order in which they come.

    A client first sends the token of the token file; a client that does not is refused, and takes no place.

    Args:
        begin: makes the flight of a client.
        port: port to listen on; any that is free if 0.
        idle_s: longest time between the requests of a client, s.

    Attributes:
        port: port that it listens on.
        token: 32 letters and digits that a client sends first.

    Raises:
        ImportError: msgpack is not installed.
        ConfigError: the port cannot be opened.
    """

    daemon_threads = True
    #: Not on Windows, where two servers could then share a port.
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
        """Ignore errors of a client that disconnects, or does not read its answer."""
        if not isinstance(sys.exception(), ConnectionError | TimeoutError):
            super().handle_error(request, client_address)


class _Client(socketserver.StreamRequestHandler):
    server: FlightServer
    disable_nagle_algorithm = True

    def handle(self) -> None:
        """Answer until the client closes the flight, is gone, or sends nothing readable in time."""
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
        """True once the client has sent the token, for which it has ``_GREETING_S``."""
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
        """Read the first request, if it comes soon, then refuse it.  Closing a socket with unread data resets
        the connection, and the client would lose the answer.
        """
        with suppress(TimeoutError, Unreadable):
            self.server.wire.receive(self.request, _GREETING_S)
        self._send(refused(reason))

    def _fly(self) -> None:
        session = None
        try:
            while (body := self.server.wire.receive(self.request, self.server.idle_s)) is not None:
                session = session or self.server.begin()  # no flight before the first request
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
