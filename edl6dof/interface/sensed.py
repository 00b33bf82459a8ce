"""The record that crosses from the plant to the flight software: what the instruments say in a base cycle."""

from __future__ import annotations

import numpy as np

from edl6dof.records import FLAG

#: Ideal instruments sit at the centre of mass and say what is; the inertial measurement unit says what was,
#: some cycles ago.
SENSED = np.dtype(
    [
        ("t", "f8"),  # s, flight time
        ("r_I", "f8", (3,)),  # m, I: position of the centre of mass
        ("v_I", "f8", (3,)),  # m/s, I: its inertial velocity
        ("q_I2B", "f8", (4,)),  # attitude of B in I, unit quaternion, scalar first
        ("w_B", "f8", (3,)),  # rad/s, B: rate of B relative to I
        ("specific_force_B", "f8", (3,)),  # m/s2, B: acceleration of the centre of mass without gravity
        ("height_above_ground", "f8"),  # m, of the centre of mass above the ground below
        ("footpad_contact", FLAG),  # a footpad touches the ground
        ("imu_rate_B", "f8", (3,)),  # rad/s, B: rate of B relative to I, read by the IMU
        ("imu_gain_B", "f8", (3,)),  # m/s, B: integral of the specific force, counted by the IMU
        ("wing_open", FLAG),  # end switch of the trim wing
    ],
    align=True,
)
