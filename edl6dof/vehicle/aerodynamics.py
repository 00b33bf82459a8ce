"""Aerodynamic force and moment of the entry capsule, of what is left after jettisons, and of simple
constant-coefficient bodies.

Every model takes the air-relative velocity (u, v, w) in body axes `B` (x forward through the nose, y right, z
down, m/s), the dynamic pressure ``qbar`` (Pa) and the rates (p, q, r) (rad/s), and returns (Fx, Fy, Fz, Mx,
My, Mz) in `B` (N, N m).  Moments are
about a point on the x axis: ``table.moment_reference_x`` (capsule), ``bluff.centre_of_pressure_x``,
``constant.moment_reference_x``.  The caller adds (r_ref - r_cg) x F; :func:`aerodynamic_wrench` returns the
station as well.

Axisymmetric bodies are described by the total angle aT between velocity and +x, 0..pi, and the direction e =
(0, v, w)/|(v, w)|: F = qbar A (-CA, -CN e_y, -CN e_z), M = qbar A D Cm (0, e_z, -e_y).  CN and Cm vanish with
aT: zero lateral velocity is regular.
"""

from __future__ import annotations

from math import atan2, log10, pi, sin, sqrt
from typing import ClassVar, Literal, Self, get_args

from pydantic import model_validator

from edl6dof.config.base import Hardware, group, param
from edl6dof.config.dtype import dtype_of
from edl6dof.environment.gas import inverse_knudsen_number
from edl6dof.jit import inlined_kernel, kernel
from edl6dof.spatial.lookups import cell, cell_among

PHOENIX = "Edquist, Desai & Schoenenberger, AIAA 2008-7219"
DAMPING = "tianwen1.md 1.3, shaped on MER/Phoenix ballistic-range practice (Schoenenberger 2005)"

MODEL_CAPSULE, MODEL_CONSTANT, MODEL_NONE, MODEL_LIFT_DRAG = range(4)
#: What a part shows to the air: nothing, so that the bare lander flies; the whole capsule, heat shield ahead;
#: the open backshell with the lander inside.
Shape = Literal["none", "capsule", "backshell"]
SHAPES: tuple[Shape, ...] = get_args(Shape)
CONFIG_LANDER, CONFIG_CAPSULE, CONFIG_BACKSHELL = range(len(SHAPES))

DEG_PER_RAD = 180.0 / pi
MIN_SPEED = 1e-9


class CapsuleParams(Hardware):
    """Sphere-cone capsule: static table, shape for angles beyond the table, damping, uncertainty
    multipliers.
    """

    moved: ClassVar = {
        "molecular_diameter_m": "planet.gas.molecular_diameter_m",
        "molecular_mass_kg": "planet.gas.molecular_mass_kg",
    }

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


class ConstantAeroParams(Hardware):
    """Constant drag and rate damping (NASA NESC check cases: sphere, brick, cannonball)."""

    drag_coefficient: float = param(0.0, "CD, force against the velocity", ge=0.0)
    roll_damping: float = param(0.0, "Clp per rad of p span/2V")
    pitch_damping: float = param(0.0, "Cmq per rad of q chord/2V")
    yaw_damping: float = param(0.0, "Cnr per rad of r span/2V")
    reference_area_m2: float = param(1.0, "reference area", gt=0.0)
    span_m: float = param(1.0, "reference length of roll and yaw", gt=0.0)
    chord_m: float = param(1.0, "reference length of pitch", gt=0.0)
    moment_reference_x_m: float = param(
        0.0, "station where the drag acts; the CG for a body without static moment"
    )


class LiftDragParams(Hardware):
    """Constant drag and lift coefficient whatever the attitude: the vehicle of point-mass studies."""

    reference_area_m2: float = param(1.0, "reference area", gt=0.0)
    drag_coefficient: float = param(1.0, "CD, force against the velocity", gt=0.0)
    lift_to_drag: float = param(
        0.0, "L/D; lift stands on the velocity in the plane of x and z of B, towards -z", ge=-5.0, le=5.0
    )


