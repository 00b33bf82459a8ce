"""Shapes of the vehicle: heat shield and backshell, sphere, box, trim wing, parachute; lander, rover, legs
and nozzles.

All are in ``B``: x forward through the nose, y right, z down.  Dimensions, footpads and nozzles are those of
the vehicle file; stripes, rims, lander body and rover are decoration, no larger than the aeroshell.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from math import cos, pi, sin, sqrt
from typing import Any

import numpy as np

from edl6dof.replay.scene.mesh import RGB, WHITE, Mesh, box, merge, revolve, rod
from edl6dof.replay.scene.outline import Corner, Outline
from edl6dof.vehicle.vehicle import VehicleParams

GOLD: RGB = (222, 164, 66)
SILVER: RGB = (176, 180, 188)
DARK: RGB = (58, 60, 68)
PANEL: RGB = (38, 52, 110)
ORANGE: RGB = (226, 92, 40)
SHIELD: RGB = (255, 214, 176)
#: Function from segment (around the axis) and step (along a profile) to a colour; function from the station
#: of the base (m) and a scale to a mesh.
Paint = Callable[[int, int], RGB]
Builder = Callable[[float, float], Mesh]
#: Radius (m) of the aeroshell that a lander of scale one fits into, and the room kept around it (share).
_RADIUS, _ROOM = 1.7, 0.97


def striped(base: RGB, every: int, factor: float) -> Paint:
    """Paint with a darker stripe at each ``every``-th segment around."""
    red, green, blue = (int(c * factor) for c in base)
    darker = red, green, blue
    return lambda i, j: darker if i % every == 0 else base


def _gores(each: int) -> Paint:
    """Paint with stripes of two colours, each of this many segments."""
    return lambda i, j: ORANGE if i // each % 2 == 0 else WHITE


def heat_shield(shape: Outline) -> Mesh:
    """Return a sphere-cone forebody with its shoulder, closed behind; light, so that heat can tint it."""
    nose, knee, edge = (shape.forebody[k] for k in (0, 6, -1))
    thick = 0.018 * edge[1]
    rim = (edge[0] + 0.6 * thick, edge[1] - 1.6 * thick)
    inside = [edge, rim, (knee[0] - 2.0 * thick, knee[1]), (nose[0] - 2.0 * thick, 1e-4)]
    return merge([revolve(shape.forebody, striped(SHIELD, 8, 0.86), 64), revolve(inside, DARK, 64)])


def backshell(shape: Outline) -> Mesh:
    """Return cones with panel stripes, a rim and the lid; open in front."""
    corners = shape.afterbody
    (x0, r0), (x2, r2) = corners[0], corners[-1]
    panels = [revolve(list(ends), striped(WHITE, 8, 0.72), 64) for ends in pairwise(corners)]
    rim = revolve([(x0 + 0.006 * r0, 1.005 * r0), (x0 - 0.04 * r0, 1.005 * r0)], DARK, 64)
    end = (x2 - 0.018 * r0, r2 * 0.96)
    lid = [revolve([(x2, r2), end], DARK, 48), revolve([end, (end[0], 1e-4)], ORANGE, 48)]
    return merge([*panels, rim, *lid])


def body(shape: Outline) -> Mesh:
    """Return a sphere or a box, painted so that its rotation can be seen."""
    if shape.body == "box":
        stripe = shape.sides * [0.12, 1.01, 1.01]
        ahead = shape.centre + [0.38 * shape.sides[0], 0.0, 0.0]
        return merge([box(shape.centre, shape.sides, WHITE), box(ahead, stripe, ORANGE)])
    turn = np.linspace(0.0, pi, 25)
    ball = [(shape.radius * np.cos(a), max(shape.radius * np.sin(a), 1e-4)) for a in turn]
    mesh = revolve(ball, lambda i, j: ORANGE if (i // 6 + j // 6) % 2 == 0 else WHITE, 48)
    return mesh._replace(positions=mesh.positions + shape.centre)


def trim_wing(vehicle: VehicleParams, shape: Outline) -> Mesh:
    """Return the first surface: origin at its hinge, x along the span, z facing the flow when open."""
    surface = vehicle.surfaces[0]
    side = sqrt(surface.area_m2)
    span = abs(surface.position_z_m) - wing_hinge(vehicle, shape)[1]
    plate = box((span, 0.0, 0.03), (side, side, 0.035), ORANGE)
    reach = span - 0.5 * side
    arms = [rod((0.0, y, 0.0), (reach, y, 0.03), 0.022, SILVER) for y in (-0.35 * side, 0.35 * side)]
    edge = rod((span + 0.5 * side, -0.5 * side, 0.03), (span + 0.5 * side, 0.5 * side, 0.03), 0.028, WHITE)
    return merge([plate, edge, *arms])


def wing_hinge(vehicle: VehicleParams, shape: Outline) -> tuple[np.ndarray, float]:
    """Return the hinge of the first surface (m in B), and its distance from the axis (m)."""
    x, out = vehicle.surfaces[0].position_x_m, np.sign(vehicle.surfaces[0].position_z_m)
    radius = float(shape.radius_at(np.array(x))) if shape.afterbody else shape.radius
    return np.array([x, 0.0, radius * out]), radius


def wing_axes(vehicle: VehicleParams, shape: Outline, opening: np.ndarray) -> np.ndarray:
    """Return the wing's axes in B as columns, shape (..., 3, 3): along the backshell at ``opening`` 0,
    perpendicular to the axis at 1.
    """
    flank = shape.flank_angle if shape.afterbody else 0.0
    swing = (1.0 - opening) * (0.5 * pi + flank)
    ahead = np.array([1.0, 0.0, 0.0])
    out = np.array([0.0, 0.0, np.sign(vehicle.surfaces[0].position_z_m)])
    c, s = np.cos(swing)[..., None], np.sin(swing)[..., None]
    span, normal = c * out - s * ahead, c * ahead + s * out
    return np.stack([span, np.cross(normal, span), normal], axis=-1)


def canopy(vehicle: VehicleParams, number: int) -> tuple[Mesh, np.ndarray]:
    """Return a disk-gap-band canopy and its lines; x from the bridle confluence to the canopy, skirt at the
    line length.

    Returns:
        mesh, and the lines as segments (n, 2, 3).
    """
    diameter, length = vehicle.parachutes[number].diameter_m, vehicle.parachutes[number].line_length_m
    r, band, gap, height = 0.34 * diameter, 0.12 * diameter, 0.035 * diameter, 0.20 * diameter
    gores, vent, skirt = 24, 0.06, length
    dome = [(skirt + band + gap + height * cos(a), r * sin(a)) for a in np.linspace(vent, pi / 2.0, 10)]
    cloth = revolve([(skirt, 0.97 * r), (skirt + band, r)], _gores(6), 2 * gores)
    mesh = merge([cloth, revolve(dome, _gores(2), 2 * gores)])
    turn = np.linspace(0.0, 2.0 * pi, gores, endpoint=False)
    rim = np.stack([np.full(gores, skirt), 0.97 * r * np.cos(turn), 0.97 * r * np.sin(turn)], axis=-1)
    riser = np.array([0.13 * length, 0.0, 0.0])
    lower = np.stack([np.broadcast_to(riser, rim.shape), rim], axis=1)
    upper = np.stack([rim + [band, 0.0, 0.0], rim + [band + gap, 0.0, 0.0]], axis=1)
    return mesh, np.concatenate([np.array([[[0.0, 0.0, 0.0], riser]]), lower, upper])


def bridle(vehicle: VehicleParams, shape: Outline, number: int) -> np.ndarray:
    """Return the bridle of a parachute, from its attachments or from around the lid to the confluence, as
    segments (n, 2, 3), m in B.
    """
    chute = vehicle.parachutes[number]
    ends = [list(one) for one in chute.bridle_attachments_m]
    if not ends and shape.afterbody:
        x, r = shape.afterbody[-1]
        ends = [[x, r * cos(a), r * sin(a)] for a in (0.0, 2.1, 4.2)]
    ends = ends or [list(shape.centre)]
    return np.array([[end, list(chute.confluence_m)] for end in ends])


def lander(vehicle: VehicleParams, shape: Outline) -> Mesh | None:
    """Return body, deck and rover, as large as the aeroshell allows, and struts to nozzles and engines."""
    if shape.lander == "none":
        return None
    parts, base, scale = _sized(vehicle, shape)
    carried = [rod(*ends, 0.018, SILVER) for ends in struts(vehicle, shape)]
    return merge([*(part(base, scale) for part in parts), *carried])


def _sized(vehicle: VehicleParams, shape: Outline) -> tuple[Sequence[Builder], float, float]:
    """The parts of a lander, the station of its underside (m), and its scale."""
    parts, base, scale = _PARTS[shape.lander], _base(vehicle, shape), shape.radius / _RADIUS
    while scale > 0.02 and not _inside(parts, base, scale, shape):
        scale *= 0.95
    return parts, base, scale


def struts(vehicle: VehicleParams, shape: Outline) -> list[tuple[np.ndarray, np.ndarray]]:
    """Return the ends (m in B) of two struts from the body to each thruster and engine outside the body."""
    _, base, scale = _sized(vehicle, shape)
    height, radius = _BODIES.get(shape.lander, _BODIES["legs"])
    throats = [np.add(jet.position_m, 0.1 * np.array(jet.direction)) for jet in vehicle.rcs.thrusters]
    bell_m = 0.28 * shape.radius / _RADIUS
    throats += [np.add(one.nozzle_m, bell_m * np.array(one.direction)) for one in vehicle.own_engines]
    found = []
    for throat in throats:
        out = np.array([0.0, *throat[1:]]) / max(np.hypot(*throat[1:]), 1e-6)
        aside, reach = 0.12 * scale * np.cross([1.0, 0.0, 0.0], out), np.hypot(*throat[1:])
        low = base - height * scale
        if reach < radius * scale and low <= throat[0] <= base:
            continue  # it is on the body
        mount = np.array([np.clip(throat[0], low, base), 0.0, 0.0]) + min(0.8 * radius * scale, reach) * out
        if np.linalg.norm(throat - mount) > 0.05 * scale:  # not the main engine, right below the body
            found += [(mount + side * aside, throat) for side in (-1.0, 1.0)]
    return found


def _inside(parts: Sequence[Builder], base: float, scale: float, shape: Outline) -> bool:
    """True if all of a lander lies inside the aeroshell, if there is one."""
    if not shape.afterbody:
        return True
    place = np.concatenate([part(base, scale).positions for part in parts])
    return bool(np.all(np.hypot(place[:, 1], place[:, 2]) <= _ROOM * shape.radius_at(place[:, 0])))


def _base(vehicle: VehicleParams, shape: Outline) -> float:
    """Station of the body's underside, m: above the engines, or where the shoulder is."""
    if vehicle.engines:
        return min(engine.nozzle_m[0] for engine in vehicle.engines) - 0.3 * shape.radius / _RADIUS
    return shape.afterbody[0][0] if shape.afterbody else float(shape.centre[0])


