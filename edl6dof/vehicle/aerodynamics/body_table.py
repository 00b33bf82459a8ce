"""Building of the table of a body of any shape, from a mesh, a csv or a DAVE-ML model.  Plain numpy, at load
time.

The coefficients of a mesh are worked out at all attitudes, every 4.5 degrees: Newtonian pressure on the
windward panels, base pressure on the others, and free-molecular flow in thin air
(:mod:`edl6dof.vehicle.aerodynamics.newtonian`).  Those of a csv or a DAVE-ML model are used as given at all
densities, and are constant beyond the ends of the table.
"""

from __future__ import annotations

from functools import lru_cache
from math import pi
from pathlib import Path
from typing import NamedTuple

import numpy as np

from edl6dof.config.document.regular import read_regular
from edl6dof.interchange.aero_table import read_aero_csv
from edl6dof.interchange.daveml_aero import sampled_model
from edl6dof.interchange.meshes import LARGEST_MESH, read_triangles
from edl6dof.records import require_finite
from edl6dof.spatial import arrays
from edl6dof.vehicle.aerodynamics.body import (
    ALPHA_NODES,
    BETA_NODES,
    BODY_TABLE,
    MACH_NODES,
    NODES,
    BodyAeroParams,
)
from edl6dof.vehicle.aerodynamics.newtonian import (
    Panels,
    References,
    continuum,
    integrals,
    panels_of,
)

#: Nodes of the table of a mesh: Mach numbers, and angles of attack and sideslip (deg).
MESH_MACH = np.array([0.2, 0.5, 0.8, 1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 7.0, 10.0, 15.0, 20.0, 40.0])
MESH_ALPHA, MESH_BETA = np.linspace(-180.0, 180.0, 81), np.linspace(-90.0, 90.0, 41)
#: Parameters that are applied in flight and do not enter the table.
FLOWN = (
    *("reference_area_m2", "chord_m", "span_m"),
    *("roll_damping", "pitch_damping", "yaw_damping"),
    *("axial_factor", "lateral_factor", "moment_factor", "damping_factor"),
)


class BodyInputs(NamedTuple):
    """Inputs of the table: the body, the ratio of specific heats behind the shock, True if the body is shed,
    and the content of its file.
    """

    body: BodyAeroParams
    heat_capacity_ratio: float
    sheds: bool
    content: bytes


class Coefficients(NamedTuple):
    """Nodes (angles in deg) and their coefficients: ``BODY_TABLE`` with an axis for each kind of node."""

    mach: np.ndarray
    alpha_deg: np.ndarray
    beta_deg: np.ndarray
    static: np.ndarray
    damping: np.ndarray | None = None
    rare: np.ndarray | None = None


def body_inputs(body: BodyAeroParams, heat_capacity_ratio: float, sheds: bool) -> BodyInputs:
    """Gather the inputs of the table of a body, in a gas of this ratio of specific heats behind the shock.

    Raises:
        ValueError: no file is named.
        OSError: the file cannot be read.
    """
    if not body.file:
        raise ValueError("required key is missing: the mesh, csv or DAVE-ML file of aero.model body")
    own = {name: BodyAeroParams.model_fields[name].default for name in FLOWN}
    if Path(body.file).suffix.lower() in (".stl", ".glb", ".gltf"):  # these enter a mesh table
        own = {name: value for name, value in own.items() if not name.endswith("_m") and "area" not in name}
    content = read_regular(Path(body.file), LARGEST_MESH)
    return BodyInputs(body.model_copy(update=own), heat_capacity_ratio, sheds, content)


@lru_cache(maxsize=4)
def build_body_table(inputs: BodyInputs) -> np.ndarray:
    """Build the table record, ``BODY_TABLE`` of shape (1,), read-only.

    Raises:
        ValueError, OSError, ConfigError: no table can be built.
    """
    body, path = inputs.body, Path(inputs.body.file)
    kind = path.suffix.lower()
    if kind == ".csv":
        found = of_csv(path, inputs.content)
    elif kind == ".dml":
        found = of_daveml(path, body.inputs)
    else:
        found = of_panels(panels_of(placed_corners(body)), references(body), inputs.heat_capacity_ratio)
    table = np.zeros(1, BODY_TABLE)
    record, shape = table[0], found.static.shape[:3]
    for name, size, most in zip(
        ("mach", "alpha", "beta"), shape, (MACH_NODES, ALPHA_NODES, BETA_NODES), strict=True
    ):
        if size > most:
            raise ValueError(f"{path.name}: {size} nodes of {name}, at most {most}")
    if np.prod(shape) > NODES:
        raise ValueError(f"{path.name}: {np.prod(shape)} points, at most {NODES}")
    record["n_mach"], record["n_alpha"], record["n_beta"] = shape
    record["sheds"] = inputs.sheds
    record["mach"][: shape[0]] = found.mach
    record["alpha"][: shape[1]] = np.radians(found.alpha_deg)
    record["beta"][: shape[2]] = np.radians(found.beta_deg)
    record["static"][: np.prod(shape)] = found.static.reshape(-1, 6)
    if found.damping is not None:
        record["damping"][: shape[0] * shape[1]] = found.damping.reshape(-1, 9)
    if found.rare is not None:
        record["rarefied"] = 1
        record["rare"][: shape[1] * shape[2]] = found.rare.reshape(-1, 6)
    require_finite(table)
    return table


