"""Entry terminal point control: linear range control about a reference trajectory, the law of Apollo's final
phase and of MSL.

Range to go is predicted from the reference and the deviations of measured drag and altitude rate from it,
weighed with influence coefficients at the same speed; the vertical lift-to-drag ratio is changed by the
predicted miss over its own coefficient, times an overcontrol gain:

    R_p = R_ref + dR/dD (D - D_ref) + dR/dh' (h' - h'_ref),    (L/D)_v = (L/D)_v,ref + K (R - R_p) /
    (dR/d(L/D)_v)

Source: Carman, Ives & Geller 1998, AIAA 98-4570; Mendeck & Carman 2002, AIAA 2002-4502; flown: Mendeck &
Craig McGrew 2014, "Entry guidance design and postflight performance for 2011 Mars Science Laboratory
mission".  The coefficients: see :mod:`~edl6dof.fsw.guidance.entry.influence`.
"""

from __future__ import annotations

import numpy as np

from edl6dof.config.base import Params, param
from edl6dof.fsw.guidance.entry.airframe import believed_aero
from edl6dof.fsw.guidance.entry.influence import INFLUENCE, NODES, fill_influence
from edl6dof.fsw.guidance.entry.reference import reference_bank
from edl6dof.kernels import kernel
from edl6dof.registry import Member
from edl6dof.spatial.elementary import acos, sin
from edl6dof.spatial.table_index import between, held_cell
from edl6dof.spatial.vector import clamp


class EtpcParams(Params):
    """Entry terminal point control."""

    overcontrol: float = param(5.0, "overcontrol gain K", status="recalled", source="Apollo", gt=0.0, le=50.0)
    start_drag_m_s2: float = param(
        2.0, "drag at which range control begins; before, the reference bank is held", ge=0.0
    )


@kernel
def at_speed(table, speed):
    """Index and fraction of a speed among the nodes of an ``INFLUENCE`` table."""
    return held_cell((speed - table.first) / max(table.spacing, 1e-9), NODES - 1)


@kernel
def guide(params, plan, onboard, nav, memory, out):
    """Wanted bank angle for the vertical lift-to-drag ratio that the predicted miss asks for."""
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
    "etpc",
    EtpcParams,
    {"guide": guide},
    "Carman, Ives & Geller 1998; Mendeck & Carman 2002",
    tables=INFLUENCE,
    plan=lay_plan,
)