class BluffParams(Hardware):
    """Bluff body after a jettison: CA = CD cos aT and CN = slope sin aT, acting at a centre of pressure on
    the axis.
    """

    reference_area_m2: float = param(
        9.079, "reference area", status="derived", source="pi/4 (3.4 m)^2", gt=0.0
    )
    reference_length_m: float = param(
        3.4, "reference length of the damping", status="published", source="S&T Daily 2021", gt=0.0
    )
    drag_coefficient: float = param(
        1.3, "axial coefficient at aT = 0; its negative at 180 deg", status="estimate", ge=0.0
    )
    normal_slope: float = param(
        0.3,
        "CN = slope sin aT; equal to the drag coefficient it makes the force pure drag",
        status="estimate",
        ge=0.0,
    )
    centre_of_pressure_x_m: float = param(
        -1.4,
        "body station of the centre of pressure; aft of the CG (more negative) is stable",
        status="estimate",
    )
    pitch_damping: float = param(-0.2, "Cmq = Cnr per rad of rate L/2V", status="estimate", le=1.0)


def _backshell() -> BluffParams:
    return BluffParams()


def _lander() -> BluffParams:
    return BluffParams(
        reference_area_m2=5.0,
        reference_length_m=2.5,
        drag_coefficient=1.2,
        normal_slope=1.0,
        centre_of_pressure_x_m=-1.1,
        pitch_damping=-0.2,
    )


class AeroParams(Hardware):
    """Aerodynamics of the vehicle in all its configurations."""

    model: Literal["capsule", "constant", "none", "lift_drag"] = param(
        "capsule", "which aerodynamic model flies"
    )
    capsule: CapsuleParams = group(CapsuleParams, "entry capsule with its heat shield")
    constant: ConstantAeroParams = group(ConstantAeroParams, "constant coefficients")
    lift_drag: LiftDragParams = group(LiftDragParams, "constant drag and lift")
    backshell: BluffParams = param(
        ..., "backshell and lander, heat shield gone", status="estimate", factory=_backshell
    )
    lander: BluffParams = param(..., "bare lander", status="estimate", factory=_lander)


AERO = dtype_of(AeroParams)


@kernel
def free_molecular_weight(capsule, gas, rho):
    """Share of the free-molecular coefficients at density ``rho`` (kg/m3): 0 continuum .. 1 free molecular.

    Kn = lambda/D; weight = sin^2(pi/8 (3 + log10 Kn)) for 1e-3 < Kn < 10.
    Source: sine-squared bridging as in Wilmoth, Mitcheltree & Moss, AIAA 97-2510 (recalled).
    """
    inverse_knudsen = inverse_knudsen_number(gas, rho, capsule.diameter)
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
    table's reference.

    Cubic Hermite in angle (C1), linear in Mach (clamped); damping linear in both.  Source:
    :mod:`edl6dof.vehicle.aerotable`.
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
    weight = free_molecular_weight(capsule, gas, rho)
    if weight > 0.0:
        ca += weight * (_hermite(rare, i, 0, basis) - ca)
        cn += weight * (_hermite(rare, i, 2, basis) - cn)
        cm += weight * (_hermite(rare, i, 4, basis) - cm)
    return (
        ca * capsule.axial_factor, cn * capsule.normal_factor, cm * capsule.moment_factor,
        cmq * capsule.damping_factor
    )  # fmt: skip


@inlined_kernel
def capsule_aero(aero, table, gas, qbar, mach, rho, u, v, w, p, q, r):
    """Force and moment of the capsule in `B`, moment about (table.moment_reference_x, 0, 0).  No roll damping
    (``p`` is unused).

    Damping: qbar A D Cmq (D/2V) (0, q, r), rates relative to the air.  ``moment_bias`` adds qbar A D bias to
    My.
    Source: decomposition by total angle for a body of revolution, module docstring.
    """
    capsule = aero.capsule
    lateral = sqrt(v * v + w * w)
    speed = sqrt(u * u + lateral * lateral)
    if speed < MIN_SPEED:
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    ca, cn, cm, cmq = capsule_coefficients(capsule, table, gas, mach, rho, atan2(lateral, u))
    e_y, e_z = 0.0, 0.0
    if lateral > 0.0:
        e_y, e_z = v / lateral, w / lateral
    diameter = capsule.diameter
    force = qbar * 0.25 * pi * diameter * diameter
    moment = force * diameter
    damping = moment * cmq * 0.5 * diameter / speed
    return (
        -force * ca, -force * cn * e_y, -force * cn * e_z,
        0.0, moment * (cm * e_z + capsule.moment_bias) + damping * q, -moment * cm * e_y + damping * r,
    )  # fmt: skip


