"""Groups of thrusters: what each thruster is for."""

from __future__ import annotations

#: Horizontal: hazard avoidance and roll; axial: beside the engine; attitude: pitch and yaw; fine: fine
#: pointing.  Names in YAML; records carry the index, and masks the bit of that number.
THRUSTER_GROUPS = ("horizontal", "axial", "attitude", "fine")
HORIZONTAL, AXIAL, ATTITUDE, FINE = range(len(THRUSTER_GROUPS))
