"""How much the records hold: fixed, as compiled code demands."""

from __future__ import annotations

#: Thrusters of a vehicle.
MAX_THRUSTERS = 32
#: Phases of a mission.
MAX_PHASES = 16
#: Faults of a flight.
MAX_FAULTS = 16
