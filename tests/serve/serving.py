"""A server in this process, and the clients of the examples."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from threading import Thread

from edl6dof.serve.flight_server import IDLE_S, FlightServer
from edl6dof.serve.session import Session

EXAMPLES = Path(__file__).resolve().parents[2] / "examples" / "serve"
sys.path.insert(0, str(EXAMPLES))
from client import Client, main  # noqa: E402

__all__ = ["EXAMPLES", "Client", "main", "serving"]


@contextmanager
def serving(scenario: str, *sets: str, idle_s: float = IDLE_S) -> Iterator[FlightServer]:
    """Serve flights of a scenario to whoever connects."""
    with FlightServer(lambda: Session(scenario, sets), idle_s=idle_s) as server:
        thread = Thread(target=server.serve_forever, kwargs={"poll_interval": 0.01})
        thread.start()
        try:
            yield server
        finally:
            server.shutdown()
            thread.join()
