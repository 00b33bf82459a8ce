"""Make the map of a planet's areoid from its gravity field.

    python tools/areoid.py mars edl6dof/data/areoid/mars_gmm3_degree12.npy

The areoid is the surface on which the potential of gravity and rotation is the mean of that potential over
the equator at the radius that the field refers to (Mars: 3,396 km; Smith et al., JGR 106 (2001) 23,689,
section 5.1).  The map holds its height above the ellipsoid of the planet file, along the ellipsoid's normal,
in the rows and columns of ``edl6dof.environment.height_map``; a file beside it says what it is of.
"""

from __future__ import annotations

import argparse
from math import sqrt
from pathlib import Path

import numpy as np
import yaml

from edl6dof.config.document.source import read_document
from edl6dof.config.validate import validate
from edl6dof.environment.gravity import MAX_DEGREE, read_coefficients
from edl6dof.environment.height_map import DATA, SHAPE
from edl6dof.environment.planet import PlanetParams

#: Below this change (m) the height stands.
_CLOSE = 1e-4


class Field:
    """The potential of gravity and rotation of a planet."""

    def __init__(self, planet: PlanetParams) -> None:
        self.radius, self.mu, self._C, self._S = read_coefficients(planet.gravity.coefficients)
        self._spin = planet.rotation_rate_rad_s

    def potential(self, x: np.ndarray, y: np.ndarray, z: np.ndarray) -> np.ndarray:
        """Potential (m2/s2), positive, at planet-fixed positions (m) of any one shape.

        Source: normalised solid harmonics by Holmes and Featherstone, Journal of Geodesy 76 (2002), eq. 11.
        """
        r2 = x * x + y * y + z * z
        ratio = self.radius / r2
        total = np.zeros_like(r2)
        V, W = self.radius / np.sqrt(r2), np.zeros_like(r2)  # of degree and order m
        for m in range(MAX_DEGREE + 1):
            v, w, v_before, w_before = V, W, np.zeros_like(V), np.zeros_like(W)
            for n in range(m, MAX_DEGREE + 1):
                total += self._C[n, m] * v + self._S[n, m] * w
                up = sqrt((2 * n + 3) * (2 * n + 1) / ((n + 1 - m) * (n + 1 + m)))
                back = sqrt((2 * n + 3) * (n + m) * (n - m) / ((2 * n - 1) * (n + 1 - m) * (n + 1 + m)))
                down = back * self.radius * ratio
                v, v_before = up * z * ratio * v - down * v_before, v
                w, w_before = up * z * ratio * w - down * w_before, w
            sector = (sqrt((2 * m + 3) / (2 * m + 2)) if m else sqrt(3.0)) * ratio
            V, W = sector * (x * V - y * W), sector * (x * W + y * V)
        return self.mu / self.radius * total + 0.5 * self._spin**2 * (x * x + y * y)

    def on_the_areoid(self) -> float:
        """The potential on the areoid, m2/s2."""
        around = np.linspace(0.0, 2.0 * np.pi, 720, endpoint=False)
        x, y = self.radius * np.cos(around), self.radius * np.sin(around)
        return float(self.potential(x, y, np.zeros_like(x)).mean())


def areoid(planet: PlanetParams) -> np.ndarray:
    """Height (m) of the areoid above the ellipsoid, shape (180, 360)."""
    centric, lon = np.meshgrid(
        np.radians(89.5 - np.arange(SHAPE[0])), np.radians(np.arange(SHAPE[1]) - 179.5), indexing="ij"
    )
    keep = (1.0 - planet.flattening) ** 2
    lat = np.arctan2(np.sin(centric), keep * np.cos(centric))  # of the normal at that point of the ellipsoid
    prime = planet.equatorial_radius_m / np.sqrt(1.0 - (1.0 - keep) * np.sin(lat) ** 2)
    field = Field(planet)
    goal, fall = field.on_the_areoid(), field.mu / planet.mean_radius_m**2
    height, change = np.zeros(SHAPE), np.full(SHAPE, np.inf)
    while np.abs(change).max() > _CLOSE:
        level = (prime + height) * np.cos(lat)
        z = (keep * prime + height) * np.sin(lat)
        change = (field.potential(level * np.cos(lon), level * np.sin(lon), z) - goal) / fall
        height += change
    return height


def main() -> None:
    """Make the map."""
    parser = argparse.ArgumentParser(description="Make the map of a planet's areoid.")
    parser.add_argument("planet", help="name of the planet's file in edl6dof/data/planets")
    parser.add_argument("map", type=Path, help="the .npy file to write; a .yaml is written beside it")
    options = parser.parse_args()
    file = DATA / "planets" / f"{options.planet}.yaml"
    planet = validate(PlanetParams, read_document(file, {}))
    np.save(options.map, areoid(planet).astype("f4"))
    about = {
        "planet": planet.name,
        **{name: getattr(planet, name) for name in ("mean_radius_m", "equatorial_radius_m", "flattening")},
        "origin": f"tools/areoid.py from {planet.gravity.coefficients}, degree {MAX_DEGREE}",
        "licence": "public domain, as the coefficients",
    }
    head = f"# The planet of {options.map.name}, and the ellipsoid that its heights count from.\n"
    options.map.with_suffix(".yaml").write_text(
        head + yaml.safe_dump(about, sort_keys=False), encoding="utf-8"
    )


if __name__ == "__main__":
    main()
