"""A client of ``edl6dof serve`` in Python: needs msgpack and nothing of edl6dof.

    edl6dof serve tianwen1 --port 4242        # names its token file
    python client.py 4242 TOKEN_FILE

flies a whole flight cycle by cycle, once under no command and once with the bank angle commanded, and prints
how many cycles a second went over the socket.
"""

from __future__ import annotations

import socket
import struct
import sys
import time
from pathlib import Path
from types import TracebackType
from typing import Any

import msgpack


class Client:
    """A flight on a server of this machine, whose token a file holds."""

    def __init__(self, port: int, token: str, timeout_s: float | None = None):
        self.line = socket.create_connection(("127.0.0.1", port), timeout_s)
        self.line.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.line.sendall(token.encode())
        self._answers = self.line.makefile("rb")

    def ask(self, what: str, **fields: Any) -> dict[str, Any]:
        """Ask for something and wait for the answer.

        Raises:
            ValueError: the server says why it cannot be done.
        """
        body = msgpack.packb({"do": what, **fields})
        self.line.sendall(struct.pack(">I", len(body)) + body)
        answer = self.answer()
        if not answer["ok"]:
            raise ValueError(answer["error"])
        return answer

    def answer(self) -> dict[str, Any]:
        """The next answer.

        Raises:
            ConnectionError: the server is gone.
        """
        head = self._answers.read(4)
        if len(head) < 4:
            raise ConnectionError("the server is gone")
        return dict(msgpack.unpackb(self._answers.read(*struct.unpack(">I", head))))

    def close(self) -> None:
        """Hang up."""
        self._answers.close()
        self.line.close()

    def __enter__(self) -> Client:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def main() -> None:
    observed = ["altitude_m", "drag_m_s2", "v_N_m_s", "bank_deg"]
    with Client(int(sys.argv[1]), Path(sys.argv[2]).read_text()) as client:
        for words, fields in (("under no command", {}), ("bank commanded", {"command": {"bank_deg": 60.0}})):
            seen = client.ask("reset")
            began = time.perf_counter()
            while seen["flying"]:
                seen = client.ask("step", observe=observed, **fields)
            rate = seen["cycle"] / (time.perf_counter() - began)
            print(f"{words}: {seen['outcome']} at {seen['time_s']:.2f} s, {rate:,.0f} cycles a second")


if __name__ == "__main__":
    main()