@kernel
def bluff_aero(bluff, qbar, u, v, w, p, q, r):
    """Force and moment in `B` of a bluff body, moment (pitch and yaw damping only) about
    (bluff.centre_of_pressure_x, 0, 0).

    CA = CD cos aT, CN = slope sin aT.  Source: engineering estimate, see :class:`BluffParams`.
    """
    speed = sqrt(u * u + v * v + w * w)
    if speed < MIN_SPEED:
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    force = qbar * bluff.reference_area / speed
    damping = force * bluff.pitch_damping * 0.5 * bluff.reference_length * bluff.reference_length
    return (
        -force * bluff.drag_coefficient * u, -force * bluff.normal_slope * v, -force * bluff.normal_slope * w,
        0.0, damping * q, damping * r,
    )  # fmt: skip


@kernel
def constant_aero(aero, qbar, u, v, w, p, q, r):
    """Constant drag against the velocity and rate damping in `B`, moment about (constant.moment_reference_x,
    0, 0).

    L = qbar S b Clp p b/2V, M = qbar S c Cmq q c/2V, N = qbar S b Cnr r b/2V.  Source: NASA/TM-2015-218675,
    cases 3 and 4.
    """
    constant = aero.constant
    speed = sqrt(u * u + v * v + w * w)
    if speed < MIN_SPEED:
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    force = qbar * constant.reference_area / speed
    drag = force * constant.drag_coefficient
    b2, c2 = 0.5 * constant.span**2, 0.5 * constant.chord**2
    return (
        -drag * u, -drag * v, -drag * w,
        force * b2 * constant.roll_damping * p, force * c2 * constant.pitch_damping * q,
        force * b2 * constant.yaw_damping * r,
    )  # fmt: skip


@kernel
def lift_drag_aero(lift_drag, qbar, u, v, w):
    """Force in `B` of constant drag and lift: D against the velocity, L along y_B x velocity.  Source:
    definition of lift and drag.
    """
    speed, plane = sqrt(u * u + v * v + w * w), sqrt(u * u + w * w)
    if plane < MIN_SPEED:
        return 0.0, 0.0, 0.0
    drag = qbar * lift_drag.reference_area * lift_drag.drag_coefficient
    along, across = -drag / speed, drag * lift_drag.lift_to_drag / plane
    return along * u + across * w, along * v, along * w - across * u


@inlined_kernel
def aerodynamic_wrench(aero, table, gas, configuration, qbar, mach, rho, u, v, w, p, q, r):
    """(Fx, Fy, Fz, Mx, My, Mz, x_ref) of whatever flies: the model chosen in ``aero``, the configuration
    (``CONFIG_...``).
    """
    if aero.model == MODEL_NONE:
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    if aero.model == MODEL_CONSTANT:
        fx, fy, fz, mx, my, mz = constant_aero(aero, qbar, u, v, w, p, q, r)
        return fx, fy, fz, mx, my, mz, aero.constant.moment_reference_x
    if aero.model == MODEL_LIFT_DRAG:
        fx, fy, fz = lift_drag_aero(aero.lift_drag, qbar, u, v, w)
        return fx, fy, fz, 0.0, 0.0, 0.0, 0.0
    if configuration == CONFIG_CAPSULE:
        fx, fy, fz, mx, my, mz = capsule_aero(aero, table, gas, qbar, mach, rho, u, v, w, p, q, r)
        return fx, fy, fz, mx, my, mz, table.moment_reference_x
    bluff = aero.backshell if configuration == CONFIG_BACKSHELL else aero.lander
    fx, fy, fz, mx, my, mz = bluff_aero(bluff, qbar, u, v, w, p, q, r)
    return fx, fy, fz, mx, my, mz, bluff.centre_of_pressure_x
