"""Modes of the main engine."""

from __future__ import annotations

#: Off; within the throttle band; at the full level of the start, with its fast build-up.  Records carry the
#: number.
ENGINE_OFF, ENGINE_THROTTLE, ENGINE_FULL = range(3)