def _stage(base: float, scale: float) -> Mesh:
    """Descent stage: octagonal foil body and its deck."""
    top, r = base - 0.65 * scale, 1.054 * scale
    return _drum([(base, r), (top, r)], striped(GOLD, 2, 0.86), SILVER, 8, 1.04)


def _platform(base: float, scale: float) -> Mesh:
    """Flat round platform that lands on its underside."""
    top, r = base - 0.45 * scale, 1.1 * scale
    sides = [(base, 0.92 * r), (base - 0.12 * scale, r), (top, r)]
    return _drum(sides, striped(SILVER, 6, 0.86), PANEL, 48, 1.0)


def _drum(sides: list[Corner], paint: RGB | Paint, deck: RGB, segments: int, rim: float) -> Mesh:
    """A closed drum: its sides from the underside up, the underside, and a deck that overhangs by ``rim``."""
    (base, low), (top, high) = sides[0], sides[-1]
    ends = (((base, low), (base, 1e-4)), DARK), (((top, high * rim), (top, 1e-4)), deck)
    plates = [revolve(profile, colour, segments) for profile, colour in ends]
    return merge([revolve(sides, paint, segments), *plates])


def _rover(base: float, scale: float) -> Mesh:
    """Rover on the deck: body, solar panels, mast, wheels on their ramps."""
    top = base - 0.65 * scale

    def at(x: float, y: float, z: float) -> np.ndarray:
        return np.array([top - scale * x, scale * y, scale * z])

    def size(x: float, y: float, z: float) -> np.ndarray:
        return scale * np.array([x, y, z])

    parts = [
        *_chassis(top, scale),
        box(at(0.44, 0.0, 0.0), size(0.04, 1.15, 1.45), PANEL),
        rod(at(0.44, 0.30, -0.45), at(0.85, 0.30, -0.45), 0.03 * scale, SILVER),
        box(at(0.88, 0.30, -0.45), size(0.08, 0.22, 0.10), WHITE),
    ]
    parts += [box(at(0.02, side * 0.45, 0.0), size(0.03, 0.22, 1.6), SILVER) for side in (-1.0, 1.0)]
    return merge(parts)


