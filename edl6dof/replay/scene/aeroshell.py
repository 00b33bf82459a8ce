"""Shapes of what the air sees: heat shield and backshell, a sphere, a box, the trim wing, a parachute.

All are in ``B``: x forward through the nose, y right, z down.  The dimensions that the vehicle file gives are
kept; stripes and rims are decoration.
"""

from __future__ import annotations

from collections.abc import Callable
from math import cos, pi, sin, sqrt

import numpy as np

from edl6dof.replay.scene.mesh import DARK, ORANGE, RGB, SILVER, WHITE, Mesh, box, merge, revolve, rod
from edl6dof.replay.scene.outline import Outline
from edl6dof.vehicle.vehicle import VehicleParams

SHIELD: RGB = (255, 214, 176)


def striped(base: RGB, every: int, factor: float) -> Callable[[int, int], RGB]:
    """Paint with a darker stripe at each ``every``-th segment around."""
    red, green, blue = (int(c * factor) for c in base)
    darker = red, green, blue
    return lambda i, j: darker if i % every == 0 else base


def heat_shield(shape: Outline) -> Mesh:
    """Sphere-cone forebody with its shoulder, closed behind; drawn light, tinted by its temperature later."""
    nose, edge = shape.forebody[0], shape.forebody[-1]
    thick = 0.018 * edge[1]
    knee = shape.forebody[6]
    inside = [
        edge,
        (edge[0] + 0.6 * thick, edge[1] - 1.6 * thick),
        (knee[0] - 2.0 * thick, knee[1]),
        (nose[0] - 2.0 * thick, 1e-4),
    ]
    return merge([revolve(shape.forebody, striped(SHIELD, 8, 0.86), 64), revolve(inside, DARK, 64)])


def backshell(shape: Outline) -> Mesh:
    """Cones with panel stripes, a rim and the lid; open in front."""
    corners = shape.afterbody
    (x0, r0), (x2, r2) = corners[0], corners[-1]
    panels = [
        revolve([a, b], striped(WHITE, 8, 0.72), 64) for a, b in zip(corners, corners[1:], strict=False)
    ]
    rim = revolve([(x0 + 0.006 * r0, 1.005 * r0), (x0 - 0.04 * r0, 1.005 * r0)], DARK, 64)
    end = (x2 - 0.018 * r0, r2 * 0.96)
    lid = [revolve([(x2, r2), end], DARK, 48), revolve([end, (end[0], 1e-4)], ORANGE, 48)]
    return merge([*panels, rim, *lid])


def body(shape: Outline) -> Mesh:
    """A sphere or a box, painted so that the eye sees it turn."""
    if shape.body == "box":
        stripe = shape.sides * [0.12, 1.01, 1.01]
        ahead = shape.centre + [0.38 * shape.sides[0], 0.0, 0.0]
        return merge([box(shape.centre, shape.sides, WHITE), box(ahead, stripe, ORANGE)])
    turn = np.linspace(0.0, pi, 25)
    ball = [(shape.radius * np.cos(a), max(shape.radius * np.sin(a), 1e-4)) for a in turn]
    mesh = revolve(ball, lambda i, j: ORANGE if (i // 6 + j // 6) % 2 == 0 else WHITE, 48)
    return mesh._replace(positions=mesh.positions + shape.centre)


def trim_wing(vehicle: VehicleParams, shape: Outline) -> Mesh:
    """The first surface about its hinge: x along its span, z the normal that faces the flow when open."""
    surface = vehicle.surfaces[0]
    side = sqrt(surface.area_m2)
    span = abs(surface.position_z_m) - wing_hinge(vehicle, shape)[1]
    plate = box((span, 0.0, 0.03), (side, side, 0.035), ORANGE)
    arms = [
        rod((0.0, k * 0.35 * side, 0.0), (span - 0.5 * side, k * 0.35 * side, 0.03), 0.022, SILVER)
        for k in (-1.0, 1.0)
    ]
    edge = rod((span + 0.5 * side, -0.5 * side, 0.03), (span + 0.5 * side, 0.5 * side, 0.03), 0.028, WHITE)
    return merge([plate, edge, *arms])


def wing_hinge(vehicle: VehicleParams, shape: Outline) -> tuple[np.ndarray, float]:
    """Hinge of the first surface on the aeroshell (m in B), and its distance from the axis (m)."""
    x, out = vehicle.surfaces[0].position_x_m, np.sign(vehicle.surfaces[0].position_z_m)
    radius = float(shape.radius_at(np.array(x))) if shape.afterbody else shape.radius
    return np.array([x, 0.0, radius * out]), radius


def wing_axes(vehicle: VehicleParams, shape: Outline, opening: np.ndarray) -> np.ndarray:
    """Axes of the wing's mesh in B as columns, shape (..., 3, 3): along the backshell when closed, square to
    the axis when open.
    """
    flank = shape.flank_angle if shape.afterbody else 0.0
    swing = (1.0 - opening) * (0.5 * pi + flank)
    ahead = np.array([1.0, 0.0, 0.0])
    out = np.array([0.0, 0.0, np.sign(vehicle.surfaces[0].position_z_m)])
    c, s = np.cos(swing)[..., None], np.sin(swing)[..., None]
    span, normal = c * out - s * ahead, c * ahead + s * out
    return np.stack([span, np.cross(normal, span), normal], axis=-1)


def canopy(vehicle: VehicleParams, number: int) -> tuple[Mesh, np.ndarray]:
    """Disk-gap-band canopy of a parachute of the vehicle, and its lines; x from the bridle confluence to the
    canopy, skirt at the line length.

    Returns:
        mesh, and the lines as segments (n, 2, 3).
    """
    diameter, length = vehicle.parachutes[number].diameter_m, vehicle.parachutes[number].line_length_m
    r, band, gap, height = 0.34 * diameter, 0.12 * diameter, 0.035 * diameter, 0.20 * diameter
    gores, vent = 24, 0.06

    def paint(i: int, j: int) -> RGB:
        return ORANGE if i // 2 % 2 == 0 else WHITE

    skirt = length
    dome = [(skirt + band + gap + height * cos(a), r * sin(a)) for a in np.linspace(vent, pi / 2.0, 10)]
    mesh = merge(
        [
            revolve(
                [(skirt, 0.97 * r), (skirt + band, r)],
                lambda i, j: ORANGE if i // 6 % 2 == 0 else WHITE,
                2 * gores,
            ),
            revolve(dome, paint, 2 * gores),
        ]
    )
    turn = np.linspace(0.0, 2.0 * pi, gores, endpoint=False)
    rim = np.stack([np.full(gores, skirt), 0.97 * r * np.cos(turn), 0.97 * r * np.sin(turn)], axis=-1)
    riser = np.array([0.13 * length, 0.0, 0.0])
    top = rim + [band + gap, 0.0, 0.0]
    lines = [
        np.stack([np.broadcast_to(riser, rim.shape), rim], axis=1),
        np.stack([rim + [band, 0.0, 0.0], top], axis=1),
    ]
    return mesh, np.concatenate([np.array([[[0.0, 0.0, 0.0], riser]]), *lines])
