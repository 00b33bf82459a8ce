"""The sphere-cone entry capsule: its parameters, and its coefficients and force in flight."""

from __future__ import annotations

from math import pi, sqrt
from typing import Literal, Self

from pydantic import model_validator

from edl6dof.config.base import Hardware, param
from edl6dof.environment.gas import inverse_knudsen_number
from edl6dof.kernels import inlined_kernel, kernel
from edl6dof.spatial.elementary import atan2, log10, sin
from edl6dof.spatial.table_index import cell, cell_among

PHOENIX = "Edquist, Desai & Schoenenberger, AIAA 2008-7219"
DAMPING = "tianwen1.md 1.3, shaped on MER/Phoenix ballistic-range practice (Schoenenberger 2005)"

DEG_PER_RAD = 180.0 / pi
#: Speed relative to the air (m/s) below which a body has no aerodynamic force.
MIN_SPEED = 1e-9


class CapsuleParams(Hardware):
    """Sphere-cone capsule: static table, shape for angles beyond it, damping, uncertainty multipliers."""

    coefficients: Literal["table", "newtonian"] = param(
        "table",
        "the static table, with Newtonian flow beyond its angles, or modified Newtonian flow and base "
        "pressure of the shape alone",
        record=False,
    )
    static_table: str = param(
        "phoenix_70deg_static_aero.csv",
        "csv of CD, CL, Cm over Mach and alpha: a name in edl6dof/data/aerodynamics, or a path",
        status="published", source=PHOENIX, record=False,
    )  # fmt: skip
    moment_reference_x_over_d: float = param(
        -0.253, "station of the table's moment reference / diameter, negative aft of the nose",
        status="published",
        source=PHOENIX, record=False, le=0.0, ge=-2.0,
    )  # fmt: skip
    diameter_m: float = param(
        3.4, "largest diameter; reference length", status="published", source="S&T Daily 2021", gt=0.0
    )
    nose_radius_m: float = param(
        0.85,
        "radius of the spherical nose",
        status="estimate",
        source="D/4, Viking family",
        gt=0.0,
        record=False,
    )
    shoulder_radius_m: float = param(
        0.085, "radius of the shoulder", status="estimate", source="D/40, as Phoenix", ge=0.0, record=False
    )
    cone_half_angle_deg: float = param(
        70.0, "half angle of the forebody cone", status="published",
        source="Li, Rao et al., Astrodynamics 6(1), 2022", gt=10.0,
        lt=90.0, record=False,
    )  # fmt: skip
    forebody_break_radius_m: float | None = param(
        None, "radius where the second cone of a biconic forebody begins", record=False, gt=0.0
    )
    forebody_second_cone_angle_deg: float | None = param(
        None, "half angle of the second cone of a biconic forebody", record=False, gt=0.0, lt=90.0
    )
    backshell_cone_angle_deg: float = param(
        30.0, "half angle of the first backshell cone", status="estimate",
        source="total height about 2.6 m", gt=0.0, lt=90.0,
        record=False,
    )  # fmt: skip
    backshell_break_radius_m: float = param(
        1.0,
        "radius where the second backshell cone begins",
        status="estimate",
        source="height about 2.6 m",
        gt=0.0,
        record=False,
    )
    backshell_second_cone_angle_deg: float = param(
        40.0, "half angle of the second backshell cone", status="estimate",
        source="total height about 2.6 m", gt=0.0, lt=90.0,
        record=False,
    )  # fmt: skip
    backshell_base_radius_m: float = param(
        0.45,
        "radius of the flat lid of the backshell",
        status="estimate",
        source="parachute volume",
        gt=0.0,
        record=False,
    )
    axial_factor: float = param(1.0, "multiplies CA", gt=0.0, le=10.0)
    normal_factor: float = param(1.0, "multiplies CN", ge=0.0, le=10.0)
    moment_factor: float = param(1.0, "multiplies Cm about the table's reference point", ge=-10.0, le=10.0)
    moment_bias: float = param(
        0.0, "pitching moment coefficient of an asymmetry, fixed in the body", ge=-1.0, le=1.0
    )
    damping_factor: float = param(1.0, "multiplies the damping coefficients", ge=-10.0, le=10.0)
    damping_mach: list[float] = param(
        ..., "Mach numbers of the damping table, ascending, clamped outside", status="estimate",
        source=DAMPING, record=False,
        factory=lambda: [0.8, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 6.0], min_length=1, max_length=12,
    )  # fmt: skip
    damping_angle_deg: list[float] = param(
        ..., "total angles of the damping table, ascending whole degrees, clamped outside",
        status="estimate", source=DAMPING,
        record=False, factory=lambda: [2.0, 5.0, 10.0], min_length=1,
    )  # fmt: skip
    damping_table: list[list[float]] = param(
        ..., "Cmq + Cm_alphadot per rad of rate D/2V; one row per angle, one column per Mach",
        status="estimate", source=DAMPING,
        record=False,
        factory=lambda: [
            [-0.10, 0.15, 0.35, 0.30, 0.20, 0.10, 0.00, -0.10],
            [-0.15, 0.00, 0.10, 0.10, 0.05, 0.00, -0.05, -0.10],
            [-0.20, -0.20, -0.20, -0.20, -0.20, -0.20, -0.15, -0.12],
        ],
    )  # fmt: skip

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        radius = 0.5 * self.diameter_m
        if not self.backshell_base_radius_m < self.backshell_break_radius_m < radius - self.shoulder_radius_m:
            raise ValueError("the backshell radii must decrease: diameter/2 - shoulder > break > base")
        if self.nose_radius_m >= radius or self.shoulder_radius_m >= 0.5 * radius:
            raise ValueError("nose radius must be below diameter/2 and shoulder radius below diameter/4")
        given = (self.forebody_break_radius_m, self.forebody_second_cone_angle_deg)
        if (given[0] is None) != (given[1] is None):
            raise ValueError(
                "a biconic forebody needs both forebody_break_radius_m and forebody_second_cone_angle_deg"
            )
        if any(
            b <= a
            for grid in (self.damping_mach, self.damping_angle_deg)
            for a, b in zip(grid, grid[1:], strict=False)
        ):
            raise ValueError("damping_mach and damping_angle_deg must ascend")
        if any(angle != round(angle) or not 0.0 <= angle <= 180.0 for angle in self.damping_angle_deg):
            raise ValueError("damping_angle_deg must be whole degrees between 0 and 180")
        rows, columns = len(self.damping_angle_deg), len(self.damping_mach)
        if len(self.damping_table) != rows or any(len(row) != columns for row in self.damping_table):
            raise ValueError(f"damping_table must have {rows} rows of {columns} numbers")
        return self