def _crane(base: float, scale: float) -> Mesh:
    """Descent stage of a sky crane: a flat frame with three tanks."""
    frame = _drum([(base, 0.8 * scale), (base - 0.30 * scale, 0.8 * scale)], SILVER, DARK, 6, 1.0)
    turn = np.linspace(0.0, 2.0 * pi, 3, endpoint=False)
    places = [(base - 0.30 * scale, 0.5 * scale * cos(a), 0.5 * scale * sin(a)) for a in turn]
    arc = np.linspace(0.0, pi, 13)
    ball = [(-0.26 * scale * cos(a), max(0.26 * scale * sin(a), 1e-4)) for a in arc]
    ahead = np.array([1.0, 0.0, 0.0])
    return merge([frame, *(revolve(ball, GOLD, 24, (np.array(place), ahead)) for place in places)])


def _hung(base: float, scale: float) -> Mesh:
    """Rover below the underside of a sky crane, on three bridles."""
    deck = base + 0.35 * scale
    turn = np.linspace(0.0, 2.0 * pi, 3, endpoint=False)
    ends = [(0.35 * scale * cos(a), 0.35 * scale * sin(a)) for a in turn]
    bridles = [rod((base, *end), (deck, *end), 0.015 * scale, WHITE) for end in ends]
    return merge([*_chassis(deck + 0.41 * scale, scale), *bridles])


