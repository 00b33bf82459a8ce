"""The record that crosses from the plant to the flight software."""

from __future__ import annotations

import numpy as np

from edl6dof.records import FLAG
from edl6dof.sensors.imu import READINGS

SENSED = np.dtype(
    [
        ("readings", READINGS),  # under way
        ("t", "f8"),
        ("r_I", "f8", (3,)),
        ("v_I", "f8", (3,)),
        ("q_I2B", "f8", (4,)),
        ("w_B", "f8", (3,)),
        ("specific_force_B", "f8", (3,)),
        ("height_above_ground", "f8"),
        ("footpad_contact", FLAG),
        ("imu_rate_B", "f8", (3,)),
        ("imu_gain_B", "f8", (3,)),  # integral of the specific force, m/s
        ("wing_open", FLAG),  # end switch of the trim wing
    ],
    align=True,
)