@kernel
def free_molecular_weight(gas, rho, length):
    """Share of the free-molecular coefficients at density ``rho`` (kg/m3) for a body of a reference
    ``length`` (m): 0 continuum .. 1 free molecular.

    Kn = lambda/length; weight = sin^2(pi/8 (3 + log10 Kn)) for 1e-3 < Kn < 10.
    Source: sine-squared bridging as in Wilmoth, Mitcheltree & Moss, AIAA 97-2510 (recalled).
    """
    inverse_knudsen = inverse_knudsen_number(gas, rho, length)
    if inverse_knudsen >= 1000.0:
        return 0.0
    if inverse_knudsen <= 0.1:
        return 1.0
    s = sin(pi / 8.0 * (3.0 - log10(inverse_knudsen)))
    return s * s


@kernel
def _hermite(grid, i, k, basis):
    return (
        basis[0] * grid[i, k]
        + basis[1] * grid[i + 1, k]
        + basis[2] * grid[i, k + 1]
        + basis[3] * grid[i + 1, k + 1]
    )


@kernel
def capsule_coefficients(capsule, table, gas, mach, rho, angle):
    """(CA, CN, Cm, Cmq) at a total angle (rad, 0..pi), bridged and multiplied by the factors; Cm about the
    table's reference.  Cubic Hermite in angle (C1), linear in Mach (clamped); damping linear in both.
    """
    low, b = cell_among(table.mach, table.n_mach, mach)
    i, t = cell(angle * DEG_PER_RAD, 180)
    # Hermite basis: values at both ends, slopes (stored per degree, the spacing of the grid) at both ends.
    h1 = t * t * (3.0 - 2.0 * t)
    basis = (1.0 - h1, h1, t * (1.0 - t) * (1.0 - t), t * t * (t - 1.0))
    lower, upper, rare = table.continuum[low], table.continuum[low + 1], table.free_molecular
    ca = (1.0 - b) * _hermite(lower, i, 0, basis) + b * _hermite(upper, i, 0, basis)
    cn = (1.0 - b) * _hermite(lower, i, 2, basis) + b * _hermite(upper, i, 2, basis)
    cm = (1.0 - b) * _hermite(lower, i, 4, basis) + b * _hermite(upper, i, 4, basis)
    cmq = (1.0 - t) * ((1.0 - b) * lower[i, 6] + b * upper[i, 6]) + t * (
        (1.0 - b) * lower[i + 1, 6] + b * upper[i + 1, 6]
    )
    weight = free_molecular_weight(gas, rho, capsule.diameter)
    if weight > 0.0:
        ca += weight * (_hermite(rare, i, 0, basis) - ca)
        cn += weight * (_hermite(rare, i, 2, basis) - cn)
        cm += weight * (_hermite(rare, i, 4, basis) - cm)
    return (
        ca * capsule.axial_factor, cn * capsule.normal_factor, cm * capsule.moment_factor,
        cmq * capsule.damping_factor
    )  # fmt: skip


@inlined_kernel
def capsule_aero(aero, table, air, v_air, rate):
    """Force and moment of the capsule in `B`, moment about (table.moment_reference_x, 0, 0).

    Damping, none in roll: qbar A D Cmq (D/2V) (0, q, r), rates relative to the air.  ``moment_bias`` adds
    qbar A D bias to My.
    Source: decomposition by total angle for a body of revolution, :mod:`edl6dof.vehicle.aerodynamics.wrench`.
    """
    capsule = aero.capsule
    gas, qbar, mach, rho = air
    u, v, w = v_air
    lateral = sqrt(v * v + w * w)
    speed = sqrt(u * u + lateral * lateral)
    if speed < MIN_SPEED:
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    ca, cn, cm, cmq = capsule_coefficients(capsule, table, gas, mach, rho, angle=atan2(lateral, u))
    e_y, e_z = 0.0, 0.0
    if lateral > 0.0:
        e_y, e_z = v / lateral, w / lateral
    diameter = capsule.diameter
    force = qbar * 0.25 * pi * diameter * diameter
    moment = force * diameter
    damping = moment * cmq * 0.5 * diameter / speed
    return (
        -force * ca, -force * cn * e_y, -force * cn * e_z,
        0.0, moment * (cm * e_z + capsule.moment_bias) + damping * rate[1],
        -moment * cm * e_y + damping * rate[2],
    )  # fmt: skip
