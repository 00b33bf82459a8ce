"""Mass, centre of mass and inertia of what is still attached, with the propellant that is left.

The file gives the whole entry vehicle and the parts that leave it; the dry lander is what remains.
Composition and decomposition use the parallel-axis theorem, so the parts always add up to the entry vehicle.
Stations are in B (origin at the nose, x forward).
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from pydantic import model_validator

from edl6dof.config.base import REQUIRED, Hardware, Vec3, group, param
from edl6dof.interface.parts import BACKSHELL, HEAT_SHIELD, PARACHUTE
from edl6dof.jit import kernel


class Part(Hardware):
    """A rigid part that can leave the vehicle, or the propellant load."""

    mass_kg: float = param(0.0, "mass", ge=0.0)
    centre_m: Vec3 = param((0.0, 0.0, 0.0), "centre of mass in B")
    inertia_kg_m2: Vec3 = param((0.0, 0.0, 0.0), "Ixx, Iyy, Izz about its own centre of mass")


class MassParams(Hardware):
    """Mass properties of the entry vehicle and of its parts."""

    entry_kg: float = param(REQUIRED, "mass of the whole vehicle at entry interface", gt=0.0)
    entry_centre_m: Vec3 = param(
        REQUIRED, ("centre of mass at entry interface in B; the radial offset sets the trim angle")
    )
    entry_inertia_kg_m2: Vec3 = param(REQUIRED, "Ixx, Iyy, Izz about the centre of mass at entry interface")
    heat_shield: Part = group(Part, "heat shield, jettisoned under the parachute")
    backshell: Part = group(Part, "backshell, leaves with the parachute")
    parachute: Part = group(Part, "packed parachute, leaves at mortar fire")
    propellant: Part = group(Part, "propellant loaded at entry interface")

    @model_validator(mode="after")
    def _lander_is_physical(self) -> MassParams:
        dry = lander_dry(self)
        inertia = dry[1] if dry[0] > 0.0 else np.diag([-1.0] * 3)
        principal = np.linalg.eigvalsh(inertia)
        if dry[0] <= 0.0:
            raise ValueError(
                f"the parts weigh {self.entry_kg - dry[0]:.1f} kg together, more than entry_kg "
                f"{self.entry_kg:g}"
            )
        if principal[0] <= 0.0 or principal[2] > principal[0] + principal[1]:
            raise ValueError(
                "what is left for the dry lander has impossible principal inertias "
                f"{np.round(principal, 3).tolist()} kg m2 (each positive, none above the sum of the others)"
            )
        return self


#: Rigid body: mass, centre of mass in B, inertia tensor elements (xx, yy, zz, xy, xz, yz) about it.
BODY = np.dtype([("mass", "f8"), ("centre", "f8", (3,)), ("inertia", "f8", (6,))], align=True)


def _tensor(inertia: Vec3) -> np.ndarray:
    return np.diag(np.asarray(inertia, dtype=float))


def _shift(mass: float, arm: np.ndarray) -> np.ndarray:
    """Parallel-axis term m (|a|^2 1 - a a^T)."""
    return mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))


@lru_cache(maxsize=64)
def lander_dry(params: MassParams) -> tuple[float, np.ndarray, np.ndarray]:
    """Mass (kg), inertia tensor about its centre (3x3, kg m2) and centre (3, m, B) of the lander without
    propellant.
    """
    parts = (params.heat_shield, params.backshell, params.parachute, params.propellant)
    mass = params.entry_kg - sum(part.mass_kg for part in parts)
    if mass <= 0.0:
        return mass, np.zeros((3, 3)), np.zeros(3)
    whole = np.asarray(params.entry_centre_m)
    moment = params.entry_kg * whole - sum(part.mass_kg * np.asarray(part.centre_m) for part in parts)
    centre = moment / mass
    inertia = _tensor(params.entry_inertia_kg_m2) - _shift(mass, centre - whole)
    for part in parts:
        inertia = (
            inertia - _tensor(part.inertia_kg_m2) - _shift(part.mass_kg, np.asarray(part.centre_m) - whole)
        )
    return mass, inertia, centre


def fill_lander(record: np.ndarray | np.void, params: MassParams) -> None:
    """Fill a ``BODY`` record with the dry lander that the parts leave over."""
    record["mass"], inertia, record["centre"] = lander_dry(params)
    record["inertia"] = inertia[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]


@kernel
def join(a, b):
    """Mass properties of two rigid bodies joined: (mass, centre, inertia) of each, inertia about its own
    centre, same axes.
    """
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
def compose_dry(mass, lander, attached, dry):
    """Write into ``dry`` the mass properties, without propellant, of the lander and of the parts still
    attached.
    """
    body = body_of(lander)
    if attached[HEAT_SHIELD] != 0:
        body = join(body, part_of(mass.heat_shield))
    if attached[BACKSHELL] != 0:
        body = join(body, part_of(mass.backshell))
    if attached[PARACHUTE] != 0:
        body = join(body, part_of(mass.parachute))
    dry.mass = body[0]
    for k in range(3):
        dry.centre[k] = body[1][k]
    for k in range(6):
        dry.inertia[k] = body[2][k]


@kernel
def with_propellant(dry, load, propellant):
    """Mass properties of ``dry`` with ``propellant`` kg left of the part ``load``; its own inertia shrinks in
    proportion.
    """
    body = body_of(dry)
    if propellant <= 0.0:
        return body
    share = propellant / load.mass
    c, i = load.centre, load.inertia
    tank = (propellant, (c[0], c[1], c[2]), (i[0] * share, i[1] * share, i[2] * share, 0.0, 0.0, 0.0))
    return join(body, tank)
