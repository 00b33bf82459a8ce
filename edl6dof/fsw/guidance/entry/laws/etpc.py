"""Entry terminal point control: linear range control about a reference trajectory, the law of Apollo's final
phase and of MSL.

Range to go R_p is predicted from the reference, and from the deviations of measured drag D and altitude rate
h' from the reference at the same speed times their influence coefficients; the vertical lift-to-drag ratio is
changed by the predicted miss R - R_p over its own influence coefficient, times an overcontrol gain K:

    R_p = R_ref + dR/dD (D - D_ref) + dR/dh' (h' - h'_ref),    (L/D)_v = (L/D)_v,ref + K (R - R_p) /
    (dR/d(L/D)_v)

The influence coefficients are the adjoint variables of the linearised motion, integrated backwards along the
reference from the final speed, where they are zero. Speed is the independent variable: the coefficients apply
to deviations at equal speed, the bank profile of the reference stays a function of speed, and the range is
that at the final speed, as the parachute opens by speed, not at an altitude:

    x = (h, gamma), x' = f(x, V), s' = g(x, V), H = l' f + g:
    dl/dV = -dH/dx, dm/dV = -dH/du, l(V_f) = m(V_f) = 0

with the adjoints l and m, and u the vertical lift-to-drag ratio where range is controlled. At equal speed a
change of altitude is a change of drag, dD = -D dh / h_s, and a change of flight-path angle one of altitude
rate, d(h') = V cos(gamma) d(gamma), so that the coefficients apply to measured quantities.

Source: Carman, Ives & Geller 1998, "Apollo-derived Mars precision lander guidance", AIAA 98-4570; Mendeck &
Carman 2002, "Guidance design for Mars smart landers using the entry terminal point controller", AIAA
2002-4502; flown: Mendeck & Craig McGrew 2014, "Entry guidance design and postflight performance for 2011 Mars
Science Laboratory mission"; adjoint equations: Bryson & Ho 1975, section 2.3.

Difference: the partial derivatives are central differences of the believed motion, which include the
Mach-dependent airframe and the trim wing.
"""

from __future__ import annotations

import numpy as np

from edl6dof.config.base import Params, param
from edl6dof.fsw.guidance.entry.airframe import believed_aero
from edl6dof.fsw.guidance.entry.reference import point_mass, reference_bank
from edl6dof.fsw.navigation.derived import model_atmosphere
from edl6dof.kernels import kernel
from edl6dof.records import record
from edl6dof.registry import Member
from edl6dof.spatial import arrays
from edl6dof.spatial.elementary import acos, cos, sin
from edl6dof.spatial.table_index import between, held_cell
from edl6dof.spatial.vector import clamp

NODES = 64
#: Steps of the adjoint integration between two nodes.
SUBSTEPS = 8
#: Deceleration (m/s2) from which the speed of the reference falls fast enough to be its independent variable.
LEAST_DECELERATION = 0.5
#: Half the steps of the central differences: altitude (m), flight-path angle (rad), vertical lift-to-drag
#: ratio.
D_ALTITUDE, D_PATH, D_LIFT = 50.0, 1e-5, 1e-4

INFLUENCE = record(
    ("first", "f8"),  # speed of the first node, m/s
    ("spacing", "f8"),
    ("range", "f8", (NODES,)),  # range to go, m
    ("drag", "f8", (NODES,)),
    ("climb", "f8", (NODES,)),  # altitude rate, m/s
    ("lift", "f8", (NODES,)),  # vertical lift-to-drag ratio
    ("by_drag", "f8", (NODES,)),  # d range / d drag, s2
    ("by_climb", "f8", (NODES,)),  # d range / d altitude rate, s
    ("by_lift", "f8", (NODES,)),  # m: d range / d vertical lift-to-drag ratio, changed up to the end
)


