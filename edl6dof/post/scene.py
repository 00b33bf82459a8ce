"""Meshes of the replay, drawn from the vehicle's parameters: aeroshell, lander, canopy, plume, ground.

All vehicle shapes are in ``B``: x forward through the nose (down when landed), y right, z down, origin at the nose apex.
The dimensions that the vehicle file gives are kept; everything else (deck, rover, tanks) is decoration.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from math import cos, pi, radians, sin, tan
from typing import NamedTuple

import numpy as np

from edl6dof.vehicle.vehicle import VehicleParams

RGB = tuple[int, int, int]

SHIELD: RGB = (255, 214, 176)
GOLD: RGB = (222, 164, 66)
WHITE: RGB = (236, 234, 228)
SILVER: RGB = (176, 180, 188)
DARK: RGB = (58, 60, 68)
PANEL: RGB = (38, 52, 110)
ORANGE: RGB = (226, 92, 40)


class Mesh(NamedTuple):
    """A triangle mesh; arrays of one row per vertex, and the triangles' vertex numbers."""

    positions: np.ndarray
    triangles: np.ndarray
    normals: np.ndarray
    colours: np.ndarray


def merge(meshes: Iterable[Mesh]) -> Mesh:
    """One mesh of several."""
    parts = list(meshes)
    starts = np.cumsum([0] + [len(part.positions) for part in parts[:-1]])
    triangles = np.concatenate([part.triangles + start for part, start in zip(parts, starts, strict=True)])
    return Mesh(*(np.concatenate([part[i] for part in parts]) if i != 1 else triangles for i in range(4)))


def _quads(points: np.ndarray, normals: np.ndarray, colours: np.ndarray) -> Mesh:
    """Mesh of separate quadrilaterals: corners (n, 4, 3), corner normals (n, 4, 3), face colours (n, 3)."""
    n = len(points)
    triangles = (np.array([[0, 1, 2], [0, 2, 3]]) + 4 * np.arange(n)[:, None, None]).reshape(-1, 3)
    lengths = np.linalg.norm(normals, axis=-1, keepdims=True)
    normals = normals / np.where(lengths > 0.0, lengths, 1.0)
    return Mesh(points.reshape(-1, 3), triangles, normals.reshape(-1, 3), np.repeat(colours, 4, axis=0).astype(np.uint8))


