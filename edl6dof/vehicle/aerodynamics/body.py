"""A body of any shape: six coefficients over Mach number, angle of attack and sideslip, and nine damping
coefficients over the first two.

The table comes from a mesh, a csv or DAVE-ML files (:mod:`edl6dof.vehicle.aerodynamics.body_table`).
"""

from __future__ import annotations

from edl6dof.config.base import Hardware, Vec3, param
from edl6dof.kernels import kernel
from edl6dof.records import record
from edl6dof.spatial.elementary import asin, atan2
from edl6dof.spatial.table_index import cell_among
from edl6dof.spatial.vector import clamp, norm
from edl6dof.vehicle.aerodynamics.capsule import MIN_SPEED, free_molecular_weight

MACH_NODES, ALPHA_NODES, BETA_NODES = 64, 96, 96
#: Largest size of the table: Mach numbers x angles of attack x angles of sideslip.
NODES = 60_000

#: ``sheds``: 1 if the body flies only while a part with the shape of a capsule is attached.  Nodes rise;
#: angles in rad.  ``static`` [node, (CX, CY, CZ, Cl, Cm, Cn)] and ``rare``, in free molecular flow,
#: by :func:`node`; ``damping`` [Mach x alpha, (CYp, Clp, Cnp, CXq, CZq, Cmq, CYr, Clr, Cnr)] per rad of
#: p b/2V, q c/2V and r b/2V.
BODY_TABLE = record(
    ("n_mach", "i8"),
    ("n_alpha", "i8"),
    ("n_beta", "i8"),
    ("rarefied", "i8"),
    ("sheds", "i8"),
    ("mach", "f8", (MACH_NODES,)),
    ("alpha", "f8", (ALPHA_NODES,)),
    ("beta", "f8", (BETA_NODES,)),
    ("static", "f8", (NODES, 6)),
    ("rare", "f8", (ALPHA_NODES * BETA_NODES, 6)),
    ("damping", "f8", (MACH_NODES * ALPHA_NODES, 9)),
)


class BodyAeroParams(Hardware):
    """Body of any shape, by the file of its coefficients: a mesh, a table, or a DAVE-ML model."""

    file: str = param(
        "",
        "mesh (.stl, .glb, .gltf), whose coefficients are those of Newtonian flow, table (.csv) or DAVE-ML "
        "model (.dml), relative to the file that names it",
        record=False,
    )
    inputs: dict[str, float] = param(
        None,
        "inputs of a DAVE-ML model other than the flow, such as deflections: values by name, in its units",
        record=False,
        factory=dict,
    )
    mesh_scale: float = param(1.0, "metres per unit of a mesh", record=False, gt=0.0, le=1e4)
    mesh_origin_m: Vec3 = param((0.0, 0.0, 0.0), "position in B of the origin of the mesh", record=False)
    mesh_yaw_pitch_roll_deg: Vec3 = param(
        (0.0, 0.0, 0.0), "turns about z, y, x that carry B into the axes of a mesh", record=False
    )
    reference_area_m2: float = param(1.0, "reference area", gt=0.0)
    chord_m: float = param(1.0, "reference length of pitch, and of the Knudsen number", gt=0.0)
    span_m: float = param(1.0, "reference length of roll and yaw", gt=0.0)
    moment_reference_m: Vec3 = param((0.0, 0.0, 0.0), "point in B that the moments are about")
    roll_damping: float = param(0.0, "Clp per rad of p span/2V, added to that of the file")
    pitch_damping: float = param(0.0, "Cmq per rad of q chord/2V, added to that of the file")
    yaw_damping: float = param(0.0, "Cnr per rad of r span/2V, added to that of the file")
    axial_factor: float = param(1.0, "multiplies CX", gt=0.0, le=10.0)
    lateral_factor: float = param(1.0, "multiplies CY and CZ", ge=0.0, le=10.0)
    moment_factor: float = param(1.0, "multiplies Cl, Cm and Cn about the reference point", ge=-10.0, le=10.0)
    damping_factor: float = param(1.0, "multiplies all damping", ge=-10.0, le=10.0)


@kernel
def node(table, i, j, k):
    """Index of the row of ``static`` at nodes ``i`` of Mach, ``j`` of alpha, ``k`` of beta; of ``rare`` with
    i = 0.
    """
    return (i * table.n_alpha + j) * table.n_beta + k


