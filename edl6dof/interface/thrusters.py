"""Groups of thrusters: what each thruster is for."""

from __future__ import annotations

from typing import Literal, get_args

#: Horizontal: hazard avoidance and roll; axial: beside the engine; attitude: pitch and yaw; fine: fine
#: pointing.  Names in YAML; records carry the index, and masks the bit of that number.
ThrusterGroup = Literal["horizontal", "axial", "attitude", "fine"]
THRUSTER_GROUPS: tuple[ThrusterGroup, ...] = get_args(ThrusterGroup)
HORIZONTAL, AXIAL, ATTITUDE, FINE = range(len(THRUSTER_GROUPS))
