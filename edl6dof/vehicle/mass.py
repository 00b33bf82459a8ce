"""Dry mass, centre of mass and inertia of the lander with the parts still attached; the propellant is added
by :mod:`edl6dof.vehicle.propulsion.feed_system`.

The vehicle file gives the whole entry vehicle, its propellant and the parts that leave it; the dry lander is
the remainder.
Composition and decomposition use the parallel-axis theorem, so the parts always add up to the entry vehicle.
The lander's inertia may be given itself instead of the whole vehicle's.  Stations are in B (origin at the
nose, x forward).
"""

from __future__ import annotations

from functools import lru_cache
from typing import Literal, get_args

import numpy as np
from pydantic import model_validator

from edl6dof.config.base import REQUIRED, Hardware, Key, Vec3, param, stated
from edl6dof.kernels import kernel
from edl6dof.records import record
from edl6dof.spatial.arrays import product, total

#: Shape of the vehicle in the flow while a part is attached: none, the bare lander; the whole capsule, heat
#: shield ahead; the open backshell with the lander inside.
Shape = Literal["none", "capsule", "backshell"]
SHAPES: tuple[Shape, ...] = get_args(Shape)
CONFIG_LANDER, CONFIG_CAPSULE, CONFIG_BACKSHELL = range(len(SHAPES))


class Body(Hardware):
    """A rigid body inside the vehicle."""

    mass_kg: float = param(0.0, "mass", ge=0.0)
    centre_m: Vec3 = param((0.0, 0.0, 0.0), "centre of mass in B")
    inertia_kg_m2: Vec3 = param((0.0, 0.0, 0.0), "Ixx, Iyy, Izz about its own centre of mass")


class Part(Body):
    """A rigid part that can be jettisoned."""

    name: Key = param(REQUIRED, "name in events", record=False)
    shape: Shape = param(
        "none", "shape in the flow while this is the first attached part of the list that has a shape"
    )
    separation_velocity_m_s: Vec3 = param(
        (0.0, 0.0, 0.0),
        "separation velocity relative to the rest of the vehicle, in B",
        status="estimate",
        usual=(-20, 20, "springs to rockets"),
    )
    drag_area_m2: float = param(
        0.0,
        "drag area of the part after separation",
        status="estimate",
        ge=0.0,
        usual=(0, 200, "parts of such a vehicle"),
    )


class Tank(Body):
    """The propellant of a tank; the tank itself is a piece of the lander."""

    name: Key = param(REQUIRED, "name in draws_from of engines and thrusters", record=False)
    mass_kg: float = param(
        REQUIRED,
        "propellant loaded at entry interface",
        ge=0.0,
        usual=(0.1, 100000, "tanks of such a vehicle"),
    )
    centre_m: Vec3 = param((0.0, 0.0, 0.0), "centre of mass of the propellant in B")
    inertia_kg_m2: Vec3 = param(
        (0.0, 0.0, 0.0),
        "Ixx, Iyy, Izz of the full load about its own centre; in proportion to the propellant left",
    )


class MassParams(Hardware):
    """Mass properties of the entry vehicle, with its propellant."""

    entry_kg: float = param(
        REQUIRED,
        "mass of the whole vehicle at entry interface",
        gt=0.0,
        usual=(5, 200000, "Deep Space 2 to a crewed lander"),
    )
    entry_centre_m: Vec3 = param(
        REQUIRED, "centre of mass at entry interface in B; the radial offset sets the trim angle"
    )
    entry_inertia_kg_m2: Vec3 | None = param(
        None, "Ixx, Iyy, Izz about the centre of mass at entry interface", record=False
    )
    entry_products_kg_m2: Vec3 = param(
        (0.0, 0.0, 0.0),
        "products of inertia (integrals of xy, xz, yz) that go with entry_inertia_kg_m2",
        record=False,
    )
    lander_inertia_kg_m2: Vec3 | None = param(
        None,
        "Ixx, Iyy, Izz of the dry lander without any part about its own centre, in place of those at entry",
        record=False,
    )

    @model_validator(mode="after")
    def _one_inertia(self) -> MassParams:
        if (self.entry_inertia_kg_m2 is None) == (self.lander_inertia_kg_m2 is None):
            raise ValueError("must give either entry_inertia_kg_m2 or lander_inertia_kg_m2")
        if self.entry_inertia_kg_m2 is None and any(self.entry_products_kg_m2):
            raise ValueError("entry_products_kg_m2 goes with entry_inertia_kg_m2, which is not given")
        return self


def lander_problem(mass: MassParams, parts: tuple[Part, ...], tanks: tuple[Tank, ...]) -> str:
    """Reason why the lander without parts and propellant is impossible; empty if it is possible."""
    dry, inertia, _ = lander_dry(mass, parts, tanks)
    if dry <= 0.0:
        heavy = f"{mass.entry_kg - dry:.1f} kg together, more than entry_kg {mass.entry_kg:g}"
        return f"parts and propellant weigh {heavy}"
    principal = np.linalg.eigvalsh(inertia)
    if principal[0] <= 0.0 or principal[2] > principal[0] + principal[1]:
        return (
            "what is left for the dry lander has impossible principal inertias "
            f"{np.round(principal, 3).tolist()} kg m2 (each positive, none above the sum of the others)"
        )
    return ""


#: Rigid body: mass, centre of mass in B, inertia tensor elements (xx, yy, zz, xy, xz, yz) about it.
BODY = record(("mass", "f8"), ("centre", "f8", (3,)), ("inertia", "f8", (6,)))


