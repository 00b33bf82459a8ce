"""Global maps of heights, a degree from place to place: of the ground and of the areoid."""

from __future__ import annotations

from math import pi

import numpy as np

from edl6dof.kernels import kernel
from edl6dof.spatial.elementary import cos, sin
from edl6dof.spatial.table_index import cell, held_cell, wrapped

#: Rows of planetocentric latitude 89.5 to -89.5, columns of longitude -179.5 to 179.5 deg.
SHAPE = (180, 360)
#: A map: ``height`` m; ``radius`` m: mean radius of its planet, 0 where there is no map; ``centric``:
#: geocentric = geodetic - this * sin(2 geodetic), to 2e-5 rad.
HEIGHT_MAP = np.dtype([("height", "f4", SHAPE), ("radius", "f8"), ("centric", "f8")], align=True)


@kernel
def map_height(grid, lat, lon):
    """Height (m) and rise per metre towards north and east on a map, at geodetic ``lat`` and east ``lon``,
    rad: bilinear, so heights are continuous and slopes are not.
    """
    centric = lat - grid.centric * sin(2.0 * lat)
    row, u = held_cell(89.5 - centric * (180.0 / pi), 179)
    column, t = cell(wrapped(lon * (180.0 / pi) + 179.5, 360.0), 360)
    right = (column + 1) % 360
    nw = float(grid.height[row, column])
    ne = float(grid.height[row, right])
    sw = float(grid.height[row + 1, column])
    se = float(grid.height[row + 1, right])
    top = nw + t * (ne - nw)
    bottom = sw + t * (se - sw)
    per_degree = 180.0 / (pi * grid.radius)
    east = ((ne - nw) * (1.0 - u) + (se - sw) * u) * per_degree / max(cos(lat), 0.01)
    return top + u * (bottom - top), (top - bottom) * per_degree, east
