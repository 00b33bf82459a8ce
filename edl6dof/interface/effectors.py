"""Effectors: modes of the main engine; groups, failures and propellant branches of the thrusters."""

from __future__ import annotations

from typing import Literal, get_args

import numpy as np

from edl6dof.interface.capacities import MAX_BRANCHES, MAX_THRUSTERS

#: Off; within the throttle band; at the full level of the start, with its fast build-up.  Records carry the
#: number.
ENGINE_OFF, ENGINE_THROTTLE, ENGINE_FULL = range(3)


#: Horizontal: hazard avoidance and roll; axial: parallel to the engine; attitude: pitch and yaw; fine: fine
#: pointing.  Names in YAML; records carry the index, and masks the bit of that number.
ThrusterGroup = Literal["horizontal", "axial", "attitude", "fine"]
THRUSTER_GROUPS: tuple[ThrusterGroup, ...] = get_args(ThrusterGroup)
HORIZONTAL, AXIAL, ATTITUDE, FINE = range(len(THRUSTER_GROUPS))

#: How a thruster may fail.  Records and telemetry carry the number; 0 is a thruster that works.
ThrusterFailure = Literal["stuck_off", "stuck_on", "degraded"]
THRUSTER_FAILURES: tuple[ThrusterFailure, ...] = get_args(ThrusterFailure)
STUCK_OFF, STUCK_ON, DEGRADED = range(1, len(THRUSTER_FAILURES) + 1)

#: Propellant branches, each behind one latch valve.
BRANCHES = np.dtype(
    [
        ("of", "i8", (MAX_THRUSTERS,)),  # branch of each thruster
        ("count", "i8"),  # branches that the vehicle has
        ("full_flow", "f8", (MAX_BRANCHES,)),  # kg/s, with all thrusters of the branch open
    ],
    align=True,
)
