"""Ground and sky of a film."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from edl6dof.replay.scene.landscape import SHADE, Landscape, grain
from edl6dof.replay.scene.mesh import Mesh, bright, grid_triangles, merge, rock, sphere
from edl6dof.replay.scene.poses import Motion, Site
from edl6dof.spatial import rotations as turns

#: Kinds of rock, and texels of a tile of noise.
_KINDS, _TILE = 4, 256
#: Distance (m) from the landing place up to which the ground is a mesh of its own.
_NEAR_M = 10e3
#: Spread (rad) of the halo around the sun, its share of white, and radius of the sun's disc (rad).
_HALO, _GLARE, _SUN = 0.16, 0.55, 0.006


class Noise(NamedTuple):
    """A tile of noise, shape (texels, texels, 3), and its coordinates at the vertices."""

    tile: np.ndarray
    coordinates: np.ndarray


def terrain(landscape: Landscape, motion: Motion) -> list[tuple[Mesh, Noise | None]]:
    """Return the ground with its grain, and for a site with a landing area its near part and its rocks."""
    texture = grain()
    noise = Noise(texture["albedo_texture"], texture["vertex_texcoords"].astype(np.float32))
    found: list[tuple[Mesh, Noise | None]] = _split(landscape.mesh(), noise, motion.last)
    if (near := landscape.near()) is not None:
        found.append((near._replace(colours=(near.colours * (SHADE / 255.0)).astype(np.uint8)), None))
        if (stones := _rocks(landscape, motion.site)) is not None:
            found.append((stones, None))
    return found


def _split(mesh: Mesh, noise: Noise, middle: np.ndarray) -> list[tuple[Mesh, Noise | None]]:
    """Near and far part of the ground: graphics keep single precision relative to the size of a mesh."""
    near = (np.linalg.norm(mesh.positions - middle, axis=-1) < _NEAR_M)[mesh.triangles].all(axis=-1)
    parts: list[tuple[Mesh, Noise | None]] = []
    for own in (near, ~near):
        used, numbers = np.unique(mesh.triangles[own], return_inverse=True)
        triangles = numbers.reshape(-1, 3)
        part = Mesh(mesh.positions[used], triangles, mesh.normals[used], mesh.colours[used])
        parts.append((part, Noise(noise.tile, noise.coordinates[used])))
    return parts


def _rocks(landscape: Landscape, site: Site) -> Mesh | None:
    places, sizes, headings = landscape.rocks()
    kinds = [rock(kind, site.appearance.rock, site.light) for kind in range(_KINDS)]
    upright = turns.about_z(headings)
    stones = []
    for k, (place, size, turn) in enumerate(zip(places, sizes, upright, strict=True)):
        kind = kinds[k % _KINDS]
        stones.append(kind._replace(positions=place + turns.rotate(turn, kind.positions * size)))
    return merge(stones) if stones else None


def dome(site: Site, shape: tuple[int, int]) -> tuple[Mesh, Noise]:
    """Return the sky as a dome of unit radius seen from inside, z up, and the noise that hides the steps of
    its colours.
    """
    look, place = site.appearance, sphere(*shape)
    horizon, zenith = np.array(look.sky_horizon), np.array(look.sky_zenith)
    rise = np.clip(place[..., 2:], 0.0, 1.0) ** 0.6
    colours = horizon + (zenith - horizon) * rise
    if site.sun is not None and site.sun[2] > 0.0:
        angle = np.arccos(np.clip(place @ site.sun, -1.0, 1.0))[..., None]
        colours += _GLARE * np.exp(-angle / _HALO) * (np.array([255.0, 246.0, 236.0]) - colours)
    mesh = bright(place.reshape(-1, 3), grid_triangles(*shape)[:, ::-1], colours.reshape(-1, 3))
    tile = np.random.default_rng(0).integers(252, 256, (_TILE, _TILE, 1), np.uint8).repeat(3, axis=-1)
    rows, columns = np.indices(shape).reshape(2, -1)
    degrees = np.column_stack([columns * 360.0 / shape[1], rows * 180.0 / (shape[0] - 1)])
    return mesh, Noise(tile, (degrees / (0.03 * _TILE)).astype(np.float32))