@kernel
def hamiltonian(onboard, shift, state, more_lift, adjoints):
    """Hamiltonian of the motion, with speed as independent variable, along the reference bank profile;
    ``more_lift`` is added to the vertical L/D where range is controlled.

    Args:
        onboard: ``ONBOARD`` record.
        shift: shift of the cosine of the reference bank angle.
        state: speed (m/s), altitude (m) and flight-path angle (rad).
        more_lift: added vertical lift-to-drag ratio.
        adjoints: derivatives of the range by altitude (m/m) and path angle (m/rad).
    """
    entry = onboard.guidance.entry
    v, h, gamma = state
    climb, slowing, turn, ground, drag = point_mass(onboard, h, v, gamma, reference_bank(onboard, shift, v))
    if v > max(entry.align_speed, entry.heading.speed):
        turn += more_lift * drag / v
    return (adjoints[0] * climb + adjoints[1] * turn + ground) / slowing


@kernel
def adjoint_rates(onboard, shift, state, adjoints):
    """Derivatives by speed of the adjoints: of the derivatives of the range by altitude, path angle and
    vertical L/D.
    """
    v, h, gamma = state
    up = hamiltonian(onboard, shift, (v, h + D_ALTITUDE, gamma), 0.0, adjoints)
    down = hamiltonian(onboard, shift, (v, h - D_ALTITUDE, gamma), 0.0, adjoints)
    level = hamiltonian(onboard, shift, (v, h, gamma + D_PATH), 0.0, adjoints)
    steep = hamiltonian(onboard, shift, (v, h, gamma - D_PATH), 0.0, adjoints)
    more = hamiltonian(onboard, shift, state, D_LIFT, adjoints)
    less = hamiltonian(onboard, shift, state, -D_LIFT, adjoints)
    return (down - up) / (2 * D_ALTITUDE), (steep - level) / (2 * D_PATH), (less - more) / (2 * D_LIFT)


@kernel
def integrate_adjoints(onboard, shift, speeds, altitude, path, found):
    """Integrate the adjoint equations from the final speed up to the first, by the classical Runge-Kutta
    method.

    Args:
        onboard: ``ONBOARD`` record.
        shift: shift of the cosine of the reference bank angle.
        speeds: from the final speed upwards in even steps, m/s; each ``2 SUBSTEPS``-th is a node.
        altitude, path: altitude (m) and flight-path angle (rad) of the reference at these speeds.
        found: written, a row for each node: derivatives of the range to go by altitude (m/m), path angle
            (m/rad) and vertical lift-to-drag ratio (m) at equal speed.
    """
    x, y, z = 0.0, 0.0, 0.0
    step = 2.0 * (speeds[1] - speeds[0])
    for node in range(NODES):
        found[node, 0], found[node, 1], found[node, 2] = x, y, z
        if node == NODES - 1:
            break
        for i in range(2 * SUBSTEPS * node, 2 * SUBSTEPS * (node + 1), 2):
            first = speeds[i], altitude[i], path[i]
            middle = speeds[i + 1], altitude[i + 1], path[i + 1]
            last = speeds[i + 2], altitude[i + 2], path[i + 2]
            a = adjoint_rates(onboard, shift, first, (x, y))
            b = adjoint_rates(onboard, shift, middle, (x + 0.5 * step * a[0], y + 0.5 * step * a[1]))
            c = adjoint_rates(onboard, shift, middle, (x + 0.5 * step * b[0], y + 0.5 * step * b[1]))
            d = adjoint_rates(onboard, shift, last, (x + step * c[0], y + step * c[1]))
            x += step * (a[0] + 2.0 * (b[0] + c[0]) + d[0]) / 6.0
            y += step * (a[1] + 2.0 * (b[1] + c[1]) + d[1]) / 6.0
            z += step * (a[2] + 2.0 * (b[2] + c[2]) + d[2]) / 6.0


