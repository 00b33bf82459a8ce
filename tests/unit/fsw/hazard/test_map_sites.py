"""Verifies: the lander chooses the site nearest to the divert point that is clear of predicted paths."""

import numpy as np
import pytest
from charts import new

from edl6dof.config.dtype import dtype_of, fill
from edl6dof.fsw.hazard.coarse_avoidance import COARSE, CoarseParams
from edl6dof.fsw.hazard.map_sites import MapSitesParams, choose_site
from edl6dof.fsw.navigation.derived import NAV

SPACING, LEAD, DIVERT, CLEAR = 100.0, 12.0, 170.0, 150.0
LATTICE = SPACING * np.stack(np.meshgrid(*2 * [np.arange(-30, 31)]), -1).reshape(-1, 2)


def filled(params):
    out = np.zeros(1, dtype_of(type(params)))
    fill(out[0], params)
    return out[0]


def chosen(east_north, velocity, drift):
    """The chosen site, and the divert point: ``velocity`` east and north (m/s)."""
    nav = new(NAV)
    nav["site_L"][:2], nav["v_N"] = east_north, (velocity[1], velocity[0], 60.0)
    coarse = filled(CoarseParams(lead_s=LEAD, divert_m=DIVERT, keep_clear_m=CLEAR, spread_m_s=0.0))
    wanted = east_north + velocity * (LEAD - DIVERT / np.hypot(*velocity))
    return np.array(choose_site(filled(MapSitesParams(spacing_m=SPACING)), coarse, nav, drift)), wanted


def path(start, end):
    drift = new(COARSE)["drift"]
    drift[0]["count"] = 2
    drift[0]["place_L"][:2, :2] = start, end
    return drift


def test_without_paths_the_nearest_site_is_chosen():
    rng = np.random.default_rng(1)
    for _ in range(50):
        place, velocity = rng.uniform(-900.0, 900.0, 2), rng.uniform(-30.0, 30.0, 2)
        site, wanted = chosen(place, velocity, new(COARSE)["drift"])
        assert site == pytest.approx(min(LATTICE, key=lambda one: np.hypot(*(one - wanted))))


def test_a_site_near_a_predicted_path_is_not_chosen():
    """The path runs along north through the divert point: sites 150 m east or west of it are clear."""
    place, velocity = np.array([230.0, -410.0]), np.array([0.0, 20.0])
    _, wanted = chosen(place, velocity, new(COARSE)["drift"])
    site, _ = chosen(place, velocity, path(wanted - (0.0, 2000.0), wanted + (0.0, 2000.0)))
    off = abs(site[0] - wanted[0])
    assert off >= CLEAR and off == pytest.approx(min(d for d in abs(LATTICE[:, 0] - wanted[0]) if d >= CLEAR))


def test_without_a_clear_site_the_one_farthest_from_the_paths_is_chosen():
    place, velocity = np.array([230.0, -410.0]), np.array([0.0, 20.0])
    drift = path((150.0, -3000.0), (150.0, 3000.0))
    drift[1]["count"] = 2
    drift[1]["place_L"][:2, :2] = (330.0, -3000.0), (330.0, 3000.0)
    site, wanted = chosen(place, velocity, drift)
    near = LATTICE[np.all(abs(LATTICE - wanted) < 2.0 * SPACING, axis=1)]
    clear = np.minimum(abs(near[:, 0] - 150.0), abs(near[:, 0] - 330.0))
    assert min(abs(site[0] - 150.0), abs(site[0] - 330.0)) == pytest.approx(clear.max())
