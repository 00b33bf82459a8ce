"""Digital terrain models from files: the ground is the file's inside the square, the map's outside, and
mistakes are named.
"""

import os
import re
import sys
from math import cos, radians

import numpy as np
import pytest

from edl6dof.config.errors import ConfigError
from edl6dof.environment.landing_area.raster import RASTER_WORK, lay_raster
from edl6dof.environment.landing_area.relief import LandingAreaParams
from edl6dof.environment.terrain import (
    TERRAIN,
    TerrainParams,
    fill_terrain,
    geodetic_of,
    ground,
    ground_arrays,
    ground_inputs,
)
from edl6dof.scenario.loading import load_scenario

PLANET = load_scenario("tianwen1").scenario.planet
SITE = {"site_elevation_m": -4099.4, "site_latitude_deg": 25.066, "site_longitude_deg": 109.925}


def hill(north, east):
    """Height (m) of the ground in the files: a slope and a smooth hill."""
    return 1000.0 + 0.05 * east - 0.03 * north + 20.0 * np.exp(-((north - 50.0) ** 2 + east**2) / 2e4)


def write_ascii(path, step=5.0, half=600.0, corner=True, heights=None):
    """A grid of the hill around the site, rows from the north."""
    axis = np.arange(-half, half + 0.5 * step, step)
    z = hill(axis[::-1, None], axis) if heights is None else heights
    key, shift = ("corner", 0.5 * step) if corner else ("center", 0.0)
    first = -half - shift
    head = (
        f"ncols {z.shape[1]}\nnrows {z.shape[0]}\nxll{key} {first!r}\nyll{key} {first!r}\ncellsize {step!r}\n"
    )
    path.write_text(head + "NODATA_value -9999\n" + "\n".join(" ".join(map(repr, row)) for row in z.tolist()))
    return path


def build(file, reach=400.0, model="mola", **dtm):
    dtm = {"file": str(file), "reach_m": reach, **dtm}
    params = TerrainParams(**SITE, model=model, landing_area=LandingAreaParams(dtm=dtm))
    terrain, grid = np.zeros(1, TERRAIN)[0], ground_arrays(ground_inputs(params, PLANET))
    fill_terrain(terrain, params, grid, PLANET)
    return terrain, grid


def at(terrain, grid, north, east):
    return ground(terrain, grid, *geodetic_of(terrain, float(north), float(east)))


def check_hill(terrain, grid, tolerance):
    for north, east in ((0.0, 0.0), (50.0, 0.0), (-123.4, 210.7), (300.0, -340.0)):
        elevation, rise_north, rise_east = at(terrain, grid, north, east)
        assert elevation == pytest.approx(-4099.4 + hill(north, east) - hill(0.0, 0.0), abs=tolerance)
        slopes = (
            (hill(north + 1, east) - hill(north - 1, east)) / 2,
            (hill(north, east + 1) - hill(north, east - 1)) / 2,
        )
        assert (rise_north, rise_east) == pytest.approx(slopes, abs=2e-3)


@pytest.mark.parametrize(
    "step, corner",
    [(5.0, True), (1.7, False)]
    + [
        pytest.param(*case, marks=pytest.mark.long)
        for case in ((5.0, False), (1.7, True), (0.8, True), (0.8, False))
    ],
)
def test_ground_is_that_of_the_grid_shifted_to_the_site(tmp_path, corner, step):
    file = write_ascii(tmp_path / "hill.asc", step, 450.0 if step < 5.0 else 600.0, corner)
    check_hill(*build(file), tolerance=0.02)


def test_grid_in_degrees(tmp_path):
    terrain, _ = build(write_ascii(tmp_path / "metres.asc"))
    lat, lon = np.degrees([1.0 / terrain["metres_north"], 1.0 / terrain["metres_east"]])
    axis = np.arange(-150, 150) * 4.0 * lat  # deg from the site, both ways
    z = hill(axis[::-1, None] / lat, axis / lon)  # rows from the north
    first = [float(middle + axis[0]) for middle in (109.925, 25.066)]
    head = f"ncols 300\nnrows 300\nxllcenter {first[0]!r}\nyllcenter {first[1]!r}\n"
    file = tmp_path / "degrees.asc"
    rows = "\n".join(" ".join(map(repr, row)) for row in z.tolist())
    file.write_text(head + f"cellsize {4.0 * lat:.15g}\n" + rows)
    check_hill(*build(file, coordinates="degrees"), tolerance=0.05)


def test_it_passes_into_the_map_at_its_edge_without_a_step_and_with_its_gradient(tmp_path):
    terrain, grid = build(write_ascii(tmp_path / "hill.asc"), model="plane")
    for place in ((401.0, 0.0), (-1e5, 3e6), (0.0, -400.5)):
        assert at(terrain, grid, *place) == (-4099.4, 0.0, 0.0)
    for north, east in ((399.999, 10.0), (-20.0, -399.999)):
        assert at(terrain, grid, north, east)[0] == pytest.approx(-4099.4, abs=1e-3)
    for north, east in ((380.3, 100.1), (-370.3, 20.7), (-12.3, 391.1), (77.7, -385.2), (200.1, 100.3)):
        d = 0.02
        _, rise_north, rise_east = at(terrain, grid, north, east)
        by_north = (at(terrain, grid, north + d, east)[0] - at(terrain, grid, north - d, east)[0]) / (2 * d)
        by_east = (at(terrain, grid, north, east + d)[0] - at(terrain, grid, north, east - d)[0]) / (2 * d)
        assert (rise_north, rise_east) == pytest.approx((by_north, by_east), abs=1e-6)


