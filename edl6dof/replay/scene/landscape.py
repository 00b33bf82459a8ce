"""The ground as drawn: the simulation's relief, and decoration (craters, ripples) where it has nothing finer
than the map.

The mesh widens geometrically from the touchdown to the other side of the planet, so that it is fine where the
camera ends up and a globe from afar; the ground of a landing area is also drawn on a square grid there, with
the rocks that lie on it.  Decoration is the same for every flight to a site, fades out where a vehicle
stands, and is unknown to the simulation.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import cos, hypot, pi, sin
from typing import NamedTuple

import numpy as np

from edl6dof.config.base import Vec3
from edl6dof.environment.planet import Tint
from edl6dof.replay.scene.mesh import (
    Mesh,
    bright,
    grid_triangles,
    open_grid_triangles,
    pole_triangles,
    sphere,
)
from edl6dof.replay.scene.poses import Site

RINGS, SPOKES = 300, 120
#: Share of the way to the other side of the planet at which the last ring lies.
_FAR = 0.97
#: Arc (m) beyond which the ground has the colours of the globe, and the share of haze before that.
_GLOBE, _HAZE = 4e5, 0.55
#: Contrast of the decorative tone far from the touchdown, where the mesh shows coarse waves only, and the arc
#: (m) over which it falls to that.
_FAINT, _FADES = 0.3, 5e3
#: Arc (m) up to which the ground is laid out as a plane.
_PLANE = 3e4
#: Share of the surface that craters of each size class cover.
_COVER = 0.055
#: The square on which a landing area is drawn: half its side, and the spacing of its vertices, m.
NEAR, SPACING = 36.0, 0.25
#: Depth (m) of the wide mesh below that square, share of the half side within which it is lowered, and share
#: in which the finer picture of the square fades into that of the wide mesh.
_SUNK, _WITHIN, _EDGE = 1.5, 0.97, 0.4
#: Least diameter (m) of rocks of a landing area that are drawn as such; smaller ones are bumps of the mesh.
_SMALLEST_ROCK = 0.4

#: Rows and columns of the sky, and width (texels) of a tile of noise.
_DOME, _TILE = (24, 48), 256
#: Mean and standard deviation of the grain of the ground, of 255; spokes or rings of the mesh in a tile.
SHADE, _GRAIN, _PER_TILE = 236, 9.0, 18.0


class Rocks(NamedTuple):
    """Boulders: places (n, 3) in L, sizes (n, 3) in m, headings (n,) in rad."""

    places: np.ndarray
    sizes: np.ndarray
    headings: np.ndarray


class Landscape:
    """The planet's ground as a mesh on rings around ``touchdown`` (m in L)."""

    def __init__(self, site: Site, touchdown: np.ndarray) -> None:
        self._seed = np.abs(site.origin).astype(np.int64)
        self._random = np.random.default_rng(self._seed)
        self._site = site
        self._centre = np.asarray(touchdown, float)[:2]
        self._radius = np.geomspace(1.5, _FAR * pi * site.radius, RINGS)
        turn = np.linspace(0.0, 2.0 * pi, SPOKES, endpoint=False)
        self._cos, self._sin = np.cos(turn), np.sin(turn)
        # relative to the touchdown, m
        self._east, self._north = self._radius[:, None] * self._cos, self._radius[:, None] * self._sin
        spacing = self._radius * 2.0 * pi / SPOKES
        shade, ripples = _waves(self._random, self._east, self._north, spacing[:, None])
        if site.relief.detailed:
            inside = np.maximum(np.abs(self._east), np.abs(self._north)) < _WITHIN * NEAR
            self._decoration = np.where(inside, -_SUNK, 0.0)
        else:
            calm = np.clip((self._radius - 6.0) / 50.0, 0.0, 1.0)[:, None]
            raised = ripples + self._craters()
            raised -= raised[0].mean() * np.exp(-self._radius / _FADES)[:, None]  # or it would lie in a pit
            self._decoration = calm**2 * (3.0 - 2.0 * calm) * raised
        self._elevation, self._place = self._laid()
        self._middle = float(site.ground(*self._centre)[1])
        self._shade = shade

    def _laid(self) -> tuple[np.ndarray, np.ndarray]:
        """Elevation (m) and places (m in L) of the vertices on the true ground: by east and north in L near
        the touchdown, by arcs on the planet beyond.
        """
        elevation, place = self._site.around(self._centre, self._east, self._north)
        near = self._radius < _PLANE
        east, north = self._east[near] + self._centre[0], self._north[near] + self._centre[1]
        elevation[near], up = self._site.ground(east, north)
        place[near] = np.stack([east, north, up], axis=-1)
        return elevation, place

    def mesh(self) -> Mesh:
        """Return the surface, coloured and shaded."""
        rise = np.gradient(self._elevation + self._decoration, self._radius, axis=0)
        around = self._around(self._elevation + self._decoration)
        rise_east = rise * self._cos - around * self._sin
        rise_north = rise * self._sin + around * self._cos
        contrast = _FAINT + (1.0 - _FAINT) * np.exp(-self._radius / _FADES)[:, None]
        shade = 0.5 + (self._shade - 0.5) * contrast
        colours = soil(self._site, shade, rise_east, rise_north)
        look, far = self._site.appearance, np.clip(self._radius / _GLOBE - 0.1, 0.0, 1.0)[:, None, None]
        globe = tints(look.relief, self._elevation / 1e3) * (0.75 + 0.5 * shade[..., None])
        colours += (globe - colours) * far
        haze = _HAZE * (1.0 - np.exp(-self._radius / 3e4))[:, None, None] * (1.0 - 0.5 * far)
        colours += (np.array(look.haze) - colours) * haze
        outward = self._place + self._site.axes @ self._site.origin
        outward /= np.linalg.norm(outward, axis=-1, keepdims=True)
        place = self._place + self._decoration[..., None] * outward
        ends = [[*self._centre, self._middle], place[-1].mean(axis=0)]
        positions = np.append(place.reshape(-1, 3), ends, axis=0)
        colours = np.append(colours.reshape(-1, 3), colours[[0, -1]].mean(axis=1), axis=0)
        fans = pole_triangles(RINGS, SPOKES)
        return bright(positions, np.concatenate([grid_triangles(RINGS, SPOKES), *fans]), colours)

    def near(self) -> Mesh | None:
        """Return the ground of a landing area around the touchdown; ``None`` for a site without one."""
        if not self._site.relief.detailed:
            return None
        side = np.arange(-NEAR, NEAR + 0.5 * SPACING, SPACING)
        east, north = np.meshgrid(side, side)
        up = self._site.ground(east + self._centre[0], north + self._centre[1])[1]
        fine, coarse = (
            _waves(np.random.default_rng(self._seed), east, north, np.full((len(side), 1), spacing))[0]
            for spacing in (SPACING, NEAR * 2.0 * pi / SPOKES)
        )
        fade = np.clip((1.0 - np.maximum(np.abs(east), np.abs(north)) / NEAR) / _EDGE, 0.0, 1.0)
        rise_north, rise_east = fade * np.gradient(up, SPACING)
        place = np.stack([east + self._centre[0], north + self._centre[1], up], axis=-1).reshape(-1, 3)
        colours = soil(self._site, coarse + fade * (fine - coarse), rise_east, rise_north).reshape(-1, 3)
        return bright(place, open_grid_triangles(len(side), len(side)), colours)

    def height(self, east: np.ndarray, north: np.ndarray) -> np.ndarray:
        """Return the up coordinate (m) of the drawn ground in L, decorated as at the nearest vertex."""
        up = np.asarray(self._site.ground(east, north)[1])
        if self._site.relief.detailed:
            return up
        x, y = east - self._centre[0], north - self._centre[1]
        i = np.searchsorted(self._radius, np.hypot(x, y)).clip(0, RINGS - 1)
        j = np.round(np.arctan2(y, x) * SPOKES / (2.0 * pi)).astype(int) % SPOKES
        return np.asarray(up + self._decoration[i, j])

    def above(self, places: np.ndarray, height: np.ndarray | float) -> np.ndarray:
        """Return places in L, shape (..., 3), ``height`` (m) above the drawn ground; ``places``: (..., 2)."""
        east, north = np.moveaxis(places, -1, 0)
        return np.stack([east, north, self.height(east, north) + height], axis=-1)

    def rocks(self) -> Rocks:
        """Return the rocks of a landing area around the touchdown; none for a site without one."""
        middle = float(self._centre[0]), float(self._centre[1])
        place = self._site.rocks(*middle, 4.0 * NEAR, _SMALLEST_ROCK)
        east, north, diameter = place.T
        up = self._site.ground(east, north)[1] - 0.5 * diameter
        sizes = diameter[:, None] * [1.1, 1.1, 1.5]
        heading = self._random.uniform(0.0, 2.0 * pi, len(place))
        return Rocks(np.column_stack([east, north, up]), sizes, heading)

    def _craters(self) -> np.ndarray:
        """Height (m) of craters at the vertices, as many of each size class as the mesh can show."""
        height = np.zeros_like(self._east)
        for diameter in np.geomspace(1.2, 3e4, 40):
            outer = min(
                diameter / 0.09, self._radius[-1]
            )  # beyond this radius the mesh is too coarse for them
            count = min(int(_COVER * outer**2 / (0.25 * diameter**2)), 90)
            distance = outer * np.sqrt(self._random.uniform(0.0, 1.0, count))
            turn = self._random.uniform(0.0, 2.0 * pi, count)
            freshness = self._random.uniform(0.15, 1.0, count) * min(1.0, (300.0 / diameter) ** 0.25)
            for d, phi, fresh in zip(distance.tolist(), turn.tolist(), freshness.tolist(), strict=True):
                if d > 0.8 * diameter + 4.0:  # nobody lands in one
                    self._dig(height, d * cos(phi), d * sin(phi), 0.5 * diameter, fresh)
        return height

    def _dig(self, height: np.ndarray, east: float, north: float, radius: float, fresh: float) -> None:
        """Add one crater to ``height`` (m): a bowl, its rim, and a blanket that thins out to 2.5 radii."""
        distance, reach = hypot(east, north), 2.5 * radius
        rows = slice(*self._radius.searchsorted((distance - reach, distance + reach)))
        rho = np.hypot(self._east[rows] - east, self._north[rows] - north) / radius
        bowl = 0.32 * (rho**2 - 1.0) + 0.07
        blanket = 0.07 * np.maximum((2.5 - rho) / 1.5, 0.0) ** 2 / np.maximum(rho, 1.0)
        height[rows] += fresh * radius * np.where(rho < 1.0, bowl, blanket)

    def _around(self, height: np.ndarray) -> np.ndarray:
        """Slope (m/m) of ``height`` along the rings, counterclockwise."""
        step = 2.0 * self._radius[:, None] * 2.0 * pi / SPOKES
        return (np.roll(height, -1, axis=1) - np.roll(height, 1, axis=1)) / step


