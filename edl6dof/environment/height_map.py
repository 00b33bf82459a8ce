"""Global maps of height with a spacing of one degree, of the ground and of the areoid: their files, and the
planets that they belong to.
"""

from __future__ import annotations

from errno import EINVAL
from functools import lru_cache
from io import BytesIO
from pathlib import Path
from stat import S_ISREG
from typing import NamedTuple

import numpy as np
import yaml

from edl6dof.config.document.regular import read_regular, read_regular_text
from edl6dof.records import record

DATA = Path(__file__).resolve().parents[1] / "data"
#: Rows of planetocentric latitude 89.5 to -89.5, columns of longitude -179.5 to 179.5 deg.
SHAPE = (180, 360)
#: A map: ``height`` m; ``radius`` m: mean radius of its planet, 0 where there is no map; ``centric``:
#: geocentric = geodetic - this * sin(2 geodetic), to 2e-5 rad.
HEIGHT_MAP = record(("height", "f4", SHAPE), ("radius", "f8"), ("centric", "f8"))
#: Largest relative difference of the mean radii of a map's planet and of the one it is flown over.
_SAME_PLANET = 1e-2


class MapFile(NamedTuple):
    """A map file (``.npy``) as it is on disk; a ``.yaml`` file of the same name describes its planet."""

    path: Path
    modified_ns: int
    size: int

    @property
    def about(self) -> Path:
        """Path of the YAML file that describes the planet of the map."""
        return self.path.with_suffix(".yaml")


class MappedPlanet(NamedTuple):
    """The planet of a map: its name, its radii in m, and its flattening."""

    planet: str
    mean_radius_m: float
    equatorial_radius_m: float
    flattening: float


def map_file(path: Path) -> MapFile:
    """Map file at a path.

    Raises:
        OSError: there is no map, or it is no regular file.
    """
    found = path.stat()
    if not S_ISREG(found.st_mode):
        raise OSError(EINVAL, "it is not a regular file", str(path))
    return MapFile(path, found.st_mtime_ns, found.st_size)


@lru_cache(maxsize=8)
def read_map(file: MapFile) -> np.void:
    """A map (``HEIGHT_MAP``), shared and read-only.

    Raises:
        OSError: it cannot be read.
        ValueError: the file is no map.
    """
    about = mapped_planet(file)
    heights = _numbers(file.path)
    if heights.shape != SHAPE or not np.all(np.isfinite(heights)):
        raise ValueError(f"{file.path.name} must hold finite numbers, shape {SHAPE} (got {heights.shape})")
    record = np.zeros(1, HEIGHT_MAP)
    record["height"], record["radius"] = heights, about.mean_radius_m
    record["centric"] = about.flattening + 0.5 * about.flattening * about.flattening
    record.flags.writeable = False
    return record[0]


@lru_cache(maxsize=8)
def mapped_planet(file: MapFile) -> MappedPlanet:
    """The planet of a map.

    Raises:
        OSError: the YAML file of the map cannot be read.
        ValueError: a value is missing in that file.
    """
    try:
        about = yaml.safe_load(read_regular_text(file.about))
        return MappedPlanet(str(about["planet"]), *(float(about[name]) for name in MappedPlanet._fields[1:]))
    except (yaml.YAMLError, KeyError, TypeError, ValueError) as error:
        raise ValueError(f"{file.about.name} must give {', '.join(MappedPlanet._fields)}") from error


def _numbers(path: Path) -> np.ndarray:
    """The array of a ``.npy`` file, as numbers."""
    content = read_regular(path)
    try:
        return np.load(BytesIO(content), allow_pickle=False).astype("f4")
    except Exception as error:  # a broken head makes numpy raise errors of half a dozen kinds
        raise ValueError(f"{path.name} is no .npy file of numbers") from error


def require_map_of(file: MapFile, planet_radius_m: float, called: str, instead: str) -> None:
    """Check that a map belongs to a planet with this mean radius.  For the message: ``called``, the key of
    the map in the scenario; ``instead``, the advice.

    Raises:
        ValueError: the mean radii differ by more than 1 %.
        OSError: as :func:`mapped_planet`.
    """
    radius = mapped_planet(file).mean_radius_m
    if abs(planet_radius_m / radius - 1.0) > _SAME_PLANET:
        raise ValueError(
            f"{called!r} is the map of a planet of planet.mean_radius_m {radius:.0f}, not "
            f"{planet_radius_m:.0f}: {instead}"
        )
