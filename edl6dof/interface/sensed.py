"""Measurements: the record that crosses from the plant to the flight software in a base cycle.

Ideal instruments measure the state itself, in the first fields; real ones give readings, in the records
below, from which the flight software estimates the state.

All imagers share one geometry.  An imager looks along x of B, down when the vehicle stands upright, from its
place in B.  Its square field of view is cut into cells of equal size on a plane across the line of sight;
rows run along z of B, columns along y.
"""

from __future__ import annotations

from math import sqrt

from edl6dof.interface.capacities import (
    CAMERA_CELLS,
    MAX_ACCELEROMETERS,
    MAX_BEAMS,
    MAX_BRANCHES,
    MAX_GYROS,
    MAX_LANDMARKS,
    MAX_PORTS,
    MAX_TRACKERS,
    SCAN_BLOCK,
    SCAN_COLUMNS,
    SCAN_ROWS,
    STEREO_CELLS,
)
from edl6dof.kernels import kernel
from edl6dof.records import FLAG, record, whole

#: Readings of the gyros and accelerometers of an inertial unit, each along its own axis.  They count from
#: the start of the flight, so that nothing between two readings is lost.
INERTIAL = record(
    ("angle", "f8", (MAX_GYROS,)),  # rad: integral of the rate about the axis of each gyro
    ("rate", "f8", (MAX_GYROS,)),  # rad/s: that rate at the time of the reading
    ("gain", "f8", (MAX_ACCELEROMETERS,)),  # m/s: integral of the specific force along each
    ("gyro_saturated", FLAG, (MAX_GYROS,)),  # each met the end of its range
    ("accelerometer_saturated", FLAG, (MAX_ACCELEROMETERS,)),  # each met the end of its range
)

#: Readings of the star trackers.
STARS = record(
    ("q_I2B", "f8", (MAX_TRACKERS, 4)),  # attitude of B in I, unit quaternions, scalar first
    ("valid", FLAG, (MAX_TRACKERS,)),  # each is of this cycle
)

#: Readings of the beams of a landing radar.
RADAR = record(
    ("range", "f8", (MAX_BEAMS,)),  # m, along each beam from the antenna to the ground
    ("speed", "f8", (MAX_BEAMS,)),  # m/s, along each beam towards the ground, of the antenna
    ("locked", FLAG, (MAX_BEAMS,)),  # the beam has an echo
    ("fresh", FLAG),  # they are of this cycle
)

#: State of the centre of mass by ground tracking, in the cycle in which it is sent up.
TRACKING = record(
    ("r_I", "f8", (3,)),  # m, I: position
    ("v_I", "f8", (3,)),  # m/s, I: inertial velocity
    ("fresh", FLAG),  # it arrives in this cycle
)

#: Rows that the lidar has measured in this cycle; direction of a cell: :func:`cell_direction`.
LIDAR = record(
    ("range", "f4", (SCAN_BLOCK, SCAN_COLUMNS)),  # m, along each ray; 0: nothing came back
    ("row", whole(0, SCAN_ROWS - SCAN_BLOCK)),  # first of these rows, counted in the scan
    ("fresh", FLAG),  # they are of this cycle
)

#: Ranges by a pair of stereo images.
STEREO = record(
    ("range", "f4", (STEREO_CELLS, STEREO_CELLS)),  # m, along each direction; 0: none was found
    ("fresh", FLAG),  # it is of this cycle
)

#: Density of the obstacles that an image of the landing camera resolves.
CAMERA = record(
    ("density", "f4", (CAMERA_CELLS, CAMERA_CELLS)),  # share of the ground that obstacles take
    ("seen", FLAG, (CAMERA_CELLS, CAMERA_CELLS)),  # each cell shows ground
    ("fresh", FLAG),  # it is of this cycle
)

#: Landmarks of the map that the landmark camera has found in an image.
LANDMARKS = record(
    # row and column at which each was found, along z and y of B from the middle of the image
    ("pixel", "f8", (MAX_LANDMARKS, 2)),
    ("map_F", "f8", (MAX_LANDMARKS, 3)),  # m, F: position of each on the map
    ("count", whole(0, MAX_LANDMARKS)),  # number of landmarks found
    ("shutter", FLAG),  # an image is exposed in this cycle
    ("fresh", FLAG),  # the landmarks of the last image arrive in this cycle
)

#: Ideal instruments sit at the centre of mass and measure the present state; the ideal inertial unit measures
#: with a delay of some cycles.
SENSED = record(
    ("t", "f8"),  # s, flight time
    ("r_I", "f8", (3,)),  # m, I: position of the centre of mass
    ("v_I", "f8", (3,)),  # m/s, I: its inertial velocity
    ("q_I2B", "f8", (4,)),  # attitude of B in I, unit quaternion, scalar first
    ("w_B", "f8", (3,)),  # rad/s, B: rate of B relative to I
    ("specific_force_B", "f8", (3,)),  # m/s2, B: acceleration of the centre of mass without gravity
    ("height_above_ground", "f8"),  # m, of the centre of mass above the ground below
    ("imu_rate_B", "f8", (3,)),  # rad/s, B: rate of B relative to I, read by the ideal inertial unit
    ("imu_gain_B", "f8", (3,)),  # m/s, B: integral of the specific force, by the ideal unit
    ("inertial", INERTIAL),  # of the inertial unit, some cycles old
    ("stars", STARS),  # of the star trackers
    ("radar", RADAR),  # of the landing radar
    ("tracking", TRACKING),  # of ground tracking
    ("pressure", "f8", (MAX_PORTS,)),  # Pa, at each port of the air data system
    ("branch_used", "f8", (MAX_BRANCHES,)),  # kg, through each branch since the start; some cycles old
    ("footpad_contact", FLAG),  # a footpad touches the ground
    ("wing_open", FLAG),  # end switch of the trim wing
    ("lidar", LIDAR),  # of the scanning lidar
    ("stereo", STEREO),  # of the pair of stereo cameras
    ("camera", CAMERA),  # of the landing camera
    ("landmarks", LANDMARKS),  # of the landmark camera
)


#: The flight computer's model of an imager.
IMAGER = record(
    ("place", "f8", (3,)),  # m, B
    ("tangent", "f8"),  # of half the field of view; 0: there is no such imager
    ("sigma", "f8"),  # m: standard deviation of a range; of the camera, which measures none, 0
    ("sigma_square", "f8"),  # 1/m: added to sigma, times the square of the range
)

#: The imagers of a lander.
IMAGERS = record(
    ("camera", IMAGER),  # landing camera
    ("lidar", IMAGER),  # scanning lidar
    ("stereo", IMAGER),  # pair of stereo cameras
)


@kernel
def cell_direction(tangent, cells, row, column):
    """Unit vector (B) through the middle of the cell (``row``, ``column``) of ``cells`` along each side.

    Rows and columns need not be whole: half a cell more or less is the rim of the cell.
    """
    y = tangent * ((2.0 * column + 1.0) / cells - 1.0)
    z = tangent * ((2.0 * row + 1.0) / cells - 1.0)
    inverse = 1.0 / sqrt(1.0 + y * y + z * z)
    return inverse, y * inverse, z * inverse
