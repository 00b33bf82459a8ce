"""What used to stand elsewhere in a scenario and is now said by its mission, for messages."""

from __future__ import annotations

#: In place of ``wing_patience_s``.
WING_PATIENCE = (
    "a way out of the phase that opens the trim wing, into one with hold_alpha: true: ways_out: [{when: "
    "[{quantity: wing_open, goes: below, value: 0.5}, {quantity: wing_time_s, goes: above, value: 2.0}], "
    "next: NAME}]"
)
