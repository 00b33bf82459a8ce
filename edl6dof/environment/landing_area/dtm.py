"""A digital terrain model around the site, in place of the global map."""

from __future__ import annotations

from functools import lru_cache
from math import ceil, floor
from pathlib import Path
from typing import Any, Literal, NamedTuple

import numpy as np

from edl6dof.config.base import Params, param
from edl6dof.config.document.regular import read_regular_text
from edl6dof.environment.height_map import MapFile
from edl6dof.kernels import kernel
from edl6dof.records import record
from edl6dof.spatial.table_index import held_cell
from edl6dof.spatial.vector import clamp

NODES = 512
#: ``height`` m, above that at the site: rows from the south, columns from the west; ``reach`` m: from the
#: site, which is in the middle, to its edges, 0 where there is no model.
DTM = record(("height", "f4", (NODES, NODES)), ("reach", "f8"))
#: Share of the reach over which it passes into the map.
_EDGE = 0.1


class DtmParams(Params):
    """A digital terrain model from a file: a square around the site is cut out, resampled to 512 x 512 nodes
    and shifted to the site's elevation; towards its edge it passes into the map.
    """

    file: str = param(
        "", "ESRI ASCII grid (.asc) or GeoTIFF (.tif), an absolute path; empty for none", record=False
    )
    reach_m: float = param(
        1000.0, "distance from the site to the edges of the square", record=False, ge=10.0, le=50e3
    )
    coordinates: Literal["site_metres", "degrees"] = param(
        "site_metres",
        "coordinates of an ASCII grid: m east and north of the site, or deg of longitude and latitude",
        record=False,
    )