def _shift(mass: float, arm: np.ndarray) -> np.ndarray:
    """Parallel-axis term m (|a|^2 1 - a a^T)."""
    return mass * (product(arm, arm) * np.eye(3) - np.outer(arm, arm))


@lru_cache(maxsize=64)
def lander_dry(
    params: MassParams, parts: tuple[Part, ...], tanks: tuple[Tank, ...]
) -> tuple[float, np.ndarray, np.ndarray]:
    """Mass (kg), inertia tensor about the centre (3x3, kg m2) and centre (3, m, B) of the dry lander."""
    others = (*parts, *tanks)
    mass = params.entry_kg - total(part.mass_kg for part in others)
    if mass <= 0.0:
        return mass, np.zeros((3, 3)), np.zeros(3)
    whole = np.asarray(params.entry_centre_m)
    moment = params.entry_kg * whole
    for part in others:
        moment = moment - part.mass_kg * np.asarray(part.centre_m)
    centre = moment / mass
    if params.lander_inertia_kg_m2 is not None:
        return mass, np.diag(params.lander_inertia_kg_m2), centre
    inertia = np.diag(stated(params.entry_inertia_kg_m2)) - _shift(mass, centre - whole)
    xy, xz, yz = params.entry_products_kg_m2
    inertia = inertia - np.array([[0.0, xy, xz], [xy, 0.0, yz], [xz, yz, 0.0]])
    for part in others:
        inertia = (
            inertia - np.diag(part.inertia_kg_m2) - _shift(part.mass_kg, np.asarray(part.centre_m) - whole)
        )
    return mass, inertia, centre


def loaded(
    params: MassParams, parts: tuple[Part, ...], tanks: tuple[Tank, ...], attached: tuple[Part, ...]
) -> tuple[float, np.ndarray, np.ndarray]:
    """Mass (kg), centre (3, m, B) and inertia tensor about it (3x3, kg m2) of the lander with full ``tanks``
    and the ``attached`` parts; ``parts``: all that there are.
    """
    mass, tensor, centre = lander_dry(params, parts, tanks)
    bodies = [(mass, np.asarray(centre), tensor)]
    for body in (*attached, *tanks):
        bodies.append((body.mass_kg, np.asarray(body.centre_m), np.diag(body.inertia_kg_m2)))
    whole, moment, inertia = total(m for m, _, _ in bodies), np.zeros(3), np.zeros((3, 3))
    for m, c, _ in bodies:
        moment = moment + m * c
    middle = moment / whole
    for m, c, j in bodies:
        inertia = inertia + j + _shift(m, c - middle)
    return whole, middle, inertia


def fill_lander(
    record: np.ndarray | np.void, params: MassParams, parts: tuple[Part, ...], tanks: tuple[Tank, ...]
) -> None:
    """Fill a ``BODY`` record with the dry lander that parts and propellant leave over."""
    record["mass"], inertia, record["centre"] = lander_dry(params, parts, tanks)
    record["inertia"] = inertia[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]


@kernel
def join(a, b):
    """Join two rigid bodies (mass, centre, inertia), each inertia about its own centre, same axes."""
    mass = a[0] + b[0]
    share = b[0] / mass
    dx, dy, dz = b[1][0] - a[1][0], b[1][1] - a[1][1], b[1][2] - a[1][2]
    centre = (a[1][0] + share * dx, a[1][1] + share * dy, a[1][2] + share * dz)
    m = a[0] * share  # reduced mass
    inertia = (
        a[2][0] + b[2][0] + m * (dy * dy + dz * dz),
        a[2][1] + b[2][1] + m * (dx * dx + dz * dz),
        a[2][2] + b[2][2] + m * (dx * dx + dy * dy),
        a[2][3] + b[2][3] - m * dx * dy,
        a[2][4] + b[2][4] - m * dx * dz,
        a[2][5] + b[2][5] - m * dy * dz,
    )
    return mass, centre, inertia


@kernel
def body_of(record):
    """A ``BODY`` record as (mass, centre, inertia) tuples."""
    c, i = record.centre, record.inertia
    return record.mass, (c[0], c[1], c[2]), (i[0], i[1], i[2], i[3], i[4], i[5])


@kernel
def part_of(part):
    """A ``Part`` record as (mass, centre, inertia) tuples."""
    c, i = part.centre, part.inertia
    return part.mass, (c[0], c[1], c[2]), (i[0], i[1], i[2], 0.0, 0.0, 0.0)


@kernel
def compose_dry(parts, count, lander, attached, dry):
    """Write the dry mass properties of the lander with its attached ``parts`` into ``dry``."""
    body = body_of(lander)
    for i in range(count):
        if attached[i] != 0:
            body = join(body, part_of(parts[i]))
    dry.mass = body[0]
    for k in range(3):
        dry.centre[k] = body[1][k]
    for k in range(6):
        dry.inertia[k] = body[2][k]


@kernel
def shape_of(parts, count, attached):
    """Shape in the flow: that of the first attached part that has one, else ``CONFIG_LANDER``."""
    for i in range(count):
        if attached[i] != 0 and parts[i].shape != CONFIG_LANDER:
            return parts[i].shape
    return CONFIG_LANDER


@kernel
def compose(case, plant):
    """Update dry mass properties and shape of the plant from the parts that are attached."""
    vehicle = case.vehicle
    compose_dry(vehicle.parts, vehicle.n_parts, case.lander, plant.attached, plant.dry)
    plant.shape = shape_of(vehicle.parts, vehicle.n_parts, plant.attached)


@kernel
def showing(parts, count, shape):
    """Index of the first part with this ``shape`` in the flow; -1 where there is none."""
    for i in range(count):
        if parts[i].shape == shape:
            return i
    return -1
