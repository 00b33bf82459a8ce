"""Triangle meshes from simple shapes: surfaces of revolution, rods, boxes, a flame, a sphere, a rock."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from math import pi
from typing import NamedTuple

import numpy as np

from edl6dof.config.base import Vec3

RGB = tuple[int, int, int]
#: A point, m, shape (3,).
Place = Sequence[float] | np.ndarray

WHITE: RGB = (236, 234, 228)


class Mesh(NamedTuple):
    """A triangle mesh; arrays of one row per vertex, and the triangles' vertex numbers."""

    positions: np.ndarray
    triangles: np.ndarray
    normals: np.ndarray
    colours: np.ndarray


def merge(meshes: Iterable[Mesh]) -> Mesh:
    """Join several meshes into one."""
    parts = list(meshes)
    starts = np.cumsum([0] + [len(part.positions) for part in parts[:-1]])
    triangles = np.concatenate([part.triangles + start for part, start in zip(parts, starts, strict=True)])
    return Mesh(*(np.concatenate([part[i] for part in parts]) if i != 1 else triangles for i in range(4)))


def _quads(points: np.ndarray, normals: np.ndarray, colours: np.ndarray) -> Mesh:
    """Mesh of separate quadrilaterals: corners (n, 4, 3), corner normals (n, 4, 3), face colours (n, 3)."""
    n = len(points)
    triangles = (np.array([[0, 1, 2], [0, 2, 3]]) + 4 * np.arange(n)[:, None, None]).reshape(-1, 3)
    lengths = np.linalg.norm(normals, axis=-1, keepdims=True)
    normals = (normals / np.where(lengths > 0.0, lengths, 1.0)).reshape(-1, 3)
    return Mesh(points.reshape(-1, 3), triangles, normals, np.repeat(colours, 4, axis=0).astype(np.uint8))


def revolve(
    profile: Sequence[tuple[float, float]],
    colour: RGB | Callable[[int, int], RGB],
    segments: int = 48,
    axis: tuple[np.ndarray, np.ndarray] | None = None,
) -> Mesh:
    """Return the surface of revolution of a smooth (x, r) profile.

    Args:
        profile: stations and radii, m.
        colour: one colour, or a function of the segment around and the step along the profile.
        segments: number of segments around the axis.
        axis: origin and unit direction, by default x.
    """
    x, r = np.asarray(profile, dtype=float).T
    slope = np.stack([np.gradient(r), -np.gradient(x)], axis=-1)  # outward normal (nx, nr), up to sign
    slope *= -1.0 if np.mean(slope[:, 1]) < 0.0 else 1.0
    turn = np.linspace(0.0, 2.0 * pi, segments + 1)
    around = np.stack([np.zeros_like(turn), np.cos(turn), np.sin(turn)], axis=-1)
    ahead = np.array([1.0, 0.0, 0.0])
    points = x[None, :, None] * ahead + r[None, :, None] * around[:, None, :]
    normals = slope[None, :, :1] * ahead + slope[None, :, 1:] * around[:, None, :]

    def corners(grid: np.ndarray) -> np.ndarray:
        every = np.stack([grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]], axis=2)
        return every.reshape(-1, 4, 3)

    steps = len(x) - 1
    paint = colour if callable(colour) else lambda _i, _j: colour
    colours = np.array([paint(i, j) for i in range(segments) for j in range(steps)])
    mesh = _quads(corners(points), corners(normals), colours)
    if axis is None:
        return mesh
    origin, direction = axis
    side = np.cross(direction, [0.0, 0.0, 1.0] if abs(direction[2]) < 0.9 else [0.0, 1.0, 0.0])
    side /= np.linalg.norm(side)
    turned = np.stack([direction, side, np.cross(direction, side)])
    return mesh._replace(positions=origin + mesh.positions @ turned, normals=mesh.normals @ turned)


def rod(start: Place, end: Place, radius: float, colour: RGB, end_radius: float | None = None) -> Mesh:
    """Return a round rod or cone frustum between two points."""
    a, b = np.asarray(start, dtype=float), np.asarray(end, dtype=float)
    length = float(np.linalg.norm(b - a))
    tip = radius if end_radius is None else end_radius
    return revolve([(0.0, radius), (length, tip)], colour, 12, (a, (b - a) / length))


