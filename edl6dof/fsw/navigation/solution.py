"""The records that pass through navigation: the motion that the inertial unit read, the navigation solution,
and what the rest of the flight software is told.
"""

from __future__ import annotations

import numpy as np

from edl6dof.interface.capacities import MAX_ACCELEROMETERS, MAX_BEAMS, MAX_GYROS
from edl6dof.records import FLAG, whole

#: Motion of the body over the cycle between the last two readings of the inertial unit, all instruments taken
#: together, less the believed biases, brought to the centre of mass.
MOTION = np.dtype(
    [
        ("dt", "f8"),  # s
        ("angle", "f8", (3,)),  # rad, B: integral of the rate
        ("gain", "f8", (3,)),  # m/s, B: integral of the specific force
        ("last_angle", "f8", (3,)),  # rad, B: of the cycle before
        ("last_gain", "f8", (3,)),  # m/s, B
        ("rate", "f8", (3,)),  # rad/s, B: at its end
        ("centre", "f8", (3,)),  # m, B: believed centre of mass
        ("rate_known", FLAG),  # whether enough gyros read within their range
        ("force_known", FLAG),  # whether enough accelerometers do
    ],
    align=True,
)

#: The navigation solution: state of the centre of mass at the time of the last reading.
SOLUTION = np.dtype(
    [
        ("t", "f8"),  # s, flight time
        ("r_I", "f8", (3,)),  # m, I
        ("v_I", "f8", (3,)),  # m/s, I: inertial velocity
        ("q_I2B", "f8", (4,)),  # attitude of B in I, unit quaternion, scalar first
        ("gyro_bias", "f8", (3,)),  # rad/s, B: what the rate read is too large by
        ("accelerometer_bias", "f8", (3,)),  # m/s2, B
        ("terrain", "f8"),  # m: how much higher the ground below is than the landing site
        ("slope", "f8", (2,)),  # rise of the ground below per metre towards north and east
        (
            "turned_anew",
            "f8",
        ),  # rad2: variance about each axis of an attitude just found, for the filter to take up
        ("started", FLAG),  # whether ground tracking and star tracker have started it
        # standard deviations that the filter claims
        ("sigma_r", "f8", (3,)),  # m: north, east, down
        ("sigma_v", "f8", (3,)),  # m/s: north, east, down, of the velocity relative to the planet
        ("sigma_attitude", "f8", (3,)),  # rad, about north, east, down
        ("sigma_height", "f8"),  # m, of the height above the ground
        # the last look at the radar
        ("range_innovation", "f8", (MAX_BEAMS,)),  # over its standard deviation; 0 where there was none
        ("speed_innovation", "f8", (MAX_BEAMS,)),
        ("beams_used", whole(0, 2**MAX_BEAMS - 1)),  # a bit for each beam
        # likewise of those whose range or speed is wrong, excluded or not
        ("ranges_refused", whole(0, 2**MAX_BEAMS - 1)),
        ("speeds_refused", whole(0, 2**MAX_BEAMS - 1)),
        ("looked", FLAG),  # whether the filter has looked at the radar in this cycle
    ],
    align=True,
)

#: Which instruments are in use, 1, or excluded as failed.
INSTRUMENT_HEALTH = np.dtype(
    [
        ("gyro", FLAG, (MAX_GYROS,)),
        ("accelerometer", FLAG, (MAX_ACCELEROMETERS,)),
        ("beam_range", FLAG, (MAX_BEAMS,)),
        ("beam_speed", FLAG, (MAX_BEAMS,)),
        ("star_tracker", FLAG),
    ],
    align=True,
)

#: What navigation tells the rest of the flight software, brought forward to the time of the cycle.
ESTIMATE = np.dtype(
    [
        ("t", "f8"),  # s, flight time
        ("r_I", "f8", (3,)),  # m, I: position of the centre of mass
        ("v_I", "f8", (3,)),  # m/s, I: its inertial velocity
        ("q_I2B", "f8", (4,)),  # attitude of B in I, unit quaternion, scalar first
        ("w_B", "f8", (3,)),  # rad/s, B: rate of B relative to I
        ("specific_force_B", "f8", (3,)),  # m/s2, B: acceleration of the centre of mass without gravity
        ("height_above_ground", "f8"),  # m, of the centre of mass
        # as the inertial unit read them, some cycles ago
        ("imu_rate_B", "f8", (3,)),  # rad/s, B
        ("imu_gain_B", "f8", (3,)),  # m/s, B: count of the specific force
        ("footpad_contact", FLAG),
        ("wing_open", FLAG),
    ],
    align=True,
)
