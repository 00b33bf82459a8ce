"""A digital terrain model around the site, in place of the global map."""

from __future__ import annotations

from typing import Literal

import numpy as np

from edl6dof.config.base import Params, param
from edl6dof.kernels import kernel
from edl6dof.spatial.table_index import held_cell
from edl6dof.spatial.vector import clamp

NODES = 512
#: ``height`` m, above that at the site: rows from the south, columns from the west; ``reach`` m: from the
#: site, which is in the middle, to its edges, 0 where there is no model.
DTM = np.dtype([("height", "f4", (NODES, NODES)), ("reach", "f8")], align=True)
#: Share of the reach over which it passes into the map.
_EDGE = 0.1


class DtmParams(Params):
    """A digital terrain model from a file: a square around the site is cut out, resampled to 512 x 512 nodes
    and shifted to the site's elevation; towards its edge it passes into the map.
    """

    file: str = param(
        "", "ESRI ASCII grid (.asc) or GeoTIFF (.tif), an absolute path; empty for none", record=False
    )
    reach_m: float = param(1000.0, "from the site to the edges of the square", record=False, ge=10.0, le=50e3)
    coordinates: Literal["site_metres", "degrees"] = param(
        "site_metres",
        "what an ASCII grid counts in: m east and north of the site, or deg of longitude and latitude",
        record=False,
    )


@kernel
def with_dtm(dtm, site_elevation, north, east, below):
    """The ground of the model at a place (m from the site), where there is one: elevation (m) and rise per
    metre towards north and east.

    Args:
        dtm: ``DTM``.
        site_elevation: m.
        north, east: the place.
        below: the same three of the map.
    """
    edge = _EDGE * dtm.reach
    off = max(abs(north), abs(east))
    if not off < dtm.reach:
        return below
    step = 2.0 * dtm.reach / (NODES - 1)
    i, u = held_cell((north + dtm.reach) / step, NODES - 1)
    j, t = held_cell((east + dtm.reach) / step, NODES - 1)
    sw, se = float(dtm.height[i, j]), float(dtm.height[i, j + 1])
    nw, ne = float(dtm.height[i + 1, j]), float(dtm.height[i + 1, j + 1])
    south, up = sw + t * (se - sw), nw + t * (ne - nw)
    differ = site_elevation + south + u * (up - south) - below[0]
    to_north = (up - south) / step - below[1]
    to_east = ((1.0 - u) * (se - sw) + u * (ne - nw)) / step - below[2]
    share = clamp((dtm.reach - off) / edge, 0.0, 1.0)
    fall_north = fall_east = 0.0
    if share < 1.0:
        if abs(north) >= abs(east):
            fall_north = -1.0 / edge if north > 0.0 else 1.0 / edge
        else:
            fall_east = -1.0 / edge if east > 0.0 else 1.0 / edge
    return (
        below[0] + share * differ,
        below[1] + share * to_north + fall_north * differ,
        below[2] + share * to_east + fall_east * differ,
    )
