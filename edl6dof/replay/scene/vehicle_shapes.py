"""Shapes of the vehicle, drawn from its parameters: aeroshell, lander, legs, trim wing, canopy.

All are in ``B``: x forward through the nose (down when landed), y right, z down, origin at the nose apex.
The dimensions that the vehicle file gives are kept; everything else (deck, rover, tanks) is decoration.
"""

from __future__ import annotations

from collections.abc import Callable
from math import cos, pi, radians, sin, sqrt, tan
from typing import Any

import numpy as np

from edl6dof.replay.scene.mesh import RGB, WHITE, Mesh, box, merge, revolve, rod
from edl6dof.vehicle.vehicle import VehicleParams

SHIELD: RGB = (255, 214, 176)
GOLD: RGB = (222, 164, 66)
SILVER: RGB = (176, 180, 188)
DARK: RGB = (58, 60, 68)
PANEL: RGB = (38, 52, 110)
ORANGE: RGB = (226, 92, 40)


def _striped(base: RGB, every: int, factor: float) -> Callable[[int, int], RGB]:
    red, green, blue = (int(c * factor) for c in base)
    darker = red, green, blue
    return lambda i, j: darker if i % every == 0 else base


def heat_shield(vehicle: VehicleParams) -> Mesh:
    """Sphere-cone forebody with its shoulder, closed behind; drawn light, tinted by its temperature later."""
    shape = vehicle.aero.capsule
    radius, nose, edge = shape.diameter_m / 2.0, shape.nose_radius_m, shape.shoulder_radius_m
    # angle at which sphere and shoulder meet the cone, from the axis
    cone = radians(90.0 - shape.cone_half_angle_deg)
    x0 = -nose * (1.0 - cos(cone))
    r0 = nose * sin(cone)
    r1 = radius - edge * (1.0 - sin(cone))
    x1 = x0 - (r1 - r0) * tan(cone)
    x_edge = x1 - edge * cos(cone)
    front = [(-nose * (1.0 - cos(a)), max(nose * sin(a), 1e-4)) for a in np.linspace(0.0, cone, 7)]
    front += [(x0 + (x1 - x0) * k, r0 + (r1 - r0) * k) for k in (0.34, 0.67)]
    shoulder = [
        (x_edge + edge * cos(a), radius - edge + edge * sin(a)) for a in np.linspace(cone, pi / 2.0, 6)
    ]
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
    panels = [
        revolve([a, b], _striped(WHITE, 8, 0.72), 64) for a, b in zip(corners, corners[1:], strict=False)
    ]
    rim = revolve([(x0 + 0.01, r0 + 0.008), (x0 - 0.07, r0 + 0.008)], DARK, 64)
    end = (x2 - 0.03, r2 * 0.96)
    lid = [revolve([(x2, r2), end], DARK, 48), revolve([end, (x2 - 0.03, 1e-4)], ORANGE, 48)]
    return merge([*panels, rim, *lid])


def lander(vehicle: VehicleParams) -> Mesh:
    """Descent stage: octagonal foil body, deck with rover, tanks, engine bell and a nozzle at every
    thruster.
    """
    nozzle_x = vehicle.engines[0].nozzle_m[0] if vehicle.engines else -0.3
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
        parts += [
            rod((top - 0.10, side * 0.42, z), (top - 0.10, side * 0.58, z), 0.15, DARK)
            for z in (-0.5, 0.0, 0.5)
        ]
        parts.append(box((top - 0.02, side * 0.45, 0.0), (0.03, 0.22, 1.9), SILVER))
    for jet in vehicle.rcs.thrusters:
        parts.append(nozzle(jet, DARK))
        place, back = np.array(jet.position_m), -np.array(jet.direction)
        mount = np.array([np.clip(place[0], top - 0.25, bottom), 0.75 * place[1], 0.75 * place[2]])
        mount[1:] *= min(1.0, 0.8 * r / max(np.hypot(*mount[1:]), 1e-6))
        parts.append(rod(mount, place - 0.1 * back, 0.018, SILVER))
    return merge(parts)


def nozzle(jet: Any, colour: RGB, size: float = 1.0) -> Mesh:
    """The nozzle of one thruster of the vehicle file; its flame leaves against the thrust direction."""
    place, back = np.array(jet.position_m), -np.array(jet.direction)
    length = size * (0.16 if jet.thrust_n > 100.0 else 0.09)
    return rod(place - length * back, place + 0.02 * (size - 1.0) * back, 0.2 * length, colour, 0.5 * length)


def trim_wing(vehicle: VehicleParams) -> Mesh:
    """The trim wing about its hinge: x along its span, z the normal that faces the flow when it is open."""
    side = sqrt(vehicle.surfaces[0].area_m2)
    span = abs(vehicle.surfaces[0].position_z_m) - wing_hinge(vehicle)[1]
    plate = box((span, 0.0, 0.03), (side, side, 0.035), ORANGE)
    arms = [
        rod((0.0, k * 0.35 * side, 0.0), (span - 0.5 * side, k * 0.35 * side, 0.03), 0.022, SILVER)
        for k in (-1.0, 1.0)
    ]
    edge = rod((span + 0.5 * side, -0.5 * side, 0.03), (span + 0.5 * side, 0.5 * side, 0.03), 0.028, WHITE)
    return merge([plate, edge, *arms])


def wing_hinge(vehicle: VehicleParams) -> tuple[np.ndarray, float]:
    """Hinge of the trim wing on the backshell (m in B), and its distance from the axis (m)."""
    stations, radii = zip(*reversed(backshell_profile(vehicle)), strict=True)
    x = vehicle.surfaces[0].position_x_m
    radius = float(np.interp(x, stations, radii))
    return np.array([x, 0.0, radius * np.sign(vehicle.surfaces[0].position_z_m)]), radius


def wing_axes(vehicle: VehicleParams, opening: np.ndarray) -> np.ndarray:
    """Axes of the wing's mesh in B as columns, shape (..., 3, 3): along the backshell when closed, square to
    the axis when open.
    """
    swing = (1.0 - opening) * radians(90.0 + vehicle.aero.capsule.backshell_cone_angle_deg)
    ahead, out = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, np.sign(vehicle.surfaces[0].position_z_m)])
    c, s = np.cos(swing)[..., None], np.sin(swing)[..., None]
    span, normal = c * out - s * ahead, c * ahead + s * out
    return np.stack([span, np.cross(normal, span), normal], axis=-1)


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
        parts += [
            rod(ankle, 0.9 * reach * out + k * 0.30 * side - [0.62, 0.0, 0.0], 0.03, SILVER)
            for k in (-1.0, 1.0)
        ]
        parts.append(rod(pad - [0.11, 0.0, 0.0], pad, 0.12, GOLD, 0.22))
        parts.append(
            revolve([(x, 0.22), (x, 1e-4)], GOLD, 24, (np.array([0.0, y, z]), np.array([1.0, 0.0, 0.0])))
        )
    return merge(parts) if parts else None


def canopy(vehicle: VehicleParams) -> tuple[Mesh, np.ndarray]:
    """Disk-gap-band canopy and its lines; x from the bridle confluence to the canopy, skirt at the line
    length.

    Returns:
        mesh, and the lines as segments (n, 2, 3).
    """
    diameter, length = vehicle.main_parachute.diameter_m, vehicle.main_parachute.line_length_m
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