def _chassis(top: float, scale: float) -> list[Mesh]:
    """Body of a rover and its six wheels, on ground at the station ``top`` (m)."""
    parts = [box((top - 0.30 * scale, 0.0, 0.0), scale * np.array([0.22, 0.85, 1.25]), WHITE)]
    for side in (-1.0, 1.0):
        for z in (-0.5, 0.0, 0.5):
            inner, outer = (scale * np.array([-0.15, side * y, z]) + [top, 0.0, 0.0] for y in (0.42, 0.58))
            parts.append(rod(inner, outer, 0.15 * scale, DARK))
    return parts


#: Parts of each kind of lander, and height and radius of its body at scale one, m.
_PARTS: dict[str, tuple[Builder, ...]] = {
    "legs": (_stage,), "platform": (_platform,), "rover": (_stage, _rover), "crane": (_crane, _hung),
}  # fmt: skip
_BODIES = {"legs": (0.65, 0.97), "platform": (0.45, 1.0), "crane": (0.30, 0.69)}


def nozzles(vehicle: VehicleParams, shape: Outline) -> Mesh | None:
    """Return nozzles of thrusters and bells of engines; ``None`` without any."""
    parts = [nozzle(jet, DARK) for jet in vehicle.rcs.thrusters]
    parts += [bell(engine, shape.radius / _RADIUS) for engine in vehicle.own_engines]
    return merge(parts) if parts else None


def nozzle(jet: Any, colour: RGB, size: float = 1.0) -> Mesh:
    """Return the nozzle of one thruster, whose flame leaves against the thrust direction."""
    place, back = np.array(jet.position_m), -np.array(jet.direction)
    length = size * (0.16 if jet.thrust_n > 100.0 else 0.09)
    return rod(place - length * back, place + 0.02 * (size - 1.0) * back, 0.2 * length, colour, 0.5 * length)


def bell(engine: Any, scale: float) -> Mesh:
    """Return the bell of an engine, its mouth at the nozzle and open against the thrust."""
    back = -np.array(engine.direction)
    profile = [(-0.30 * scale, 0.10 * scale), (-0.10 * scale, 0.17 * scale), (0.0, 0.25 * scale)]
    return revolve(profile, DARK, 32, (np.array(engine.nozzle_m), back))


def legs(vehicle: VehicleParams, shape: Outline, stroke: np.ndarray) -> Mesh | None:
    """Return legs at the footpads, each compressed by its ``stroke`` (m); ``None`` without footpads."""
    if shape.lander not in ("legs", "rover") or not vehicle.landing_gear.footpads_m:
        return None
    scale = shape.radius / _RADIUS
    base, reach, parts = _base(vehicle, shape), 1.02 * scale, []
    for (x, y, z), push in zip(vehicle.landing_gear.footpads_m, stroke, strict=True):
        out = np.array([0.0, y, z]) / max(np.hypot(y, z), 1e-6)
        side = np.cross(out, [1.0, 0.0, 0.0])
        pad = np.array([x - push, y, z])
        ankle = pad - [0.10, 0.0, 0.0]
        parts.append(rod(ankle, reach * out + [base - 0.45 * scale, 0.0, 0.0], 0.05, SILVER))
        parts += [
            rod(ankle, 0.9 * reach * out + k * 0.30 * side + [base - 0.02 * scale, 0.0, 0.0], 0.03, SILVER)
            for k in (-1.0, 1.0)
        ]
        parts.append(rod(pad - [0.11, 0.0, 0.0], pad, 0.12, GOLD, 0.22))
        ahead = np.array([0.0, y, z]), np.array([1.0, 0.0, 0.0])
        parts.append(revolve([(pad[0], 0.22), (pad[0], 1e-4)], GOLD, 24, ahead))
    return merge(parts)