def tints(relief: Sequence[Tint], height_km: np.ndarray) -> np.ndarray:
    """Return the colours of the globe at heights (km) above the areoid."""
    table = np.array(relief)
    return np.stack([np.interp(height_km, table[:, 0], table[:, k]) for k in (1, 2, 3)], axis=-1)


def soil(site: Site, tone: np.ndarray, rise_east: np.ndarray, rise_north: np.ndarray) -> np.ndarray:
    """Return colours of ground of a tone (0 dark, 1 light) with these slopes."""
    dark, light = np.array(site.appearance.ground_dark), np.array(site.appearance.ground_light)
    colours: np.ndarray = dark + (light - dark) * np.clip(tone, 0.0, 1.0)[..., None]
    return colours * sunlight(site.light, rise_east, rise_north)[..., None]


def sunlight(towards: np.ndarray, rise_east: np.ndarray, rise_north: np.ndarray) -> np.ndarray:
    """Return the brightness of ground with these slopes (m/m) in light from ``towards``; level: 1."""
    cosine = towards[2] - towards[0] * rise_east - towards[1] * rise_north
    cosine = cosine / np.sqrt(1.0 + rise_east**2 + rise_north**2)
    return np.clip(0.32 + 0.68 * cosine / towards[2], 0.25, 1.6)


