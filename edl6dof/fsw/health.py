"""What may be used: written by check-out and fault isolation, read by control and allocation."""

from __future__ import annotations

import numpy as np

from edl6dof.interface.capacities import MAX_THRUSTERS
from edl6dof.records import FLAG

HEALTH = np.dtype(
    [
        ("thruster", FLAG, (MAX_THRUSTERS,)),  # may be used: 0 once it is found to have failed
        ("wing_failed", FLAG),  # the trim wing was commanded open and did not report it
    ],
    align=True,
)
