"""Records of navigation: motion read by the inertial unit, navigation solution, instrument health, and
estimate.
"""

from __future__ import annotations

from edl6dof.interface.capacities import MAX_ACCELEROMETERS, MAX_BEAMS, MAX_GYROS, MAX_LANDMARKS, MAX_TRACKERS
from edl6dof.records import FLAG, record, whole

#: Position of the centre of mass by landmarks of the map, in the cycle in which the matches arrive.
POSITION_FIX = record(
    ("matches", whole(0, MAX_LANDMARKS)),  # matches that agree with it; 0: there is no fix in this cycle
    ("error", "f8", (3,)),  # m, I: measured less navigated position
    ("covariance", "f8", (3, 3)),  # m2, I: of its noise
    # m, I: change of the measured position per radian of attitude error (I), a column for each axis
    ("turn", "f8", (3, 3)),
    ("age", "f8"),  # s: since the exposure
)

#: Motion of the body over the cycle between the last two readings of the inertial unit, all instruments taken
#: together, less the believed biases, referred to the centre of mass; and the present star fix.
MOTION = record(
    ("dt", "f8"),  # s: of the cycle
    ("angle", "f8", (3,)),  # rad, B: integral of the rate
    ("gain", "f8", (3,)),  # m/s, B: integral of the specific force
    ("last_angle", "f8", (3,)),  # rad, B: of the cycle before
    ("last_gain", "f8", (3,)),  # m/s, B: of the cycle before
    ("rate", "f8", (3,)),  # rad/s, B: at the end of the cycle
    ("centre", "f8", (3,)),  # m, B: believed centre of mass
    ("rate_known", FLAG),  # enough gyros read within their range
    ("force_known", FLAG),  # enough accelerometers read within their range
    # star fix of the cycle: mean of the star trackers in use
    ("fix_q_I2B", "f8", (4,)),  # attitude of B in I, unit quaternion, scalar first
    ("fix_doubt", "f8"),  # rad2: additional variance about each axis, as two star trackers disagree
    ("fixes", whole(0, MAX_TRACKERS)),  # number of star trackers of which it is the mean; 0: there is none
    ("position_fix", POSITION_FIX),  # position fix of the cycle by landmarks
)

#: The navigation solution: state of the centre of mass at the time of the last reading.
SOLUTION = record(
    ("t", "f8"),  # s: flight time of the last reading
    ("r_I", "f8", (3,)),  # m, I: position of the centre of mass
    ("v_I", "f8", (3,)),  # m/s, I: inertial velocity
    ("q_I2B", "f8", (4,)),  # attitude of B in I, unit quaternion, scalar first
    ("gyro_bias", "f8", (3,)),  # rad/s, B: excess of the rate read
    ("accelerometer_bias", "f8", (3,)),  # m/s2, B: excess of the specific force read
    ("terrain", "f8"),  # m: height of the ground below above the landing site
    ("slope", "f8", (2,)),  # rise of the ground below per metre towards north and east
    ("new_attitude_variance", "f8"),  # rad2: about each axis, of an attitude just recovered
    ("started", FLAG),  # ground tracking and star tracker have started it
    ("sigma_r", "f8", (3,)),  # m, N: estimated standard deviation, north, east, down
    # m/s, N: estimated standard deviation of the planet-relative velocity, north, east, down
    ("sigma_v", "f8", (3,)),
    ("sigma_attitude", "f8", (3,)),  # rad, N: estimated standard deviation, about north, east, down
    ("sigma_height", "f8"),  # m: estimated standard deviation of the height above the ground
    # over its standard deviation, at the last use of the radar; 0 where there was none
    ("range_innovation", "f8", (MAX_BEAMS,)),
    # over its standard deviation, at the last use of the radar; 0 where there was none
    ("speed_innovation", "f8", (MAX_BEAMS,)),
    ("beams_used", whole(0, 2**MAX_BEAMS - 1)),  # beams used at the last use of the radar, a bit for each
    # beams with a wrong range, excluded or not, a bit for each
    ("ranges_refused", whole(0, 2**MAX_BEAMS - 1)),
    # beams with a wrong speed, excluded or not, a bit for each
    ("speeds_refused", whole(0, 2**MAX_BEAMS - 1)),
    ("looked", FLAG),  # the filter has looked at the radar in this cycle
)

#: Flags of the instruments that are in use.
INSTRUMENT_HEALTH = record(
    ("gyro", FLAG, (MAX_GYROS,)),  # in use (1) or excluded as failed (0)
    ("accelerometer", FLAG, (MAX_ACCELEROMETERS,)),  # in use (1) or excluded as failed (0)
    ("beam_range", FLAG, (MAX_BEAMS,)),  # range of the beam in use (1) or excluded (0)
    ("beam_speed", FLAG, (MAX_BEAMS,)),  # speed along the beam in use (1) or excluded (0)
    ("star_tracker", FLAG, (MAX_TRACKERS,)),  # in use (1) or excluded as failed (0)
)

#: Output of navigation to the rest of the flight software, extrapolated to the time of the cycle.
ESTIMATE = record(
    ("t", "f8"),  # s: flight time
    ("r_I", "f8", (3,)),  # m, I: position of the centre of mass
    ("v_I", "f8", (3,)),  # m/s, I: its inertial velocity
    ("q_I2B", "f8", (4,)),  # attitude of B in I, unit quaternion, scalar first
    ("w_B", "f8", (3,)),  # rad/s, B: rate of B relative to I
    ("specific_force_B", "f8", (3,)),  # m/s2, B: acceleration of the centre of mass without gravity
    ("height_above_ground", "f8"),  # m: of the centre of mass above the ground below
    ("imu_rate_B", "f8", (3,)),  # rad/s, B: rate as the inertial unit read it, some cycles ago
    ("imu_gain_B", "f8", (3,)),  # m/s, B: integral of the specific force, of the same age
    ("footpad_contact", FLAG),  # a footpad touches the ground
    ("wing_open", FLAG),  # end switch of the trim wing
)