def fill_influence(onboard: np.ndarray, planned: np.ndarray, table: np.void) -> None:
    """Tabulate the planned reference and its influence coefficients over speed.

    Args:
        onboard: onboard record array of length one, its reference planned.
        planned: rows of the planned entry, ``PLANNED``.
        table: ``INFLUENCE`` record to fill.
    """
    record = onboard[0]
    shift = float(record["reference"]["shift"])
    rows = _slowing(planned, record["planet"])
    speeds = np.linspace(rows["speed"][-1], rows["speed"][0], 2 * SUBSTEPS * (NODES - 1) + 1)
    altitude, path, beyond, drag = (
        arrays.interpolate(speeds, rows["speed"][::-1], rows[name][::-1])
        for name in ("altitude", "path_angle", "beyond", "drag")
    )
    found = np.zeros((NODES, 3))
    integrate_adjoints(record, shift, speeds, altitude, path, found=found)
    table["first"], table["spacing"] = speeds[0], speeds[2 * SUBSTEPS] - speeds[0]
    for i in range(NODES):
        k = 2 * SUBSTEPS * i
        v, h, gamma = speeds[k], altitude[k], path[k]
        bank = reference_bank(record, shift, v)
        _, _, path_rate, _, still_drag = point_mass(record, h, v, gamma, bank)
        without_lift = point_mass(record, h, v, gamma, 0.5 * np.pi)[2]
        _, _, scale_height = model_atmosphere(record["atmosphere"], h)
        table["range"][i], table["drag"][i] = beyond[0] - beyond[k], drag[k]
        table["climb"][i] = v * sin(gamma)
        table["lift"][i] = (path_rate - without_lift) * v / still_drag
        table["by_drag"][i] = -found[i, 0] * scale_height / drag[k]
        table["by_climb"][i] = found[i, 1] / (v * cos(gamma))
        table["by_lift"][i] = found[i, 2]


def _slowing(planned: np.ndarray, planet: np.void) -> np.ndarray:
    """Return the rows of the plan from the first deceleration of ``LEAST_DECELERATION`` on."""
    gravity = planet["mu"] / np.square(planet["equatorial_radius"] + planned["altitude"])
    deceleration = planned["drag"] + gravity * arrays.sin(planned["path_angle"])
    before = deceleration[: np.argmax(deceleration)] < LEAST_DECELERATION
    return planned[np.count_nonzero(before) :]


class EtpcParams(Params):
    """Entry terminal point control."""

    overcontrol: float = param(5.0, "overcontrol gain K", status="recalled", source="Apollo", gt=0.0, le=50.0)
    start_drag_m_s2: float = param(
        2.0, "drag at which range control begins; before, the reference bank is flown", ge=0.0
    )


@kernel
def at_speed(table, speed):
    """Find ``speed`` (m/s) in an ``INFLUENCE`` table; return the index of the node below, and the fraction of
    the way from it to the next node.
    """
    return held_cell((speed - table.first) / max(table.spacing, 1e-9), NODES - 1)


@kernel
def guide(params, plan, onboard, nav, memory, out):
    """Wanted bank angle for the vertical lift-to-drag ratio that removes the predicted miss."""
    p, table = params, plan
    i, f = at_speed(table, nav.speed)
    out.reference_drag = between(table.drag, i, f)
    by_lift = between(table.by_lift, i, f)
    if nav.drag < p.start_drag or by_lift < 1.0:
        return reference_bank(onboard, onboard.reference.shift, nav.speed)
    climb = nav.speed * sin(nav.flight_path_angle)
    predicted = between(table.range, i, f) + between(table.by_drag, i, f) * (nav.drag - out.reference_drag)
    predicted += between(table.by_climb, i, f) * (climb - between(table.climb, i, f))
    wanted = between(table.lift, i, f) + p.overcontrol * (out.range_to_go - predicted) / by_lift
    _, lift_to_drag = believed_aero(onboard.vehicle, nav.mach, nav.speed)
    return acos(clamp(wanted / max(lift_to_drag * out.lift_ratio, 1e-3), -1.0, 1.0))


def lay_plan(onboard: np.ndarray, planned: np.ndarray) -> None:
    """Tabulate the influence coefficients of the planned reference."""
    fill_influence(onboard, planned, onboard["plan"]["etpc"][0])


MEMBER = Member(
    "etpc", EtpcParams, {"guide": guide}, "Carman, Ives & Geller 1998", tables=INFLUENCE, plan=lay_plan
)
