"""The vehicle in top and side view, and tables of the control authority of its thrusters.

Shapes come from the vehicle file as in the replay (:mod:`edl6dof.replay.scene.outline`).  A tank is the solid
ellipsoid that has the moments of inertia of its load.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np
from scipy.spatial import ConvexHull

from edl6dof.design.thruster_authority import Configuration, groups_of
from edl6dof.replay.scene import craft_shapes as shapes
from edl6dof.replay.scene.outline import Outline, outline
from edl6dof.report.document import Row, Table, decimals
from edl6dof.report.figure import Axis, Figure, Panel, Trace, through
from edl6dof.report.palette import BLACK, BLUE, GREEN, GREY, INK, ORANGE, PURPLE, SKY, SOFT, VERMILION
from edl6dof.vehicle.vehicle import VehicleParams

_X, _Y, _Z = np.eye(3)
_COLOURS = {"horizontal": BLUE, "axial": VERMILION, "attitude": GREEN, "fine": PURPLE}
#: Marks of the centre of mass in each configuration.
_CENTRES = (("cross", BLACK), ("diamond", GREY))
#: Lengths as shares of the vehicle's size: arrows of thrusters and of engines, distance of a dimension line,
#: its end marks, and the distance within which nozzles have one label.
_ARROW, _ENGINE, _AWAY, _TICK, _SAME = 0.12, 0.18, 0.09, 0.02, 0.02
#: Room around the vehicle as a share of its width, and the share of an arrow that must be seen.
_ROOM, _SEEN = 0.07, 0.2
#: Width of a panel, and height of its title and of the numbers below it, px.
_WIDE, _WORDS = 430.0, 50
#: Direction from the middle of a panel to the corner of its axes, and corners of a square with sides of 2.
_OUTWARDS = np.array([-1.0, 1.0])
_SQUARE = np.array([[-1, -1], [-1, 1], [1, 1], [1, -1], [-1, -1]])

CAPTION = (
    "CM: centre of mass with full tanks. The force on the vehicle is opposite to the exhaust. Dots: exhaust "
    "towards the reader, crosses: away; the top view has their names. The length of an arrow does not show "
    "the thrust. A tank is the ellipsoid that has the moments of inertia of its load."
)
NOTE = (
    "Duties from 0 to 1, nominal thrust in vacuum. Torque: the largest while the other two torques are zero. "
    "Force: the largest without torque and without the other two forces. Sum: of all thrusters that push "
    "this way, whatever else they do. A group that cannot cancel its unwanted components alone has 0."
)


class View(NamedTuple):
    """A view: its title, the axes of B to the right, up and to the reader, and the titles of its axes."""

    title: str
    right: np.ndarray
    up: np.ndarray
    reader: np.ndarray
    axes: tuple[str, str]

    def flat(self, places: Any) -> np.ndarray:
        """Project places in B, shape (..., 3), m, onto the plane of the view, shape (..., 2)."""
        return np.asarray(places, float) @ np.stack([self.right, self.up], axis=1)


TOP = View("Top view (from behind, along x)", _Y, -_Z, -_X, ("y (m)", "-z, up (m)"))
SIDE = View("Side view (from the right, against y)", _X, -_Z, _Y, ("x, forward (m)", "-z, up (m)"))


class Arrows(NamedTuple):
    """Arrows of one kind: names, places (n, 3) and directions (n, 3) in B, colour and length (m)."""

    kind: str
    names: Sequence[str]
    places: np.ndarray
    directions: np.ndarray
    colour: str
    length: float


def vehicle_figure(vehicle: VehicleParams, states: Sequence[Configuration]) -> Figure:
    """Draw top and side view of a vehicle at one scale, with its centre of mass in each of ``states``."""
    shape = outline(vehicle)
    views = [(view, [*_drawn(vehicle, shape, states, view)]) for view in (TOP, SIDE)]
    places = [np.concatenate([np.stack([t.x, t.y], axis=1) for t in traces]) for _, traces in views]
    low, high = (np.array([of(one, axis=0) for one in places]) for of in (np.nanmin, np.nanmax))
    room = _ROOM * (high - low)[:, 0].max()
    if not shape.forebody:  # a body of revolution leaves the corner of the axes free
        low -= [2.0 * room, 0.0]
    half, middle = 0.5 * (high - low).max(axis=0) + room, 0.5 * (high + low)
    panels = []
    for (view, traces), at in zip(views, middle, strict=True):
        corner = at + _OUTWARDS * half - _OUTWARDS * 0.9 * room
        place = np.stack([view.right, view.up], axis=1) @ corner
        axes = Arrows("", ("x", "y", "z"), np.tile(place, (3, 1)), np.eye(3), INK, 1.3 * room)
        traces += _arrows(axes, view, shape.size)
        ends = zip(view.axes, at - half, at + half, strict=True)
        across, up = (Axis(title, (low, high)) for title, low, high in ends)
        panels.append(Panel(across, up, traces, title=view.title, equal=True))
    height = round(_WIDE * half[1] / half[0]) + _WORDS
    title = f"{vehicle.name}; arrows show the exhaust"
    return Figure("vehicle", title, panels, CAPTION, columns=2, height=height)


def _drawn(
    vehicle: VehicleParams, shape: Outline, states: Sequence[Configuration], view: View
) -> Iterator[Trace]:
    """Draw everything that has a place on the vehicle, and the dimensions of the vehicle."""
    for corners, width in _outlines(vehicle, shape, view):
        yield through(corners, colour=GREY, width=width)
    for tank in vehicle.tanks:
        ring = _ring(view.flat(tank.centre_m), np.abs(view.flat(half_axes(tank.mass_kg, tank.inertia_kg_m2))))
        yield through(ring, "tank", "region", colour=SKY)
        yield through(ring, colour=SKY, dash="dash")
    for surface in vehicle.surfaces:
        hinged = np.array([surface.position_x_m, 0.0, surface.position_z_m])
        corners = hinged + 0.5 * np.sqrt(surface.area_m2) * np.pad(_SQUARE, ((0, 0), (1, 0)))  # open
        labels = [surface.name.replace("_", " "), *[""] * (len(corners) - 1)]
        yield through(view.flat(corners), labels=labels, colour=SOFT, width=2.5)
    if pads := vehicle.landing_gear.footpads_m:
        yield through(view.flat(pads), "footpads", "points", colour=SOFT, symbol="square")
    for arrows in exhausts(vehicle, shape.size):
        yield from _arrows(arrows, view, shape.size)
    for state, (symbol, colour) in reversed([*zip(states, _CENTRES, strict=False)]):
        place = view.flat(state.centre_m)[None]
        yield through(place, f"CM {state.name}", "points", colour=colour, symbol=symbol, width=3.0)
    if shape.body != "none":
        yield from _dimensions(shape, view)


def exhausts(vehicle: VehicleParams, size: float) -> Iterator[Arrows]:
    """Return the exhaust of each thruster group, and of the engines, of a vehicle of some size (m)."""
    for group, colour in _COLOURS.items():
        if jets := [jet for jet in vehicle.rcs.thrusters if jet.group == group]:
            places, along = np.array([(jet.position_m, jet.direction) for jet in jets]).swapaxes(0, 1)
            yield Arrows(group, [jet.name for jet in jets], places, -along, colour, _ARROW * size)
    if engines := vehicle.own_engines:
        places, along = np.array([(one.nozzle_m, one.direction) for one in engines]).swapaxes(0, 1)
        yield Arrows("engines", [one.name for one in engines], places, -along, ORANGE, _ENGINE * size)


def _arrows(arrows: Arrows, view: View, size: float) -> Iterator[Trace]:
    """Draw arrows that are seen from the side, marks of those along the line of sight, and names."""
    start, depth = view.flat(arrows.places), arrows.directions @ view.reader
    step = view.flat(arrows.directions) * arrows.length
    seen = np.hypot(step[:, 0], step[:, 1]) > _SEEN * arrows.length
    tips = np.where(seen[:, None], start + step, start)
    head, aside = tips - 0.28 * step, 0.11 * step[:, ::-1] * [-1.0, 1.0]
    ways = np.stack([start, tips, head + aside, tips, head - aside, np.full_like(step, np.nan)], axis=1)
    look: Any = {"colour": arrows.colour, "width": 1.8}
    if seen.any():
        yield through(ways[seen].reshape(-1, 2), arrows.kind, **look)
    for along, symbol in ((~seen & (depth > 0.0), "circle"), (~seen & (depth < 0.0), "x")):
        if along.any():
            yield through(start[along], arrows.kind, "points", symbol=symbol, **look)
    named: dict[tuple[float, ...], list[int]] = {}
    for k in np.flatnonzero(seen | (view is TOP) | (not arrows.kind)):
        named.setdefault(tuple(np.round(tips[k] / (_SAME * size))), []).append(k)
    for _, members in sorted(named.items(), key=lambda one: one[0][::-1]):  # from below
        words = ", ".join(arrows.names[k] for k in members)
        yield through(tips[members[:1]], labels=[words], colour=arrows.colour)


def _outlines(vehicle: VehicleParams, shape: Outline, view: View) -> Iterator[tuple[np.ndarray, float]]:
    """Outline of the body in a view, and its edges; each with the width of its line."""
    middle, reach = view.flat(shape.centre), np.abs(view.flat(0.5 * shape.sides))
    if shape.body == "sphere_cone" and view is SIDE:
        half = np.array([*shape.forebody, *shape.afterbody])
        yield np.concatenate([half, half[::-1] * [1.0, -1.0], half[:1]]), 1.8
        yield from ((np.array([[x, -r], [x, r]]), 0.8) for x, r in shape.afterbody)
    elif shape.body == "sphere_cone":
        yield _ring(np.zeros(2), reach), 1.8
        yield from ((_ring(np.zeros(2), np.full(2, r)), 0.8) for _, r in shape.afterbody)
    elif shape.body == "box":
        yield middle + reach * _SQUARE, 1.8
    elif shape.body == "sphere":
        yield _ring(middle, reach), 1.8
    elif (mesh := shapes.lander(vehicle, shape)) is not None:
        flat = view.flat(mesh.positions)
        hull = ConvexHull(flat).vertices
        yield flat[[*hull, hull[0]]], 1.8


def half_axes(mass_kg: float, inertia_kg_m2: Sequence[float]) -> np.ndarray:
    """Return the half axes x, y, z (m) of a solid ellipsoid with a mass and moments of inertia."""
    inertia = np.array(inertia_kg_m2)
    squares = 2.5 * (inertia.sum() - 2.0 * inertia) / max(mass_kg, 1e-9)
    return np.sqrt(np.maximum(squares, 0.0))


def _ring(centre: np.ndarray, axes: np.ndarray) -> np.ndarray:
    turn = np.linspace(0.0, 2.0 * np.pi, 121)
    return centre + axes * np.stack([np.cos(turn), np.sin(turn)], axis=1)


def _dimensions(shape: Outline, view: View) -> Iterator[Trace]:
    """Draw the extent of the body across and, where it is no body of revolution, upwards."""
    middle = shape.centre
    if shape.forebody:
        middle = np.array([shape.forebody[0][0] - 0.5 * shape.sides[0], 0.0, 0.0])
    reach, is_round = np.abs(view.flat(0.5 * shape.sides)), shape.sides[1] == shape.sides[2]
    across, up = np.eye(2)
    lines = [(across, -up, "length" if view is SIDE else "diameter" if is_round else "width")]
    lines += [(up, across, "height")] * (view is SIDE and not is_round)
    for along, aside, name in lines:
        centre = view.flat(middle) + aside * (reach @ np.abs(aside) + _AWAY * shape.size)
        end, tick, gap = along * reach, _TICK * shape.size * aside, np.full(2, np.nan)
        ends = [place for at in (centre - end, centre + end) for place in (gap, at - tick, at + tick)]
        look: Any = {"colour": INK, "width": 1.0}
        labels = ["", f"{name} {2.0 * reach @ along:.2f} m", ""]
        yield through(np.array([centre - end, centre, centre + end]), labels=labels, **look)
        yield through(np.array(ends), **look)


def authority_tables(vehicle: VehicleParams, states: Sequence[Configuration]) -> list[Table]:
    """Tabulate the authority of each thruster group in each configuration of a vehicle."""
    members = groups_of(vehicle)
    columns = ["group", "", "-x>", "+x>", "-y>", "+y>", "-z>", "+z>"]
    tables = []
    for state in states:
        rows: list[Row] = []
        for group, (pure, total) in state.groups.items():
            thrust = _thrust([jet.thrust_n for jet in members[group]])
            rows.append([group, "torque (N m)", *map(_number, pure[3:].ravel())])
            rows.append([thrust, "  sum", *map(_number, total[3:].ravel())])
            rows.append(["", "force (N)", *map(_number, pure[:3].ravel())])
            rows.append(["", "  sum", *map(_number, total[:3].ravel())])
        place = ", ".join(f"{round(x, 3) + 0.0:.3f}" for x in state.centre_m)
        caption = f"Thruster authority {state.name}, centre of mass at ({place}) m"
        tables += [Table(columns, rows, caption)] if rows else []
    return tables


def _thrust(thrusts_n: Sequence[float]) -> str:
    low, high = min(thrusts_n), max(thrusts_n)
    return f"{len(thrusts_n)} x {high:g} N" if low == high else f"{len(thrusts_n)} thrusters"


def _number(value: float) -> str:
    return f"{value:,.{min(decimals(abs(value), 3), 4)}f}"
