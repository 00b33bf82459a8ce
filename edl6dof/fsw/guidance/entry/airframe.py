"""The trim angle, drag and lift that the flight computer expects of its vehicle, over Mach number.

One drag area and one lift-to-drag ratio (``onboard.vehicle``) times factors tabulated over the logarithm of
the Mach number. Below the Mach number or speed at which the mission table opens the trim wing, or releases
the balance masses, the vehicle trims at zero angle of attack: no lift, and the drag of that attitude. Without
a table the factors are one. Source: the nominal aerodynamic database, trimmed on the ground
(:mod:`edl6dof.scenario.onboard_vehicle`).
"""

from __future__ import annotations

import numpy as np

from edl6dof.kernels import kernel
from edl6dof.records import record
from edl6dof.spatial import arrays
from edl6dof.spatial.elementary import log
from edl6dof.spatial.table_index import between, held_cell

NODES = 64
FIRST_MACH, LAST_MACH = 0.5, 30.0
SPACING = log(LAST_MACH / FIRST_MACH) / (NODES - 1)

AIRFRAME = record(
    ("wing_mach", "f8"),  # Mach number at which the trim wing opens; 0: never, or by speed
    ("wing_speed", "f8"),  # m/s: speed at which the trim wing opens; 0: never, or by Mach number
    ("alpha", "f8", (NODES,)),  # rad: angle of attack at trim
    ("drag", "f8", (NODES,)),  # drag area at trim, over that of the vehicle
    ("lift", "f8", (NODES,)),  # lift-to-drag ratio at trim, over that of the vehicle
    ("drag_with_wing", "f8", (NODES,)),  # drag area, wing open and alpha zero, over that of the vehicle
    # forces along z over x, zero without a table of coefficients: over tan(alpha) at trim
    ("side", "f8", (NODES,)),
    ("side_with_wing", "f8", (NODES,)),  # the same about alpha zero, wing open
    ("offset_with_wing", "f8", (NODES,)),  # forces along z over x at alpha zero, wing open
)


def mach_nodes() -> np.ndarray:
    """Mach numbers of the table, shape (NODES,)."""
    return FIRST_MACH * arrays.exp(SPACING * np.arange(NODES))


@kernel
def node_of(mach):
    """Index of the node below a Mach number, and fraction of the way to the next."""
    return held_cell(log(max(mach, FIRST_MACH) / FIRST_MACH) / SPACING, NODES - 1)


@kernel
def trim_alpha(vehicle, mach):
    """Angle of attack (rad) at which the ``onboard.vehicle`` trims with its wing in."""
    i, f = node_of(mach)
    return between(vehicle.airframe.alpha, i, f)


@kernel
def believed_aero(vehicle, mach, speed):
    """Drag area (m2) and lift-to-drag ratio of the ``onboard.vehicle`` at trim; ``speed`` in m/s."""
    table = vehicle.airframe
    i, f = node_of(mach)
    if mach < table.wing_mach or speed < table.wing_speed:
        return vehicle.drag_area * between(table.drag_with_wing, i, f), 0.0
    return vehicle.drag_area * between(table.drag, i, f), vehicle.lift_to_drag * between(table.lift, i, f)


@kernel
def side_force(vehicle, mach, wing_open):
    """Slope and offset of the ratio of the forces along z and x over the tangent of the angle of attack."""
    table = vehicle.airframe
    i, f = node_of(mach)
    if wing_open != 0:
        return between(table.side_with_wing, i, f), between(table.offset_with_wing, i, f)
    return between(table.side, i, f), 0.0


@kernel
def area_rate(vehicle, mach, speed, speed_rate):
    """Relative rate (1/s) of the trimmed drag area at ``speed`` (m/s) and ``speed_rate`` (m/s2), with
    constant speed of sound.
    """
    drag = vehicle.airframe.drag
    i, _ = node_of(mach)
    return log(drag[i + 1] / drag[i]) / SPACING * speed_rate / speed