@kernel
def with_dtm(dtm, site_elevation, north, east, below):
    """Elevation (m) and rise per metre towards north and east of the ground at a place (m from the site):
    those of the model where it reaches, else ``below``, those of the map.
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


#: Size, in bytes, of the largest ASCII grid that is read.
LARGEST_GRID = 400_000_000
_HEAD = ("ncols", "nrows", "cellsize")


class Square(NamedTuple):
    """The square of ground that a model is cut out for: its middle (geodetic, rad), metres per radian of
    latitude and longitude, and the distance (m) from its middle to its edges.
    """

    latitude: float
    longitude: float
    metres_north: float
    metres_east: float
    reach: float


class DtmFile(NamedTuple):
    """File of a model as it is on disk, coordinates where the format has none, and the square to cut out."""

    file: MapFile
    coordinates: str
    square: Square


class Raster(NamedTuple):
    """Heights (m, NaN where there are none) on a grid: rows, columns; coordinates of the first, and the steps
    to the next, along the columns (x) and along the rows (y).
    """

    heights: np.ndarray
    x: float
    y: float
    step_x: float
    step_y: float


@lru_cache(maxsize=4)
def read_dtm(source: DtmFile) -> np.void:
    """Read a model, ``DTM``, shared and read-only.

    Raises:
        OSError: the file cannot be read.
        ValueError: the file is no grid of heights, or does not cover the square.
        ModuleNotFoundError: the file is a GeoTIFF, and rasterio is not installed.
    """
    path, square = source.file.path, source.square
    away = np.linspace(-square.reach, square.reach, NODES)
    north, east = np.meshgrid(away, away, indexing="ij")
    in_degrees = (
        np.degrees(square.latitude + north / square.metres_north),
        np.degrees(square.longitude + east / square.metres_east),
    )
    if path.suffix.lower() in (".tif", ".tiff"):
        heights = _from_geotiff(path, *in_degrees)
    else:
        y, x = in_degrees if source.coordinates == "degrees" else (north, east)
        heights = _sampled(path.name, _read_ascii(path), x, y)
    if missing := int(np.count_nonzero(~np.isfinite(heights))):
        raise ValueError(
            f"{path.name} has no heights at {missing / heights.size:.1%} of the square: fill its holes"
        )
    record = np.zeros(1, DTM)
    middle = heights[NODES // 2 - 1 : NODES // 2 + 1, NODES // 2 - 1 : NODES // 2 + 1].mean()
    record["height"], record["reach"] = heights - middle, square.reach
    if not np.all(np.isfinite(record["height"])):
        raise ValueError(f"{path.name} holds heights that no ground has")
    record.flags.writeable = False
    return record[0]


def _read_ascii(path: Path) -> Raster:
    """An ESRI ASCII grid: lines ``key value``, then rows from the north."""
    lines = read_regular_text(path, LARGEST_GRID).splitlines()
    head: dict[str, float] = {}
    while len(head) < len(lines) and len(words := lines[len(head)].split()) == 2 and words[0][:1].isalpha():
        key = words[0].lower()
        try:
            head[key] = float(words[1])
        except ValueError:
            raise ValueError(
                f"{path.name} line {len(head) + 1}: {key} must be a number (got {words[1]!r})"
            ) from None
    corner = "xllcorner" in head and "yllcorner" in head
    missing = [key for key in _HEAD if not head.get(key, 0.0) > 0.0]
    if not corner and not ("xllcenter" in head and "yllcenter" in head):
        missing.append("xllcorner and yllcorner (or xllcenter and yllcenter)")
    if missing:
        raise ValueError(f"{path.name} is no ESRI ASCII grid: its head must give {', '.join(missing)}")
    rows, columns, step = int(head["nrows"]), int(head["ncols"]), head["cellsize"]
    try:
        values = np.array(" ".join(lines[len(head) :]).split(), dtype=float)
    except ValueError as error:
        raise ValueError(f"{path.name} must hold numbers after its head: {error}") from None
    if min(rows, columns) < 2:
        raise ValueError(f"{path.name} must hold two rows and columns at least")
    if values.size != rows * columns:
        raise ValueError(f"{path.name} must hold {rows} x {columns} heights (got {values.size})")
    values[values == head.get("nodata_value", -9999.0)] = np.nan
    shift = 0.5 * step if corner else 0.0
    x, y = (head["xllcorner"], head["yllcorner"]) if corner else (head["xllcenter"], head["yllcenter"])
    return Raster(values.reshape(rows, columns)[::-1], x + shift, y + shift, step, step)


def _from_geotiff(path: Path, latitude: np.ndarray, longitude: np.ndarray) -> np.ndarray:
    """Heights of a GeoTIFF at places (deg)."""
    try:
        import rasterio
        from rasterio.errors import RasterioError
    except ModuleNotFoundError:
        raise ModuleNotFoundError(
            "a GeoTIFF needs rasterio, which is not installed; try: pip install 'edl6dof[terrain]', "
            "or turn the file into an ESRI ASCII grid"
        ) from None
    try:
        # without the driver's name GDAL takes any form, some of which name other files and addresses
        with rasterio.open(path, driver="GTiff") as data:
            x, y = _in_its_coordinates(path.name, data, latitude, longitude)
            return _sampled(path.name, _window(path.name, data, x, y), x, y)
    except RasterioError as error:
        raise ValueError(f"{path.name} is no GeoTIFF that can be read: {error}") from None


def _in_its_coordinates(name: str, data: Any, latitude: np.ndarray, longitude: np.ndarray) -> tuple:
    """Places (deg) in the coordinates of a dataset."""
    from rasterio.crs import CRS
    from rasterio.warp import transform

    if data.crs is None:
        raise ValueError(f"{name} does not say what its coordinates are (no coordinate reference system)")
    if data.crs.is_geographic:
        return longitude, latitude
    figure = {
        key: value
        for key, value in data.crs.to_dict().items()
        if key in ("a", "b", "R", "ellps", "datum", "rf")
    }
    globe = CRS.from_dict({"proj": "longlat", **figure})
    x, y = transform(globe, data.crs, longitude.ravel().tolist(), latitude.ravel().tolist())
    return np.reshape(x, latitude.shape), np.reshape(y, latitude.shape)


def _window(name: str, data: Any, x: np.ndarray, y: np.ndarray) -> Raster:
    """Part of a dataset that contains some places, read no finer than their spacing."""
    from rasterio.enums import Resampling
    from rasterio.windows import Window

    grid = data.transform
    if grid.b or grid.d:
        raise ValueError(f"{name} is turned against its coordinates: warp it north up")
    columns, rows = (np.array((v.min(), v.max())) for v in ((x - grid.c) / grid.a, (y - grid.f) / grid.e))
    left, right = max(floor(columns[0]) - 1, 0), min(ceil(columns[1]) + 1, data.width)
    top, bottom = max(floor(rows[0]) - 1, 0), min(ceil(rows[1]) + 1, data.height)
    if right - left < 2 or bottom - top < 2:
        raise ValueError(f"{name} does not reach the landing site")
    shape = min(bottom - top, 2 * NODES), min(right - left, 2 * NODES)
    part = Window(left, top, right - left, bottom - top)
    heights = data.read(1, window=part, out_shape=shape, resampling=Resampling.average, masked=True)
    step_x, step_y = grid.a * (right - left) / shape[1], grid.e * (bottom - top) / shape[0]
    first = grid.c + grid.a * left + 0.5 * step_x, grid.f + grid.e * top + 0.5 * step_y
    return Raster(heights.astype(float).filled(np.nan), *first, step_x, step_y)


def _sampled(name: str, raster: Raster, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Heights of a raster at places in its coordinates: bilinear; of block means where the raster is finer
    than the places.
    """
    skip = max(int(np.ptp(x) / (NODES - 1) / abs(raster.step_x)), 1)
    if skip > 1:
        raster = _coarser(raster, skip)
    rows, columns = raster.heights.shape
    row, column = (y - raster.y) / raster.step_y, (x - raster.x) / raster.step_x
    outside = max(-row.min(), -column.min(), row.max() - (rows - 1), column.max() - (columns - 1))
    if outside > 0.5:
        raise ValueError(f"{name} does not cover the square around the site: choose a smaller reach_m")
    i, j = (np.clip(v.astype(int), 0, n - 2) for v, n in ((row, rows), (column, columns)))
    u, t = np.clip(row - i, 0.0, 1.0), np.clip(column - j, 0.0, 1.0)
    z = raster.heights
    south, north = z[i, j] * (1.0 - t) + z[i, j + 1] * t, z[i + 1, j] * (1.0 - t) + z[i + 1, j + 1] * t
    return south * (1.0 - u) + north * u


def _coarser(raster: Raster, skip: int) -> Raster:
    """Means of blocks of ``skip`` by ``skip``; an incomplete block at the far edges is left out."""
    rows, columns = (n // skip for n in raster.heights.shape)
    blocks = raster.heights[: rows * skip, : columns * skip].reshape(rows, skip, columns, skip)
    half = 0.5 * (skip - 1)
    return Raster(
        blocks.mean(axis=(1, 3)),
        raster.x + half * raster.step_x,
        raster.y + half * raster.step_y,
        skip * raster.step_x,
        skip * raster.step_y,
    )
