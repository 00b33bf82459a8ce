"""The flight computer's model of its instruments: places, directions and error statistics."""

from __future__ import annotations

from edl6dof.fsw.navigation.landmark_fix import LANDMARK_CAMERA
from edl6dof.interface.capacities import MAX_ACCELEROMETERS, MAX_BEAMS, MAX_GYROS, MAX_PORTS
from edl6dof.interface.sensed import IMAGERS
from edl6dof.records import record

#: Standard deviations are those of one instrument.
INSTRUMENTS = record(
    # inertial unit
    ("unit_position", "f8", (3,)),  # m, B
    ("unit_delay", "f8"),  # s: age of a reading when it arrives
    ("gyro_axis", "f8", (MAX_GYROS, 3)),  # B: unit vectors
    ("n_gyros", "i8"),
    ("gyro_range", "f8"),  # rad/s
    ("gyro_noise", "f8"),  # rad/sqrt(s): angle random walk
    ("gyro_step", "f8"),  # rad: value of one count
    ("gyro_bias", "f8"),  # rad/s: standard deviation at the start
    ("gyro_bias_walk", "f8"),  # rad/s/sqrt(s)
    ("gyro_scale", "f8"),  # standard deviation of scale factor and misalignment, over the rate
    ("accelerometer_axis", "f8", (MAX_ACCELEROMETERS, 3)),  # B: unit vectors
    ("n_accelerometers", "i8"),
    ("accelerometer_range", "f8"),  # m/s2
    ("accelerometer_noise", "f8"),  # m/s/sqrt(s): velocity random walk
    ("accelerometer_step", "f8"),  # m/s: value of one count
    ("accelerometer_bias", "f8"),  # m/s2: standard deviation at the start
    ("accelerometer_bias_walk", "f8"),  # m/s2/sqrt(s)
    ("accelerometer_scale", "f8"),  # standard deviation of scale factor and misalignment, over the force
    # star trackers
    ("n_trackers", "i8"),
    ("star_sigma", "f8"),  # rad, about each axis: noise of a fix
    ("star_bias", "f8"),  # rad, B, about each axis: error common to all fixes
    ("star_lowest", "f8"),  # m: altitude below which it sees no stars
    ("star_rate", "f8"),  # rad/s: largest rate at which it sees stars
    ("star_until", "i8"),  # number of the event, from one, after which it sees no stars; zero: none
    # ground tracking
    ("tracking_position", "f8", (3, 3)),  # m2, I: covariance of the state sent up
    ("tracking_velocity", "f8", (3, 3)),  # m2/s2, I
    # pressure ports
    ("port_axis", "f8", (MAX_PORTS, 3)),  # B: outward normals
    ("n_ports", "i8"),
    ("port_bias", "f8"),  # Pa: constant error of a port
    ("port_scale", "f8"),  # of the pressure, a constant error
    # radar
    ("antenna_position", "f8", (3,)),  # m, B
    ("beam_axis", "f8", (MAX_BEAMS, 3)),  # B: unit vectors towards the ground
    ("n_beams", "i8"),
    ("radar_ceiling", "f8"),  # m: height above the ground above which it sees nothing
    ("range_sigma", "f8"),  # m
    ("range_sigma_relative", "f8"),  # of the range, added to it
    ("speed_sigma", "f8"),  # m/s
    ("speed_sigma_relative", "f8"),  # of the speed along the beam, added to it
    # constant errors of the radar, each beam with its own
    ("range_bias", "f8"),  # m
    ("range_scale", "f8"),  # of the range
    ("speed_scale", "f8"),  # of the speed
    ("imagers", IMAGERS),  # landing camera, lidar and stereo cameras
    ("landmarks", LANDMARK_CAMERA),  # landmark camera and its map
    # flow meter of a propellant branch; shares of the branch's full flow
    ("flow_scale_sigma", "f8"),  # of the flow
    ("flow_bias_share", "f8"),  # constant error of the flow
    ("flow_noise_share", "f8"),  # sqrt(s): white noise of the flow, of a mean over one second
)
