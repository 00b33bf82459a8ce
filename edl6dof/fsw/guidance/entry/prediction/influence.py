"""Influence coefficients: how the range flown to the parachute answers to the state now, along the reference
trajectory.

The onboard reference is flown to its end once more from each of a number of speeds, with altitude,
flight-path angle and vertical lift-to-drag ratio a little up and a little down; the central differences are
the sensitivities that the adjoint equations of Apollo and MSL integrate backwards.  At equal speed a change
of altitude is a change of drag, dD = -D dh / h_s, and a change of flight-path angle one of altitude rate,
d(h') = V cos(gamma) d(gamma), so that the coefficients belong to what is measured.  Source: Carman, Ives &
Geller 1998, "Apollo-derived Mars precision lander guidance", AIAA 98-4570; Mendeck & Carman 2002, "Guidance
design for Mars smart landers using the entry terminal point controller", AIAA 2002-4502, on the controller
gains.

Differences: differences of flown trajectories in place of the adjoint equations, so that the level-wing end
and the trim wing, where the dynamics jump, are in the coefficients; the range counts at the final speed, as
the parachute opens by Mach number, not at an altitude.
"""

from __future__ import annotations

from math import cos, sin

import numpy as np

from edl6dof.fsw.guidance.entry.prediction.reference import point_mass, reference_bank
from edl6dof.fsw.navigation.derived import model_atmosphere
from edl6dof.jit import kernel

NODES = 64
STEP = 0.5  # s
LONGEST = 4000  # steps
#: Half the differences: altitude (m), flight-path angle (rad), vertical lift-to-drag ratio.
D_ALTITUDE, D_PATH, D_LIFT = 100.0, 2e-4, 2e-3

INFLUENCE = np.dtype(
    [
        ("first", "f8"),  # speed of the first node, m/s
        ("spacing", "f8"),
        ("range", "f8", (NODES,)),  # range to go, m
        ("drag", "f8", (NODES,)),
        ("climb", "f8", (NODES,)),  # altitude rate, m/s
        ("lift", "f8", (NODES,)),  # vertical lift-to-drag ratio
        ("by_drag", "f8", (NODES,)),  # d range / d drag, s2
        ("by_climb", "f8", (NODES,)),  # d range / d altitude rate, s
        ("by_lift", "f8", (NODES,)),  # d range / d vertical lift-to-drag ratio, kept to the end, m
    ],
    align=True,
)


@kernel
def rates(onboard, h, v, gamma, shift, more_lift):
    """Rates of altitude, speed, path angle and range on the reference profile with ``more_lift`` added to its
    vertical L/D.
    """
    a = point_mass(onboard, h, v, gamma, reference_bank(onboard, shift, v))
    # below the alignment speed lift is no longer controlled
    more_path_rate = more_lift * a[4] / v if v > onboard.guidance.entry.align_speed else 0.0
    return a[0], a[1], a[2] + more_path_rate, a[3]


@kernel
def range_from(onboard, h, v, gamma, shift, more_lift):
    """Range (m) flown from a state to the final speed; between the last two steps by interpolation."""
    final = onboard.guidance.entry.final_speed
    s = 0.0
    for _ in range(LONGEST):
        if v <= final or h < -5000.0:
            break
        a = rates(onboard, h, v, gamma, shift, more_lift)
        b = rates(
            onboard, h + 0.5 * STEP * a[0], v + 0.5 * STEP * a[1], gamma + 0.5 * STEP * a[2], shift, more_lift
        )
        c = rates(
            onboard, h + 0.5 * STEP * b[0], v + 0.5 * STEP * b[1], gamma + 0.5 * STEP * b[2], shift, more_lift
        )
        d = rates(onboard, h + STEP * c[0], v + STEP * c[1], gamma + STEP * c[2], shift, more_lift)
        change = STEP * (a[1] + 2.0 * (b[1] + c[1]) + d[1]) / 6.0
        part = 1.0 if v + change > final else (final - v) / change
        h += part * STEP * (a[0] + 2.0 * (b[0] + c[0]) + d[0]) / 6.0
        gamma += part * STEP * (a[2] + 2.0 * (b[2] + c[2]) + d[2]) / 6.0
        s += part * STEP * (a[3] + 2.0 * (b[3] + c[3]) + d[3]) / 6.0
        v = final if part < 1.0 else v + change
    return s


@kernel
def coefficients(onboard, h, v, gamma, shift):
    """Derivatives of the range to go by altitude (m/m), path angle (m/rad) and vertical L/D (m) at equal
    speed.
    """
    up, down = (
        range_from(onboard, h + D_ALTITUDE, v, gamma, shift, 0.0),
        range_from(onboard, h - D_ALTITUDE, v, gamma, shift, 0.0),
    )
    steep, level = (
        range_from(onboard, h, v, gamma - D_PATH, shift, 0.0),
        range_from(onboard, h, v, gamma + D_PATH, shift, 0.0),
    )
    more, less = (
        range_from(onboard, h, v, gamma, shift, D_LIFT),
        range_from(onboard, h, v, gamma, shift, -D_LIFT),
    )
    by_altitude, by_path, by_lift = (
        (up - down) / (2 * D_ALTITUDE),
        (level - steep) / (2 * D_PATH),
        (more - less) / (2 * D_LIFT),
    )
    return by_altitude, by_path, by_lift


def fill_influence(onboard: np.ndarray, planned: np.ndarray, table: np.void) -> None:
    """Tabulate the planned reference and its influence coefficients over speed.

    Args:
        onboard: onboard record array of length one, its reference planned.
        planned: rows of the planned entry, ``PLANNED``.
        table: ``INFLUENCE`` record to fill.
    """
    record = onboard[0]
    shift = float(record["reference"]["shift"])
    rows = planned[np.argmax(planned["speed"]) :]  # from where the speed falls
    speeds = np.linspace(float(rows["speed"][-1]), float(rows["speed"][0]), NODES)
    table["first"], table["spacing"] = speeds[0], speeds[1] - speeds[0]

    def at(name: str, v: float) -> float:
        return float(np.interp(v, rows["speed"][::-1], rows[name][::-1]))

    for i, v in enumerate(speeds):
        h, gamma = at("altitude", v), at("path_angle", v)
        bank = reference_bank(record, shift, v)
        _, _, path_rate, _, drag = point_mass(record, h, v, gamma, bank)
        without_lift = point_mass(record, h, v, gamma, 0.5 * np.pi)[2]
        _, _, scale_height = model_atmosphere(record["atmosphere"], h)
        by_altitude, by_path, by_lift = coefficients(record, h, v, gamma, shift)
        table["range"][i] = float(rows["beyond"][-1]) - at("beyond", v)
        table["drag"][i], table["climb"][i] = at("drag", v), v * sin(gamma)
        table["lift"][i] = (path_rate - without_lift) * v / drag
        table["by_drag"][i] = -by_altitude * scale_height / drag
        table["by_climb"][i] = by_path / (v * cos(gamma))
        table["by_lift"][i] = by_lift
