"""Events: what the flight software requests and the vehicle then does, each at most once."""

from __future__ import annotations

from typing import Literal, get_args

#: Names in YAML, in telemetry and in the timeline, in the order of the flight; records carry the index.
EventName = Literal["trim_wing", "mortar", "heat_shield", "landing_legs", "backshell", "ignition", "cut_off"]
EVENTS: tuple[EventName, ...] = get_args(EventName)
TRIM_WING, MORTAR, HEAT_SHIELD_OFF, LEGS_OUT, BACKSHELL_OFF, IGNITION, CUT_OFF = range(len(EVENTS))