def references(body: BodyAeroParams) -> References:
    """Reference area, lengths and moment point of a body's coefficients."""
    lengths = np.array([body.span_m, body.chord_m, body.span_m])
    return References(body.reference_area_m2, lengths, np.array(body.moment_reference_m))


def placed_corners(body: BodyAeroParams) -> np.ndarray:
    """Corners of the triangles of a body's mesh in B, m."""
    turn = np.eye(3)
    for axis, angle in zip((2, 1, 0), np.radians(body.mesh_yaw_pitch_roll_deg), strict=True):
        c, s = arrays.cos(angle), arrays.sin(angle)
        about = np.eye(3)
        j, k = (axis + 1) % 3, (axis + 2) % 3
        about[j, j], about[j, k], about[k, j], about[k, k] = c, -s, s, c
        turn = arrays.product(turn, about)
    corners = body.mesh_scale * read_triangles(Path(body.file))
    return arrays.product(corners, turn.T) + np.array(body.mesh_origin_m)


def directions_of(alpha: np.ndarray, beta: np.ndarray) -> np.ndarray:
    """Unit vectors of the velocity in B at angles of attack and sideslip, rad; shapes broadcast."""
    alpha, beta = np.broadcast_arrays(alpha, beta)
    return np.stack(
        (arrays.cos(alpha) * arrays.cos(beta), arrays.sin(beta), arrays.sin(alpha) * arrays.cos(beta)),
        axis=-1,
    )


def of_panels(panels: Panels, to: References, heat_capacity_ratio: float) -> Coefficients:
    """Coefficients of a mesh at all attitudes."""
    found = [
        integrals(panels, directions_of(np.radians(alpha), np.radians(MESH_BETA)), to) for alpha in MESH_ALPHA
    ]
    newton, wet, rare = (np.stack(parts) for parts in zip(*found, strict=True))
    static = continuum(newton, wet, MESH_MACH, heat_capacity_ratio)
    return Coefficients(MESH_MACH, MESH_ALPHA, MESH_BETA, static, rare=rare)


def of_csv(path: Path, content: bytes) -> Coefficients:
    """Coefficients of a csv file; one without sideslip is of a body of revolution, by total angle of attack.

    Raises:
        ValueError: the file is no table of coefficients.
    """
    table = read_aero_csv(path, content)
    if table.has_beta:
        if len(table.beta_deg) < 2:
            raise ValueError(f"{path}: needs at least two angles of sideslip, or no column beta_deg")
        sign = np.array([-1.0, 1.0, -1.0, 1.0, 1.0, 1.0])
        return Coefficients(table.mach, table.alpha_deg, table.beta_deg, sign * table.values)
    if table.alpha_deg[0] != 0.0 or table.alpha_deg[-1] > 180.0:
        raise ValueError(
            f"{path}: without beta_deg, alpha_deg is the total angle of a body of revolution: it begins at 0 "
            f"and ends at 180 at most (got {table.alpha_deg[0]:g} to {table.alpha_deg[-1]:g})"
        )
    static = _revolved(table.mach, table.alpha_deg, table.values[:, :, 0])
    return Coefficients(table.mach, MESH_ALPHA, MESH_BETA, static)


def _revolved(mach: np.ndarray, angle_deg: np.ndarray, columns: np.ndarray) -> np.ndarray:
    """CX..Cn at all attitudes of a body of revolution, from (CA, CY, CN, Cl, Cm, Cn) [Mach, total angle]."""
    way = directions_of(np.radians(MESH_ALPHA)[:, None], np.radians(MESH_BETA))
    across = arrays.hypot(way[..., 1], way[..., 2])
    total = np.degrees(arrays.atan2(across, way[..., 0]))
    e_y, e_z = (way[..., k] / np.where(across > 0.0, across, 1.0) for k in (1, 2))
    if len(mach) * total.size > NODES:
        raise ValueError(f"{len(mach)} Mach numbers; at most {NODES // total.size} of a body of revolution")
    static = np.zeros((len(mach), *total.shape, 6))
    for row, values in zip(static, columns, strict=True):
        axial, normal, pitching = (arrays.interpolate(total, angle_deg, values[:, k]) for k in (0, 2, 4))
        row[..., 0], row[..., 1], row[..., 2] = -axial, -normal * e_y, -normal * e_z
        row[..., 4], row[..., 5] = pitching * e_z, -pitching * e_y
    return static


def of_daveml(path: Path, inputs: dict[str, float]) -> Coefficients:
    """Coefficients of a DAVE-ML model; ``inputs``: values of its inputs other than the flow, by name.

    Raises:
        ConfigError: the model cannot be read, or has an input that is neither flow nor given.
    """
    limits = (MACH_NODES, ALPHA_NODES, BETA_NODES)
    sampled = sampled_model(path, inputs, limits, NODES)
    alpha, beta = (180.0 / pi * nodes for nodes in (sampled.alpha, sampled.beta))
    return Coefficients(sampled.mach, alpha, beta, sampled.static, sampled.damping)
