"""A word before the first flight on a machine, which takes its time to compile."""

from __future__ import annotations

import sys


def announce_compiling(talk: bool) -> bool:
    """Whether the simulator has yet to be compiled; with ``talk``, standard error says so."""
    from edl6dof.sim.compile_ahead import is_compiled

    if is_compiled():
        return False
    if talk:
        print(
            "Compiling the simulator (first use on this machine; about a minute, kept for later) ...",
            file=sys.stderr,
            flush=True,
        )
    return True
