"""``edl6dof serve``."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from tempfile import TemporaryDirectory

from edl6dof.app.exit_status import UNAVAILABLE
from edl6dof.serve.server import HOST, FlightServer
from edl6dof.serve.session import Session


def run_serve(scenario: str, sets: Sequence[str], port: int) -> int:
    """Serve flights of a scenario until interrupted (Ctrl-C); returns the exit status.

    The first line of the output is address and port, the second names the token file, which only this user
    can read and which is gone with the server.
    """

    def begin() -> Session:
        return Session(scenario, sets)

    begin().answer({"do": "step"})  # the scenario is checked, and the loop compiled, before anybody comes
    try:
        server = FlightServer(begin, port)
    except ImportError as error:
        print(error, file=sys.stderr)
        return UNAVAILABLE
    with server, suppress(KeyboardInterrupt), token_file(server) as file:
        print(f"{HOST}:{server.port}\ntoken file: {file}", flush=True)
        print("Ctrl-C stops it; only this user, on this machine, can connect", flush=True)
        server.serve_forever()
    return 0


@contextmanager
def token_file(server: FlightServer) -> Iterator[Path]:
    """The token of a server in a file of its own that only this user can read."""
    with TemporaryDirectory(prefix="edl6dof-serve-") as folder:  # made for this user alone
        file = Path(folder) / "token"
        file.write_text(server.token, encoding="ascii")
        yield file
