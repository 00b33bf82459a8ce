"""The global map of heights that comes with the package, and the planet it is of."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import yaml

#: The map; beside it, as ``.yaml``, mean radius and flattening of its planet.
MAP = Path(__file__).resolve().parents[1] / "data" / "topography" / "mola_1deg_colat_lon.npy"
#: Largest relative difference of the mean radii of the map's planet and of the one it is flown over.
_SAME_PLANET = 1e-2


def read_map() -> tuple[np.ndarray, float, float]:
    """Heights (m) above the areoid, and mean radius (m) and flattening of the planet of the map."""
    planet = _planet()
    return np.load(MAP), planet["mean_radius_m"], planet["flattening"]


def require_map_of(planet_radius_m: float) -> None:
    """Refuse the map for another planet than its own.

    Args:
        planet_radius_m: mean radius of the planet to fly over.

    Raises:
        ValueError: the mean radii differ by more than 1 %.
    """
    radius = _planet()["mean_radius_m"]
    if abs(planet_radius_m / radius - 1.0) > _SAME_PLANET:
        raise ValueError(
            f"'mola' is the map of a planet of planet.mean_radius_m {radius:.0f}, not "
            f"{planet_radius_m:.0f}: use 'plane' or 'none'"
        )


@cache
def _planet() -> dict[str, float]:
    return yaml.safe_load(MAP.with_suffix(".yaml").read_text(encoding="utf-8"))
