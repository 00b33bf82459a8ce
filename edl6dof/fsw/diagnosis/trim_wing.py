"""Whether the trim wing has opened: it reports so, or it counts as failed after a while.

Source: Hu et al. 2022, section 4.3 (the angle of attack is then held by the thrusters).
"""

from __future__ import annotations

from edl6dof.jit import kernel


@kernel
def watch_trim_wing(patience, state, nav, health):
    """Declare the wing failed when it has not reported itself open ``patience`` seconds after the command."""
    if state.wing_commanded != 0 and nav.wing_open == 0 and nav.t - state.wing_time > patience:
        health.wing_failed = 1
