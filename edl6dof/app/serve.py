"""``edl6dof serve``."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from contextlib import suppress

from edl6dof.app.exit_status import UNAVAILABLE
from edl6dof.serve.server import HOST, FlightServer
from edl6dof.serve.session import Session


def run_serve(scenario: str, sets: Sequence[str], port: int) -> int:
    """Serve flights of a scenario until interrupted (Ctrl-C); returns the exit status.

    The first line of the output is address and port.
    """

    def begin() -> Session:
        return Session(scenario, sets)

    begin().answer({"do": "step"})  # the scenario is checked, and the loop compiled, before anybody comes
    try:
        server = FlightServer(begin, port)
    except ImportError as error:
        print(error, file=sys.stderr)
        return UNAVAILABLE
    with server, suppress(KeyboardInterrupt):
        print(f"{HOST}:{server.port}\nCtrl-C stops it; nobody but this machine can connect", flush=True)
        server.serve_forever()
    return 0
