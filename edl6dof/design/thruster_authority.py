"""Control authority of the thrusters: the largest torques and forces that each group can give.

The effectiveness matrix B holds force and torque (about the centre of mass) of each thruster at full thrust.
The largest component j of B u over duties 0 <= u <= 1 with no unwanted components is a linear program.
Source: attainable moment sets, Durham 1993, "Constrained control allocation", JGCD 16(4).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.optimize import linprog

from edl6dof.interface.effectors import THRUSTER_GROUPS
from edl6dof.vehicle.mass import Part, loaded
from edl6dof.vehicle.propulsion.rcs import Thruster
from edl6dof.vehicle.vehicle import VehicleParams

#: Components of force and torque: x, y, z of each.
FORCES, TORQUES = (0, 1, 2), (3, 4, 5)
#: Share of the largest force, or torque, below which an entry of the matrix is a rounding error; and share of
#: the sum below which a result is the solver's tolerance.
_ROUNDING, _TOLERANCE = 1e-9, 1e-6


class Authority(NamedTuple):
    """Largest force x, y, z (N) and torque x, y, z (N m) in axes of B, shapes (6, 2): along - and along +.

    Attributes:
        pure: a torque while the other two torques are zero and the force is free; a force without torque and
            without the other two forces.
        total: sum of all thrusters that push this way, whatever else they do.
    """

    pure: np.ndarray
    total: np.ndarray


class Configuration(NamedTuple):
    """A state of the vehicle, its centre of mass (m in B, tanks full), and the authority of each thruster
    group about it.  Groups without thrusters are left out; ``all`` stands for several.
    """

    name: str
    centre_m: np.ndarray
    groups: dict[str, Authority]


def configurations(vehicle: VehicleParams) -> list[Configuration]:
    """Return the authority at entry and, if there is an aeroshell, after it and the parachutes are gone."""
    attached = {"at entry": tuple(vehicle.parts)}
    covers = [k for k, part in enumerate(vehicle.parts) if part.shape != "none"]
    if covers:
        attached["without aeroshell"] = _inside(vehicle, vehicle.parts[covers[-1] + 1 :])
    found = []
    for name, parts in attached.items():
        _, centre, _ = loaded(vehicle.mass, tuple(vehicle.parts), tuple(vehicle.tanks), parts)
        groups = {group: authority(effectiveness(jets, centre)) for group, jets in groups_of(vehicle).items()}
        found.append(Configuration(name, centre, groups))
    return found


def _inside(vehicle: VehicleParams, parts: Sequence[Part]) -> tuple[Part, ...]:
    packs = {chute.pack for chute in vehicle.parachutes}
    return tuple(part for part in parts if part.name not in packs)


def groups_of(vehicle: VehicleParams) -> dict[str, list[Thruster]]:
    """Return the thrusters of each group that has some, and of ``all`` if there are several groups."""
    jets = vehicle.rcs.thrusters
    found = {group: [jet for jet in jets if jet.group == group] for group in THRUSTER_GROUPS}
    found = {group: members for group, members in found.items() if members}
    return found | ({"all": list(jets)} if len(found) > 1 else {})


def effectiveness(thrusters: Sequence[Thruster], centre_m: np.ndarray) -> np.ndarray:
    """Return force (N) and torque (N m) about a centre of each thruster at its nominal thrust, axes of B,
    shape (n, 6); :func:`edl6dof.fsw.allocation.effectiveness.effectiveness_matrix` is the flight software's.
    """
    force = np.array([np.multiply(jet.thrust_n, jet.direction) for jet in thrusters])
    arm = np.array([jet.position_m for jet in thrusters]) - centre_m
    return np.hstack([force, np.cross(arm, force)])


def authority(matrix: np.ndarray) -> Authority:
    """Return the authority of thrusters with an effectiveness matrix, shape (n, 6)."""
    largest_entries = np.repeat([np.abs(matrix[:, :3]).max(), np.abs(matrix[:, 3:]).max()], 3)
    matrix = np.where(np.abs(matrix) > _ROUNDING * largest_entries, matrix, 0.0)
    pure, total = np.zeros((6, 2)), np.zeros((6, 2))
    for row in range(6):
        unwanted = [k for k in (*FORCES, *TORQUES) if k != row and (k in TORQUES or row in FORCES)]
        for side, sign in enumerate((-1.0, 1.0)):
            wanted = sign * matrix[:, row]
            pure[row, side] = sign * largest(wanted, matrix[:, unwanted].T)
            total[row, side] = sign * np.maximum(wanted, 0.0).sum()
    floor = _TOLERANCE * np.abs(total).max(axis=1, keepdims=True)
    return Authority(*(np.where(np.abs(one) > floor, one, 0.0) for one in (pure, total)))


def largest(wanted: np.ndarray, unwanted: np.ndarray) -> float:
    """Return the largest ``wanted @ u`` over duties 0 <= u <= 1 with ``unwanted @ u = 0``; rows of
    ``unwanted`` are scaled to one, so that the solver's tolerance is a share of a thruster.
    """
    scale = np.abs(unwanted).max(axis=1, keepdims=True)
    rows = (unwanted / np.where(scale > 0.0, scale, 1.0))[scale[:, 0] > 0.0]
    unit = float(np.abs(wanted).max())
    if unit == 0.0:
        return 0.0
    found = linprog(-wanted / unit, A_eq=rows, b_eq=np.zeros(len(rows)), bounds=(0.0, 1.0), method="highs")
    return -unit * float(found.fun)