def test_raster_shows_it(tmp_path):
    terrain, grid = build(write_ascii(tmp_path / "hill.asc"))
    heights = np.zeros((128, 128), "f4")
    south, west = lay_raster(terrain, grid, 20.0, -50.0, heights, np.zeros(1, RASTER_WORK)[0])
    for a, b in ((0, 0), (60, 100), (127, 3)):
        own = at(terrain, grid, south + 0.1 * a, west + 0.1 * b)[0] + 4099.4
        assert heights[a, b] == pytest.approx(own, abs=3e-3)  # drawn straight over its bends


def write_geotiff(path, heights, transform, crs):
    rasterio = pytest.importorskip("rasterio")
    shape = {"height": heights.shape[0], "width": heights.shape[1]}
    kind = {"count": 1, "dtype": "float32", "nodata": -32768.0}
    with rasterio.open(path, "w", "GTiff", **shape, **kind, crs=crs, transform=transform) as file:
        file.write(heights.astype("f4"), 1)
    return path


@pytest.mark.parametrize("step", [pytest.param(0.5, marks=pytest.mark.long), 6.0])
def test_geotiff_of_a_projected_map_of_mars(tmp_path, step):
    rasterio = pytest.importorskip("rasterio")
    terrain, _ = build(write_ascii(tmp_path / "metres.asc"))
    radius = PLANET.equatorial_radius_m
    crs = rasterio.crs.CRS.from_dict(proj="eqc", lat_ts=25.0, lon_0=110.0, R=radius)
    x0, y0 = radius * cos(radians(25.0)) * radians(109.925 - 110.0), radius * radians(25.066)
    count = round(1100.0 / step)
    axis = (np.arange(count) + 0.5 - 0.5 * count) * step
    north = axis[::-1] * terrain["metres_north"] / radius
    east = axis * terrain["metres_east"] / (radius * cos(radians(25.0)))
    corner = rasterio.transform.from_origin(x0 - 0.5 * count * step, y0 + 0.5 * count * step, step, step)
    file = write_geotiff(tmp_path / "hill.tif", hill(north[:, None], east), corner, crs)
    check_hill(*build(file), tolerance=0.03)


def refused(file, **given):
    dtm = {"file": str(file), "reach_m": 400.0, **given}
    with pytest.raises(ConfigError) as caught:
        load_scenario("tianwen1", [f"terrain.landing_area.dtm.{key}={value}" for key, value in dtm.items()])
    assert "terrain.landing_area.dtm.file" in str(caught.value)
    return str(caught.value)


@pytest.mark.parametrize(
    "change, words",
    [
        (lambda text: text.replace("cellsize", "size"), "cellsize"),
        (lambda text: text.replace("ncols 241", "ncols 240"), "240 heights"),
        (lambda text: text.replace("ncols 241", "ncols many"), "line 1: ncols must be a number"),
        (lambda text: text.replace("xllcorner", "left"), "xllcorner"),
        (lambda text: text.replace("1000", "high"), "must hold numbers"),
        (lambda text: "", "no ESRI ASCII grid"),
        (lambda text: text.replace("ncols 241", "ncols inf"), "infinity"),
        (lambda text: text.replace("ncols 241", "ncols nan"), "ncols"),
        (lambda text: re.sub("nrows 241", "nrows 1", text).replace("ncols 241", "ncols 58081"), "two rows"),
        (lambda text: text.replace("1000.0", "1e300", 30000), "no ground has"),
        (lambda text: text.replace("cellsize 5.0", "cellsize 1e-320"), ""),
    ],
)
def test_bad_grids_are_refused_at_the_key(tmp_path, change, words):
    file = write_ascii(tmp_path / "hill.asc", heights=np.full((241, 241), 1000.0))
    file.write_text(change(file.read_text()))
    assert words in refused(file)


def test_holes_a_small_grid_and_a_missing_file_are_refused(tmp_path):
    z = np.full((241, 241), 5.0)
    z[100, 120] = -9999.0
    assert "fill its holes" in refused(write_ascii(tmp_path / "hole.asc", heights=z))
    assert "smaller reach_m" in refused(write_ascii(tmp_path / "hill.asc"), reach_m=700.0)
    assert "No such file" in refused(tmp_path / "none.asc")
    (tmp_path / "text.tif").write_text("no picture")
    pytest.importorskip("rasterio")
    assert "no GeoTIFF" in refused(tmp_path / "text.tif")
    rasterio = sys.modules["rasterio"]
    plain = write_geotiff(tmp_path / "plain.tif", z, rasterio.transform.from_origin(0, 0, 1, 1), None)
    assert "coordinate reference system" in refused(plain)


def test_file_that_names_other_files_is_no_geotiff(tmp_path):
    """GDAL would read it by its content, and whatever file or address it names."""
    pytest.importorskip("rasterio")
    source = "<SimpleSource><SourceFilename>/etc/passwd</SourceFilename></SimpleSource>"
    band = f"<VRTRasterBand dataType='Float32' band='1'>{source}</VRTRasterBand>"
    (tmp_path / "hill.tif").write_text(f"<VRTDataset rasterXSize='9' rasterYSize='9'>{band}</VRTDataset>")
    said = refused(tmp_path / "hill.tif")
    assert "no GeoTIFF" in said and "not recognized as being in a supported" in said


@pytest.mark.parametrize("name", ["hill.asc", "hill.tif"])
def test_pipe_is_not_waited_for(tmp_path, name):
    os.mkfifo(tmp_path / name)
    assert "not a regular file" in refused(tmp_path / name)


def test_without_rasterio_a_geotiff_says_what_to_install(tmp_path, monkeypatch):
    (tmp_path / "hill.tif").write_bytes(b"II*\0")
    monkeypatch.setitem(sys.modules, "rasterio", None)
    assert "pip install 'edl6dof[terrain]'" in refused(tmp_path / "hill.tif")