def revolve(
    profile: Sequence[tuple[float, float]],
    colour: RGB | Callable[[int, int], RGB],
    segments: int = 48,
    axis: tuple[np.ndarray, np.ndarray] | None = None,
) -> Mesh:
    """Surface of revolution of a smooth (x, r) profile about x, or about ``axis`` (origin, unit direction).

    ``colour`` is one colour, or a function of segment around and step along the profile.
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
        return np.stack([grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]], axis=2).reshape(-1, 4, 3)

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


def rod(start: Sequence[float], end: Sequence[float], radius: float, colour: RGB, end_radius: float | None = None) -> Mesh:
    """Round rod or cone frustum between two points."""
    a, b = np.asarray(start, dtype=float), np.asarray(end, dtype=float)
    length = float(np.linalg.norm(b - a))
    tip = radius if end_radius is None else end_radius
    return revolve([(0.0, radius), (length, tip)], colour, 12, (a, (b - a) / length))


def box(centre: Sequence[float], size: Sequence[float], colour: RGB) -> Mesh:
    """Axis-parallel box."""
    faces, normals = [], []
    for axis in range(3):
        for sign in (-1.0, 1.0):
            normal, u, v = np.zeros(3), np.zeros(3), np.zeros(3)
            normal[axis], u[(axis + 1) % 3], v[(axis + 2) % 3] = sign, 1.0, 1.0
            corners = np.array([normal - u - v, normal + u - v, normal + u + v, normal - u + v])
            faces.append(corners * np.asarray(size) / 2.0 + np.asarray(centre))
            normals.append(np.tile(normal, (4, 1)))
    return _quads(np.array(faces), np.array(normals), np.tile(colour, (6, 1)))


def _striped(base: RGB, every: int, factor: float) -> Callable[[int, int], RGB]:
    darker = tuple(int(c * factor) for c in base)
    return lambda i, j: darker if i % every == 0 else base


def heat_shield(vehicle: VehicleParams) -> Mesh:
    """Sphere-cone forebody with its shoulder, closed behind; drawn light, tinted by its temperature later."""
    shape = vehicle.aero.capsule
    radius, nose, edge = shape.diameter_m / 2.0, shape.nose_radius_m, shape.shoulder_radius_m
    cone = radians(90.0 - shape.cone_half_angle_deg)  # angle at which sphere and shoulder meet the cone, from the axis
    x0 = -nose * (1.0 - cos(cone))
    r0 = nose * sin(cone)
    r1 = radius - edge * (1.0 - sin(cone))
    x1 = x0 - (r1 - r0) * tan(cone)
    x_edge = x1 - edge * cos(cone)
    front = [(-nose * (1.0 - cos(a)), max(nose * sin(a), 1e-4)) for a in np.linspace(0.0, cone, 7)]
    front += [(x0 + (x1 - x0) * k, r0 + (r1 - r0) * k) for k in (0.34, 0.67)]
    shoulder = [(x_edge + edge * cos(a), radius - edge + edge * sin(a)) for a in np.linspace(cone, pi / 2.0, 6)]
    inside = [(x_edge, radius), (x_edge + 0.02, radius - 0.05), (x0 - 0.06, r0), (-0.06, 1e-4)]
    return merge([revolve(front + shoulder, _striped(SHIELD, 8, 0.86), 64), revolve(inside, DARK, 64)])


def shoulder_x(vehicle: VehicleParams) -> float:
    """Station of the largest diameter, m in B."""
    shape = vehicle.aero.capsule
    radius, nose, edge = shape.diameter_m / 2.0, shape.nose_radius_m, shape.shoulder_radius_m
    cone = radians(90.0 - shape.cone_half_angle_deg)
    flank = radius - edge * (1.0 - sin(cone)) - nose * sin(cone)
    return -nose * (1.0 - cos(cone)) - flank * tan(cone) - edge * cos(cone)


def backshell_profile(vehicle: VehicleParams) -> list[tuple[float, float]]:
    """The corners (x, r) of the two backshell cones, from the shoulder to the lid."""
    shape = vehicle.aero.capsule
    x0, r0 = shoulder_x(vehicle), shape.diameter_m / 2.0
    r1, r2 = min(shape.backshell_break_radius_m, r0), shape.backshell_base_radius_m
    x1 = x0 - (r0 - r1) / tan(radians(shape.backshell_cone_angle_deg))
    x2 = x1 - max(r1 - r2, 0.0) / tan(radians(shape.backshell_second_cone_angle_deg))
    return [(x0, r0), (x1, r1), (x2, min(r2, r1))]


def backshell(vehicle: VehicleParams) -> Mesh:
    """Two cones with panel stripes, a rim and the parachute lid; open in front."""
    corners = backshell_profile(vehicle)
    (x0, r0), (x2, r2) = corners[0], corners[-1]
    panels = [revolve([a, b], _striped(WHITE, 8, 0.72), 64) for a, b in zip(corners, corners[1:], strict=False)]
    rim = revolve([(x0 + 0.01, r0 + 0.008), (x0 - 0.07, r0 + 0.008)], DARK, 64)
    end = (x2 - 0.03, r2 * 0.96)
    lid = [revolve([(x2, r2), end], DARK, 48), revolve([end, (x2 - 0.03, 1e-4)], ORANGE, 48)]
    return merge([*panels, rim, *lid])


def lander(vehicle: VehicleParams) -> Mesh:
    """Descent stage: octagonal foil body, deck with rover, tanks, engine bell and a nozzle at every thruster."""
    nozzle_x = vehicle.engine.nozzle_m[0] if vehicle.engine.full_thrust_n > 0.0 else -0.3
    bottom, top, r = nozzle_x - 0.30, nozzle_x - 0.95, 0.62 * vehicle.aero.capsule.diameter_m / 2.0
    parts = [
        revolve([(bottom, r), (top, r)], _striped(GOLD, 2, 0.86), 8),
        revolve([(bottom, r), (bottom, 1e-4)], DARK, 8),
        revolve([(top, r * 1.04), (top, 1e-4)], SILVER, 8),
        revolve([(bottom, 0.10), (nozzle_x - 0.10, 0.17), (nozzle_x, 0.25)], DARK, 32),
        box((top - 0.30, 0.0, 0.0), (0.22, 0.85, 1.25), WHITE),
        box((top - 0.44, 0.0, 0.0), (0.04, 1.15, 1.45), PANEL),
        rod((top - 0.44, 0.30, -0.45), (top - 0.85, 0.30, -0.45), 0.03, SILVER),
        box((top - 0.88, 0.30, -0.45), (0.08, 0.22, 0.10), WHITE),
    ]
    for side in (-1.0, 1.0):
        parts += [rod((top - 0.10, side * 0.42, z), (top - 0.10, side * 0.58, z), 0.15, DARK) for z in (-0.5, 0.0, 0.5)]
        parts.append(box((top - 0.02, side * 0.45, 0.0), (0.03, 0.22, 1.9), SILVER))
    for jet in vehicle.rcs.thrusters:
        place, back = np.array(jet.position_m), -np.array(jet.direction)
        length = 0.16 if jet.thrust_n > 100.0 else 0.09
        parts.append(rod(place - length * back, place, 0.2 * length, DARK, 0.5 * length))
        mount = np.array([np.clip(place[0], top - 0.25, bottom), 0.75 * place[1], 0.75 * place[2]])
        mount[1:] *= min(1.0, 0.8 * r / max(np.hypot(*mount[1:]), 1e-6))
        parts.append(rod(mount, place - length * back, 0.018, SILVER))
    return merge(parts)


def legs(vehicle: VehicleParams) -> Mesh | None:
    """Landing legs with their pads, standing on the footpad points; ``None`` without legs."""
    parts = []
    reach = 0.60 * vehicle.aero.capsule.diameter_m / 2.0
    for x, y, z in vehicle.landing_gear.footpads_m:
        out = np.array([0.0, y, z]) / max(np.hypot(y, z), 1e-6)
        side = np.cross(out, [1.0, 0.0, 0.0])
        pad = np.array([x, y, z])
        ankle = pad - np.array([0.10, 0.0, 0.0])
        parts.append(rod(ankle, reach * out - [1.05, 0.0, 0.0], 0.05, SILVER))
        parts += [rod(ankle, 0.9 * reach * out + k * 0.30 * side - [0.62, 0.0, 0.0], 0.03, SILVER) for k in (-1.0, 1.0)]
        parts.append(rod(pad - [0.11, 0.0, 0.0], pad, 0.12, GOLD, 0.22))
        parts.append(revolve([(x, 0.22), (x, 1e-4)], GOLD, 24, (np.array([0.0, y, z]), np.array([1.0, 0.0, 0.0]))))
    return merge(parts) if parts else None


def canopy(vehicle: VehicleParams) -> tuple[Mesh, np.ndarray]:
    """Disk-gap-band canopy and its lines; x from the bridle confluence to the canopy, skirt at the line length.

    Returns:
        mesh, and the lines as segments (n, 2, 3).
    """
    diameter, length = vehicle.parachute.diameter_m, vehicle.parachute.line_length_m
    r, band, gap, height = 0.34 * diameter, 0.12 * diameter, 0.035 * diameter, 0.20 * diameter
    gores, vent = 24, 0.06

    def paint(i: int, j: int) -> RGB:
        return ORANGE if i // 2 % 2 == 0 else WHITE

    skirt = length
    dome = [(skirt + band + gap + height * cos(a), r * sin(a)) for a in np.linspace(vent, pi / 2.0, 10)]
    mesh = merge(
        [
            revolve([(skirt, 0.97 * r), (skirt + band, r)], lambda i, j: ORANGE if i // 6 % 2 == 0 else WHITE, 2 * gores),
            revolve(dome, paint, 2 * gores),
        ]
    )
    turn = np.linspace(0.0, 2.0 * pi, gores, endpoint=False)
    rim = np.stack([np.full(gores, skirt), 0.97 * r * np.cos(turn), 0.97 * r * np.sin(turn)], axis=-1)
    riser = np.array([0.13 * length, 0.0, 0.0])
    top = rim + [band + gap, 0.0, 0.0]
    lines = [np.stack([np.broadcast_to(riser, rim.shape), rim], axis=1), np.stack([rim + [band, 0.0, 0.0], top], axis=1)]
    return mesh, np.concatenate([np.array([[[0.0, 0.0, 0.0], riser]]), *lines])


def plume(core: bool) -> Mesh:
    """Flame of unit length along x, bright whatever the light: the white core, or the orange mantle around it."""
    reach, girth = (0.55, 0.5) if core else (1.0, 1.0)
    stations = np.linspace(0.0, 1.0, 13)
    width = girth * (0.05 + 0.58 * np.sqrt(stations)) * (1.0 - stations) ** 0.9
    mesh = revolve([(reach * float(s), max(float(w), 1e-4)) for s, w in zip(stations, width, strict=True)], WHITE, 20)
    hot, cold = np.array([[255, 252, 235], [255, 214, 130]] if core else [[255, 186, 84], [255, 92, 24]])
    colours = hot + (cold - hot) * (mesh.positions[:, :1] / reach)
    return mesh._replace(colours=colours.astype(np.uint8), normals=np.zeros_like(mesh.normals))


def ground(centre: np.ndarray, height: Callable[[np.ndarray, np.ndarray], np.ndarray], reach: float) -> Mesh:
    """Ground around ``centre`` (east, north): rings that widen geometrically, so that it is fine where one lands.

    The mottling is decoration and keeps to the colours: the surface itself is ``height`` (east, north) and nothing else.
    """
    rings, spokes = 130, 120
    radius = np.geomspace(1.0, reach, rings)
    turn = np.linspace(0.0, 2.0 * pi, spokes, endpoint=False)
    east = centre[0] + radius[:, None] * np.cos(turn)
    north = centre[1] + radius[:, None] * np.sin(turn)
    shade = _mottle(east - centre[0], north - centre[1], radius[:, None] * 2.0 * pi / spokes)
    east, north = np.append(east.ravel(), centre[0]), np.append(north.ravel(), centre[1])
    shade = np.append(shade.ravel(), shade[0].mean())
    positions = np.stack([east, north, height(east, north)], axis=-1)
    dark, light = np.array([112, 62, 38]), np.array([214, 146, 98])
    colours = (dark + (light - dark) * np.clip(shade, 0.0, 1.0)[:, None]).astype(np.uint8)
    i, j = np.meshgrid(np.arange(rings - 1), np.arange(spokes), indexing="ij")
    a, b = i * spokes + j, i * spokes + (j + 1) % spokes
    quads = np.stack([a, a + spokes, b + spokes, a, b + spokes, b], axis=-1).reshape(-1, 3)
    j = np.arange(spokes)
    fan = np.stack([np.full(spokes, rings * spokes), j, (j + 1) % spokes], axis=-1)
    return Mesh(positions, np.concatenate([quads, fan]), np.tile([0.0, 0.0, 1.0], (len(positions), 1)), colours)


def _mottle(east: np.ndarray, north: np.ndarray, resolution: np.ndarray) -> np.ndarray:
    """Fractal pattern about 0.5, of waves that the mesh of the given resolution (m) can still carry."""
    random = np.random.default_rng(7)
    pattern, weight = np.zeros_like(east), np.full_like(east, 1e-9)
    for wavelength in np.geomspace(1.5, 4e5, 34):
        fits = np.clip(wavelength / (3.0 * resolution) - 1.0, 0.0, 1.0) * np.clip(60.0 * resolution / wavelength, 0.0, 1.0)
        for _ in range(3):
            heading, phase = random.uniform(0.0, 2.0 * pi, 2)
            along = (east * cos(heading) + north * sin(heading)) / wavelength
            across = (north * cos(heading) - east * sin(heading)) / wavelength
            pattern += fits * np.sin(2.0 * pi * along + phase + 2.0 * np.sin(3.1 * across + phase))
            weight += fits**2
    return 0.5 + 0.20 * pattern / np.sqrt(0.5 * weight)
