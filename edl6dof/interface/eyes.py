"""Where the cells of an instrument look that makes an image of the ground: one geometry for all of them, for
the plant that makes the image and for the flight software that reads it.

An eye looks along x of B, down when the vehicle stands upright, from its place in B.  Its square field of
view is cut into cells of equal size on a plane across the line of sight; rows run along z of B, columns
along y.
"""

from __future__ import annotations

from math import sqrt

import numpy as np

from edl6dof.kernels import kernel

#: What the flight computer believes of an eye.
EYE = np.dtype(
    [
        ("place", "f8", (3,)),  # m, B
        ("tangent", "f8"),  # of half the field of view; 0: there is no such eye
        ("sigma", "f8"),  # m: standard deviation of a range; of the camera, which tells none, 0
        ("sigma_square", "f8"),  # 1/m: more of it, of the square of the range
    ],
    align=True,
)

#: The eyes of a lander.
EYES = np.dtype([("camera", EYE), ("lidar", EYE), ("stereo", EYE)], align=True)


@kernel
def look(tangent, cells, row, column):
    """Unit vector (B) along which the middle of the cell (``row``, ``column``) looks, of ``cells`` along each
    side.

    Rows and columns need not be whole: half a cell more or less is the rim of the cell.
    """
    y = tangent * ((2.0 * column + 1.0) / cells - 1.0)
    z = tangent * ((2.0 * row + 1.0) / cells - 1.0)
    inverse = 1.0 / sqrt(1.0 + y * y + z * z)
    return inverse, y * inverse, z * inverse
