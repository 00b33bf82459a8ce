"""Messages on the wire: four bytes that count those that follow, the highest first, and as many of
MessagePack.

What comes in was written by anybody who can connect: it is bounded in size, in what it unpacks to, and in
depth.
"""

from __future__ import annotations

import struct
from socket import socket
from time import monotonic
from typing import Any

import numpy as np

from edl6dof.api.arguments import library

#: Bytes of a message; the largest saved state fits.
LARGEST = 16 * 1024 * 1024
#: Lists and maps of a message, one in the other or side by side, and what each may hold: an empty one takes a
#: byte on the wire and a hundred in memory.
_CONTAINERS, _LONGEST = 256, 1024
_LENGTH = struct.Struct(">I")


#: Longest time (s) for a message to be complete once it has begun.
_MESSAGE_S = 30.0


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
        """The next message; ``None`` where its sender is gone, in the middle of it or before.

        Args:
            line: where it comes from.
            idle_s: longest time (s) until it begins.

        Raises:
            Unreadable: it would be too long.
            TimeoutError: it does not begin, or is not complete, in time.
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
            ValueError: it is no MessagePack, or not what a request may be made of.
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
        except Exception as error:  # a dozen kinds, some without a word
            reason = str(error) or type(error).__name__
            raise ValueError(f"the message is no MessagePack that a request is made of ({reason})") from None

    def pack(self, message: dict[str, Any]) -> bytes:
        """A message, its length before it."""
        body = self._msgpack.packb(message, default=_listed)
        return _LENGTH.pack(len(body)) + body


def exactly(line: socket, size: int, within_s: float) -> bytes | None:
    """So many bytes; ``None`` where the sender is gone before.

    Raises:
        TimeoutError: they are not complete within a time (s), however they drip.
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
    """A message unpacks to more than any request holds."""


def _listed(value: Any) -> Any:
    """An array as a list."""
    if isinstance(value, np.ndarray):
        return value.tolist()
    raise TypeError(f"{value!r} cannot be sent")