def _waves(
    random: np.random.Generator, east: np.ndarray, north: np.ndarray, spacing: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Fractal tone about 0.5, and ripples (m), of waves that a mesh of the given spacing (m) can carry."""
    east, north, spacing = (values.astype(np.float32) for values in (east, north, spacing))
    tone, weight, height = np.zeros_like(east), np.full_like(east, 1e-9), np.zeros_like(east)
    for wavelength in np.geomspace(1.5, 4e5, 34).tolist():
        fits = np.clip(wavelength / (3.0 * spacing) - 1.0, 0.0, 1.0)
        fits = fits * np.clip(60.0 * spacing / wavelength, 0.0, 1.0)
        rows = np.flatnonzero(fits)  # the rings of the mesh that it fits
        for _ in range(3):
            heading, phase = random.uniform(0.0, 2.0 * pi, 2).tolist()
            along = (east[rows] * cos(heading) + north[rows] * sin(heading)) / wavelength
            across = (north[rows] * cos(heading) - east[rows] * sin(heading)) / wavelength
            wave = fits[rows] * np.sin(2.0 * pi * along + phase + 2.0 * np.sin(3.1 * across + phase))
            tone[rows] += wave
            weight[rows] += fits[rows] ** 2
            height[rows] += 0.004 * min(wavelength, 400.0) * wave
    return 0.5 + 0.17 * tone / np.sqrt(0.5 * weight), height


def sky(horizon: Vec3, zenith: Vec3) -> Mesh:
    """Return a dome of unit radius seen from inside, from the colour of the horizon to that overhead."""
    place = sphere(*_DOME)
    rise = np.clip(place[..., 2:], 0.0, 1.0) ** 0.55
    colours = np.array(horizon) + (np.array(zenith) - horizon) * rise
    return bright(place.reshape(-1, 3), grid_triangles(*_DOME)[:, ::-1], colours.reshape(-1, 3))


def grain() -> dict[str, np.ndarray]:
    """Return texture and coordinates of the vertices of :meth:`Landscape.mesh`: light and dark grain, which
    grows with the distance from the touchdown like the mesh: it is neither seen as texels nor finer than the
    pixels of a picture.
    """
    noise = np.fft.fft2(np.random.default_rng(0).normal(size=(_TILE, _TILE)))
    waves = np.hypot(*np.meshgrid(np.fft.fftfreq(_TILE), np.fft.fftfreq(_TILE)))
    soft = np.fft.ifft2(noise / (0.05 + waves)).real
    texture = np.clip(SHADE + _GRAIN * soft / soft.std(), 0.0, 255.0).astype(np.uint8)
    ring, spoke = np.indices((RINGS, SPOKES)).reshape(2, -1)
    around = np.abs(spoke - SPOKES // 2)  # mirrored, or there would be a seam
    places = np.append(np.column_stack([around, ring]), np.zeros((2, 2)), axis=0)
    return {
        "albedo_texture": np.repeat(texture[..., None], 3, axis=-1),
        "vertex_texcoords": places / _PER_TILE,
    }


def dither() -> dict[str, np.ndarray]:
    """Return texture and coordinates of the sky's vertices: noise of less than two steps of colour, with a
    texel for each pixel of a picture, without which the 256 steps of a colour would be seen as bands.
    """
    noise = np.random.default_rng(0).integers(252, 256, (_TILE, _TILE, 1), np.uint8).repeat(3, axis=-1)
    rows, columns = np.indices(_DOME).reshape(2, -1)
    degrees = np.column_stack([columns * 360.0 / _DOME[1], rows * 180.0 / (_DOME[0] - 1)])
    return {"albedo_texture": noise, "vertex_texcoords": degrees / (0.05 * _TILE)}