@kernel
def _bilinear(rows, table, cells, shares, column):
    """Interpolate a column of ``rows`` at a Mach node bilinearly in both angles."""
    i, j, k = cells
    a, b = shares
    low, high = node(table, i, j, k), node(table, i, j + 1, k)
    near = rows[low, column] + b * (rows[low + 1, column] - rows[low, column])
    far = rows[high, column] + b * (rows[high + 1, column] - rows[high, column])
    return near + a * (far - near)


@kernel
def cell_of(table, mach, alpha, beta):
    """Indices of the cells of Mach number, angle of attack and sideslip (rad), and the share of the way
    across each.
    """
    i, m = cell_among(table.mach, table.n_mach, mach)
    j, a = cell_among(table.alpha, table.n_alpha, alpha)
    k, b = cell_among(table.beta, table.n_beta, beta)
    return (i, j, k), (m, a, b)


@kernel
def body_coefficients(body, table, gas, mach, rho, alpha, beta):
    """(CX, CY, CZ, Cl, Cm, Cn) about the reference point at angles of attack and sideslip (rad), bridged to
    free molecular flow and multiplied by the factors; linear in Mach number and both angles, constant beyond
    the ends of the table.
    """
    cells, shares = cell_of(table, mach, alpha, beta)
    weight = free_molecular_weight(gas, rho, body.chord) if table.rarefied != 0 else 0.0
    return (
        _coefficient(table, cells, shares, weight, 0) * body.axial_factor,
        _coefficient(table, cells, shares, weight, 1) * body.lateral_factor,
        _coefficient(table, cells, shares, weight, 2) * body.lateral_factor,
        _coefficient(table, cells, shares, weight, 3) * body.moment_factor,
        _coefficient(table, cells, shares, weight, 4) * body.moment_factor,
        _coefficient(table, cells, shares, weight, 5) * body.moment_factor,
    )


@kernel
def _coefficient(table, cells, shares, weight, column):
    i, j, k = cells
    m, a, b = shares
    low = _bilinear(table.static, table, cells, (a, b), column)
    value = low + m * (_bilinear(table.static, table, (i + 1, j, k), (a, b), column) - low)
    if weight > 0.0:
        value += weight * (_bilinear(table.rare, table, (0, j, k), (a, b), column) - value)
    return value


@kernel
def _damping(table, cells, shares, column):
    """Interpolate a damping coefficient bilinearly in Mach number and angle of attack."""
    i, j, _ = cells
    m, a, _ = shares
    low, high = i * table.n_alpha + j, (i + 1) * table.n_alpha + j
    slow = table.damping[low, column] + a * (table.damping[low + 1, column] - table.damping[low, column])
    fast = table.damping[high, column] + a * (table.damping[high + 1, column] - table.damping[high, column])
    return slow + m * (fast - slow)


@kernel
def body_aero(aero, table, air, v_air, rate):
    """Force and moment in `B`, moment about (body.moment_reference_x, 0, 0), of a body of any shape.

    alpha = atan2(w, u), beta = asin(v/V); F = qbar S C, M = qbar S (b Cl, c Cm, b Cn), rates relative to the
    air.  Source: definition of the coefficients, ANSI/AIAA R-004.
    """
    body = aero.body
    gas, qbar, mach, rho = air
    u, v, w = v_air
    p, q, r = rate
    speed = norm(v_air)
    if speed < MIN_SPEED:
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    alpha, beta = atan2(w, u), asin(clamp(v / speed, -1.0, 1.0))
    cx, cy, cz, cl, cm, cn = body_coefficients(body, table, gas, mach, rho, alpha=alpha, beta=beta)
    cells, shares = cell_of(table, mach, alpha, beta)
    share = 0.5 * body.damping_factor / speed
    roll, pitch, yaw = share * p * body.span, share * q * body.chord, share * r * body.span
    cx += pitch * _damping(table, cells, shares, 3)
    cy += roll * _damping(table, cells, shares, 0) + yaw * _damping(table, cells, shares, 6)
    cz += pitch * _damping(table, cells, shares, 4)
    cl += roll * (body.roll_damping + _damping(table, cells, shares, 1)) + yaw * _damping(
        table, cells, shares, 7
    )
    cm += pitch * (body.pitch_damping + _damping(table, cells, shares, 5))
    cn += roll * _damping(table, cells, shares, 2) + yaw * (
        body.yaw_damping + _damping(table, cells, shares, 8)
    )
    force = qbar * body.reference_area
    fx, fy, fz = force * cx, force * cy, force * cz
    y, z = body.moment_reference[1], body.moment_reference[2]
    return (
        fx, fy, fz,
        force * body.span * cl + y * fz - z * fy,
        force * body.chord * cm + z * fx,
        force * body.span * cn - y * fx,
    )  # fmt: skip
