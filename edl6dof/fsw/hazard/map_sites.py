"""Sites of the map: the landing site is one of the safe places that are known before the flight.

At the start of powered descent, the lander chooses the site nearest to the point to which coarse avoidance
would divert without an image: ahead with its drift, and aside against it, away from backshell and canopy. A
site nearer than ``keep_clear_m`` to where these may be is chosen only if all others are nearer still. The
site has coordinates of the map, so the error of the landing is that of navigation relative to the map, and of
control. The sites form a square lattice about the landing site; a real map has a list.

Source: Brugarolas, Johnson et al., the safe target selection of Mars 2020, in Nelessen et al., Mars 2020
entry, descent, and landing system overview, IEEE Aerospace Conference (2019); the lattice: this project.
"""

from __future__ import annotations

from math import sqrt

from edl6dof.config.base import Params, param
from edl6dof.fsw.hazard.coarse_avoidance import distance_from_drifts
from edl6dof.kernels import kernel
from edl6dof.spatial.table_index import endless_cell


class MapSitesParams(Params):
    """Safe sites of the map."""

    spacing_m: float = param(
        0.0,
        "distance between neighbouring safe sites, north and east; 0: the map has none",
        status="estimate",
        ge=0.0,
        le=1e4,
    )


#: Sites along each side of the square from which one is chosen.
_ROWS = 4


@kernel
def choose_site(params, coarse, nav, drift):
    """Return east and north (m, L) of the chosen site.

    Args:
        params, coarse: parameters of the sites and of coarse avoidance.
        nav: ``NAV`` record.
        drift: predicted paths of backshell and canopy.
    """
    side = sqrt(nav.v_N[0] * nav.v_N[0] + nav.v_N[1] * nav.v_N[1])
    away = coarse.lead - coarse.divert / max(side, 1e-3)
    wanted_e, wanted_n = nav.site_L[0] + away * nav.v_N[1], nav.site_L[1] + away * nav.v_N[0]
    left = endless_cell(wanted_e / params.spacing) - _ROWS // 2 + 1
    first = endless_cell(wanted_n / params.spacing) - _ROWS // 2 + 1
    chosen, best = (wanted_e, wanted_n), (2, 0.0)
    for a in range(_ROWS):
        for b in range(_ROWS):
            east, north = (left + b) * params.spacing, (first + a) * params.spacing
            clear = distance_from_drifts(drift, coarse.spread, east, north)
            off = sqrt((east - wanted_e) ** 2 + (north - wanted_n) ** 2)
            mark = (0, off) if clear >= coarse.keep_clear else (1, -clear)
            if mark[0] < best[0] or (mark[0] == best[0] and mark[1] < best[1]):
                chosen, best = (east, north), mark
    return chosen
