"""What may be used: written by check-out and fault isolation, read by control and allocation."""

from __future__ import annotations

import numpy as np

from edl6dof.interface.capacities import MAX_THRUSTERS
from edl6dof.records import FLAG

#: Thrusters that may be used: 0 once one is found to have failed.
HEALTH = np.dtype([("thruster", FLAG, (MAX_THRUSTERS,))], align=True)
