"""``edl6dof faults``.

Heavy modules are imported inside: an interruption while they load must end like one later on.
"""

from __future__ import annotations

from dataclasses import dataclass

from edl6dof.app.campaign import CampaignOptions, go_on_later


@dataclass(frozen=True)
class Wanted:
    """What the command line asks to fail; lists as texts with commas, empty or ``None`` for the usual."""

    sensors: bool = False
    kinds: str = ""
    components: str = ""
    pairs: bool = False
    phases: str = ""
    after_s: float | None = None
    at: str | None = None


def run_faults(wanted: Wanted, options: CampaignOptions) -> int:
    """Fly a matrix of faults, or go on with one; returns the exit status."""
    try:
        from edl6dof.app.faults.flight import fly_new, go_on

        return go_on(wanted, options) if options.resume else fly_new(wanted, options)
    except KeyboardInterrupt:
        if not options.resume:
            raise  # nothing was written
        return go_on_later(options)
