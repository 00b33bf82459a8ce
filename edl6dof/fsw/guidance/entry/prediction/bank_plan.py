"""The bank angle that a prediction flies: one number sets its magnitude, two speeds its reversals.

Magnitude: the open-loop profile of the reference with its cosine shifted, or linear in kinetic energy from
one angle now to another at the end.  Side: the present one, changed at each of the speeds.
Sources: Lu 2014, "Entry guidance: a unified method", section IV.A (linear in energy); Smith 2016, AAS 16-216
(reversals as part of the plan).
"""

from __future__ import annotations

from edl6dof.fsw.guidance.entry.prediction.reference import reference_bank
from edl6dof.kernels import kernel
from edl6dof.spatial.vector import clamp

#: Kinds of plan.
SHIFTED, LINEAR, IN_PLANE, HELD = range(4)


@kernel
def shifted(shift, side, first_turn, second_turn):
    """Reference profile, its cosine shifted by ``shift``; ``side`` is +1 right, -1 left; reversals at two
    speeds (m/s), 0 for none.
    """
    return SHIFTED, shift, 0.0, 0.0, side, first_turn, second_turn


@kernel
def in_plane_shifted(shift, first_turn, second_turn):
    """The same with the sideways lift left out, which the reversals cancel: they pass through lift up and no
    more.
    """
    return IN_PLANE, shift, 0.0, 0.0, 1.0, first_turn, second_turn


@kernel
def linear(bank, last_bank, speed, side, first_turn, second_turn):
    """Linear in kinetic energy from ``bank`` at ``speed`` to ``last_bank`` (rad) at the final speed; the rest
    as in ``shifted``.
    """
    return LINEAR, bank, last_bank, speed, side, first_turn, second_turn


@kernel
def held(bank):
    """One bank angle (rad), its sign included, all the way; the smallest bank magnitude is no limit to it."""
    return HELD, abs(bank), 0.0, 0.0, -1.0 if bank < 0.0 else 1.0, 0.0, 0.0


@kernel
def planned_bank(onboard, plan, speed):
    """Bank angle (rad) that the plan holds at ``speed``, its magnitude within the limits; of a flight in the
    plane positive on the present side.
    """
    entry = onboard.guidance.entry
    kind, first, last, start, side, first_turn, second_turn = plan
    if kind == HELD:
        return side * min(first, entry.bank_max)
    if kind == LINEAR:
        end2 = entry.final_speed * entry.final_speed
        share = clamp((speed * speed - end2) / max(start * start - end2, 1.0), 0.0, 1.0)
        magnitude = last + share * (first - last)
    else:
        magnitude = reference_bank(onboard, first, speed)
    if speed <= first_turn:
        side = -side
    if speed <= second_turn:
        side = -side
    return (-1.0 if side < 0.0 else 1.0) * clamp(magnitude, entry.bank_min, entry.bank_max)


@kernel
def in_plane(plan):
    """Whether the sideways lift is left out."""
    return plan[0] == IN_PLANE


@kernel
def next_corner(onboard, plan, speed):
    """Highest speed (m/s) below ``speed`` at which the bank jumps: a step of the prediction ends there."""
    entry = onboard.guidance.entry
    corner = 0.0
    for other in (plan[5], plan[6], max(entry.align_speed, entry.heading.speed)):
        if corner < other < speed - 1e-3:
            corner = other
    return corner