def box(centre: Place, size: Place, colour: RGB) -> Mesh:
    """Return an axis-parallel box."""
    faces, normals = [], []
    for axis in range(3):
        for sign in (-1.0, 1.0):
            normal, u, v = np.zeros(3), np.zeros(3), np.zeros(3)
            normal[axis], u[(axis + 1) % 3], v[(axis + 2) % 3] = sign, 1.0, 1.0
            corners = np.array([normal - u - v, normal + u - v, normal + u + v, normal - u + v])
            faces.append(corners * np.asarray(size) / 2.0 + np.asarray(centre))
            normals.append(np.tile(normal, (4, 1)))
    return _quads(np.array(faces), np.array(normals), np.tile(colour, (6, 1)))


def plume(core: bool) -> Mesh:
    """Return a flame of unit length along x in full light: the white core, or the orange mantle."""
    reach, girth = (0.55, 0.5) if core else (1.0, 1.0)
    stations = np.linspace(0.0, 1.0, 13)
    width = girth * (0.05 + 0.58 * np.sqrt(stations)) * (1.0 - stations) ** 0.9
    profile = [(reach * float(s), max(float(w), 1e-4)) for s, w in zip(stations, width, strict=True)]
    mesh = revolve(profile, WHITE, 20)
    hot, cold = np.array([[255, 252, 235], [255, 214, 130]] if core else [[255, 186, 84], [255, 92, 24]])
    colours = hot + (cold - hot) * (mesh.positions[:, :1] / reach)
    return mesh._replace(colours=colours.astype(np.uint8), normals=np.zeros_like(mesh.normals))


def grid_triangles(rows: int, columns: int) -> np.ndarray:
    """Return the triangles between ``rows`` x ``columns`` vertices, the last column joined to the first."""
    i, j = np.meshgrid(np.arange(rows - 1), np.arange(columns), indexing="ij")
    a, b = i * columns + j, i * columns + (j + 1) % columns
    return np.stack([a, a + columns, b + columns, a, b + columns, b], axis=-1).reshape(-1, 3)


def pole_triangles(rows: int, columns: int) -> list[np.ndarray]:
    """Return two fans of triangles: from poles, numbered after the grid's vertices, to its end rows."""
    here, ahead = np.arange(columns), (np.arange(columns) + 1) % columns
    ends = ((rows * columns, 0), (rows * columns + 1, (rows - 1) * columns))
    return [np.stack([np.full(columns, pole), first + here, first + ahead], axis=-1) for pole, first in ends]


def open_grid_triangles(rows: int, columns: int) -> np.ndarray:
    """Return the triangles between ``rows`` x ``columns`` vertices of a sheet."""
    i, j = np.meshgrid(np.arange(rows - 1), np.arange(columns - 1), indexing="ij")
    a = i * columns + j
    return np.stack([a, a + 1, a + columns + 1, a, a + columns + 1, a + columns], axis=-1).reshape(-1, 3)


def sphere(rows: int, columns: int, gap: float = 0.0) -> np.ndarray:
    """Return points of a unit sphere, shape (rows, columns, 3), without ``gap`` (rad) around its poles."""
    polar = np.linspace(gap, pi - gap, rows)[:, None]
    around = np.linspace(0.0, 2.0 * pi, columns, endpoint=False)
    flat = np.sin(polar)
    return np.stack([flat * np.cos(around), flat * np.sin(around), np.cos(polar) + 0.0 * around], axis=-1)


def bright(positions: np.ndarray, triangles: np.ndarray, colours: np.ndarray) -> Mesh:
    """Return a mesh that shows its colours in any light: its normals are zero."""
    return Mesh(positions, triangles, np.zeros_like(positions), np.clip(colours, 0, 255).astype(np.uint8))


def disc(centre: Place, normal: np.ndarray, radius: float, colour: RGB) -> Mesh:
    """Return a round plate that shows its colour in any light."""
    plate = revolve([(0.0, radius), (0.0, 1e-4 * radius)], colour, 32, (np.asarray(centre, float), normal))
    return plate._replace(normals=np.zeros_like(plate.normals))


def rock(seed: int, colour: Vec3, towards: np.ndarray) -> Mesh:
    """Return a boulder of unit size: a dented sphere, in light from ``towards``."""
    random = np.random.default_rng(seed)
    rows, columns = 7, 9
    radius = 0.5 * random.uniform(0.72, 1.0, (rows, columns))
    radius[[0, -1]] = 0.4
    place = sphere(rows, columns, 0.02) * [1.0, 1.0, 0.7]
    light = np.clip(0.55 + 0.45 * (place @ towards), 0.2, 1.1)
    colours = np.array(colour) * light[..., None] * random.uniform(0.9, 1.05, (rows, columns, 1))
    place = (radius[..., None] * place).reshape(-1, 3)
    return bright(place, grid_triangles(rows, columns), colours.reshape(-1, 3))
