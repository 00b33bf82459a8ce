"""What the plant holds for its instruments: what they are told, and what faults do to their readings.

Commands and faults write it, sensors read it.
"""

from __future__ import annotations

import numpy as np

from edl6dof.interface.capacities import MAX_ACCELEROMETERS, MAX_BEAMS, MAX_BRANCHES, MAX_GYROS
from edl6dof.records import FLAG, whole

#: How a reading comes about: as it should; always the last one before the fault; at the end of the range
#: without a flag; none; at the end of the range with its flag; of something else than the ground.
WORKING, STUCK, HARDOVER, OUTAGE, SATURATED, FALSE_LOCK = range(6)

#: One reading, in its own unit: rad/s of a gyro, m/s2 of an accelerometer, m and m/s of a beam, kg/s of a
#: flow meter.
READING_FAULT = np.dtype(
    [
        ("mode", whole(0, FALSE_LOCK)),
        ("offset", "f8"),  # added to it; the reading itself at a false lock
        ("noise", "f8"),  # standard deviation of the noise added to it
    ],
    align=True,
)

#: Commands to the imagers in this cycle.
IMAGER_COMMANDS = np.dtype([("camera_trigger", FLAG), ("scan", FLAG)], align=True)

#: What faults do to them.
INSTRUMENT_FAULTS = np.dtype(
    [
        ("gyro", READING_FAULT, (MAX_GYROS,)),
        ("accelerometer", READING_FAULT, (MAX_ACCELEROMETERS,)),
        ("range", READING_FAULT, (MAX_BEAMS,)),
        ("speed", READING_FAULT, (MAX_BEAMS,)),
        ("flow", READING_FAULT, (MAX_BRANCHES,)),
        ("star_tracker_lost", FLAG),
        ("camera_lost", FLAG),
        ("lidar_lost", FLAG),
        ("stereo_lost", FLAG),
        ("mirror_stuck", FLAG),  # that of the lidar, which turns the fan of rays from row to row
    ],
    align=True,
)
