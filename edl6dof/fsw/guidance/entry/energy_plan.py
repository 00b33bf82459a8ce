"""Bank plan linear in energy, with reversals: corrected by prediction and flown, for the laws that plan so.

Every call flies the onboard prediction to the parachute: from the present bank angle, at the bank rate of the
vehicle, through the remaining reversals. The bank magnitude is linear in energy, from an unknown one now to a
fixed one at the end; the unknown is corrected by Gauss-Newton steps, halved until the predicted range
improves. The speed of the next reversal is corrected in the same way until the predicted crossrange is zero;
the reversal after it is assumed at a set share of that speed. Where even the largest bank angle ends beyond
the aim point, the reversal is moved to the speed with the least miss of range and crossrange together:
rolling through lift up adds range, the more the slower the vehicle rolls. Where the smallest bank angle ends
short, smaller ones are allowed (:mod:`~edl6dof.fsw.guidance.entry.reach`). Where load or heat rate would
exceed their limits, vertical lift is added until the altitude rate respects them. Sources: Lu 2014, "Entry
guidance: a unified method", J. Guidance, Control, and Dynamics 37(3), sections IV and V (range, altitude-rate
feedback, filters); Lu, Brunner, Stachowiak, Mendeck, Tigges & Cerimele 2017, "Verification of a fully
numerical entry guidance algorithm", J. Guidance 40(2); Smith 2016, AAS 16-216 (reversals by prediction).
"""

from __future__ import annotations

from math import copysign, sqrt

from edl6dof.config.base import Params, param
from edl6dof.fsw.guidance.entry.aim_point import first_side
from edl6dof.fsw.guidance.entry.predictor import linear, planned_bank, predict
from edl6dof.fsw.guidance.entry.reach import stretched
from edl6dof.fsw.navigation.derived import model_atmosphere
from edl6dof.kernels import kernel
from edl6dof.records import COUNT, FLAG, record
from edl6dof.spatial.elementary import acos, cos, hypot, sin
from edl6dof.spatial.vector import clamp

#: Changes of bank angle (rad) and of reversal speed (m/s) by which slopes are measured.
NUDGE_BANK, NUDGE_TURN = 0.02, 20.0
#: Largest steps of one correction: bank (rad), reversal speed (m/s).
STEP_BANK, STEP_TURN = 0.5, 500.0


class EnergyPlanParams(Params):
    """Plan of a bank angle linear in energy, corrected by prediction."""

    last_bank_deg: float = param(
        60.0, "bank magnitude at the end of the prediction", status="design", ge=0.0, le=180.0
    )
    tolerance_m: float = param(50.0, "predicted miss at which the correction stops", gt=0.0, le=10e3)
    authority_m: float = param(
        200.0,
        "least change of range, from the smallest to the largest bank angle, at which the "
        "bank angle is still corrected",
        status="design",
        ge=0.0,
        le=100e3,
    )
    start_drag_m_s2: float = param(
        0.3, "drag at which correction begins; before, the first plan is flown", ge=0.0
    )
    halvings: int = param(3, "most times that a step is halved in one call", ge=0, le=10)
    limit_time_s: float = param(
        8.0, "time in which load or heat rate may reach its limit", status="design", gt=0.0, le=100.0
    )
    lift_time_s: float = param(
        3.0, "time in which lift corrects too low an altitude rate", status="design", gt=0.0, le=100.0
    )
    reversals: int = param(3, "number of planned reversals", ge=0, le=10)
    spacing: float = param(
        0.55,
        "first guess of the speed of a reversal, divided by that of the reversal before",
        status="design",
        gt=0.0,
        lt=1.0,
    )
    stretch: bool = param(
        True, "whether the bank angle may be below bank_min_deg when range is short", status="design"
    )


ENERGY_PLAN = record(
    ("started", FLAG),
    ("side", "f8"),  # +1 right, -1 left
    ("bank", "f8"),  # rad: unknown bank magnitude now; the excess over the largest is added to the last bank
    ("turn", "f8"),  # speed of the next reversal, m/s; 0 when none is left
    ("later", "f8"),  # m/s: assumed speed of the reversal after it; 0: none
    ("left", COUNT),  # reversals left
    ("lowered", "f8"),  # rad: by which the last bank angle of the plan is lowered
    ("miss", "f8"),  # m: predicted downrange miss
    ("aside", "f8"),  # m: predicted crossrange miss
)


@kernel
def bank_plan(params, onboard, nav, memory, bank, turn):
    """Return the bank plan with the magnitude ``bank`` (rad) now and the next reversal at the speed ``turn``
    (m/s). A magnitude above the largest bank angle is limited to it, and the excess is added to the last bank
    angle of the plan.
    """
    now = min(bank, onboard.guidance.entry.bank_max)
    return linear(
        now,
        last_bank=params.last_bank - memory.lowered + (bank - now),
        speed=nav.speed,
        side=memory.side,
        first_turn=turn,
        second_turn=memory.later,
    )


@kernel
def most_bank(params, memory, entry):
    """Return the bank unknown of the plan (rad) with which the largest bank angle is flown to the end."""
    return entry.bank_max + max(entry.bank_max - (params.last_bank - memory.lowered), 0.0)


@kernel
def ends(params, onboard, nav, memory, out, bank, turn):
    """Predicted downrange and crossrange miss, m."""
    down, aside, _, _ = predict(onboard, nav, out, bank_plan(params, onboard, nav, memory, bank, turn=turn))
    return down, aside


@kernel
def correct_range(params, onboard, nav, memory, out):
    """Correct the bank magnitude by one Gauss-Newton step, halved until the predicted range improves."""
    entry = onboard.guidance.entry
    most = most_bank(params, memory, entry)
    nudge = NUDGE_BANK if memory.bank + NUDGE_BANK <= most else -NUDGE_BANK
    beside, _ = ends(params, onboard, nav, memory, out, bank=memory.bank + nudge, turn=memory.turn)
    slope = (beside - memory.miss) / nudge
    # more bank, less range: elsewhere a prediction has left the air, and late no bank moves the end much
    if -slope * (most - entry.bank_min) < params.authority:
        return
    way = clamp(-memory.miss / slope, -STEP_BANK, STEP_BANK)
    for _ in range(params.halvings + 1):
        better = clamp(memory.bank + way, entry.bank_min, most)
        if better == memory.bank:
            return
        down, aside = ends(params, onboard, nav, memory, out, bank=better, turn=memory.turn)
        if abs(down) < abs(memory.miss):
            memory.bank, memory.miss, memory.aside = better, down, aside
            return
        way *= 0.5


@kernel
def move_turn(params, onboard, nav, memory, out, slowest, way, weight):
    """Change the speed of the next reversal by ``way`` (m/s), halved until the predicted crossrange, combined
    with ``weight`` times the downrange miss, is smaller.
    """
    way = clamp(way, -STEP_TURN, STEP_TURN)
    for _ in range(params.halvings + 1):
        turn = clamp(memory.turn + way, max(memory.later, slowest), nav.speed)
        if turn == memory.turn:
            return
        down, aside = ends(params, onboard, nav, memory, out, bank=memory.bank, turn=turn)
        if hypot(weight * down, aside) < hypot(weight * memory.miss, memory.aside):
            memory.turn, memory.miss, memory.aside = turn, down, aside
            return
        way *= 0.5


@kernel
def correct_turn(params, onboard, nav, memory, out, slowest):
    """Correct the speed of the next reversal by one step towards zero predicted crossrange."""
    nudge = NUDGE_TURN if memory.turn + NUDGE_TURN <= nav.speed else -NUDGE_TURN
    _, beside = ends(params, onboard, nav, memory, out, bank=memory.bank, turn=memory.turn + nudge)
    slope = (beside - memory.aside) / nudge
    # turning at a higher speed leaves less of the present side
    if memory.side * slope < 0.0:
        move_turn(params, onboard, nav, memory, out, slowest=slowest, way=-memory.aside / slope, weight=0.0)


@kernel
def least_of_both(params, onboard, nav, memory, out, slowest):
    """Correct the speed of the next reversal by one Gauss-Newton step for downrange and crossrange
    together.
    """
    nudge = NUDGE_TURN if memory.turn + NUDGE_TURN <= nav.speed else -NUDGE_TURN
    down, aside = ends(params, onboard, nav, memory, out, bank=memory.bank, turn=memory.turn + nudge)
    down_slope, aside_slope = (down - memory.miss) / nudge, (aside - memory.aside) / nudge
    square = max(down_slope * down_slope + aside_slope * aside_slope, 1e-12)
    way = -(memory.miss * down_slope + memory.aside * aside_slope) / square
    move_turn(params, onboard, nav, memory, out, slowest=slowest, way=way, weight=1.0)


@kernel
def correct(params, onboard, nav, memory, out, slowest):
    """Correct the plan where its predicted end misses the aim point by more than the tolerance; ``slowest``:
    speed (m/s) at which range control ends.
    """
    memory.miss, memory.aside = ends(params, onboard, nav, memory, out, bank=memory.bank, turn=memory.turn)
    if abs(memory.miss) > params.tolerance:
        correct_range(params, onboard, nav, memory, out)
    most = most_bank(params, memory, onboard.guidance.entry)
    beyond = memory.miss > params.tolerance and memory.bank >= most
    if beyond and memory.left > 1:
        memory.left -= 1  # through lift up so often leads beyond the aim point, whatever the bank angle
        foresee(params, nav.speed * params.spacing, memory, slowest)
    elif beyond and memory.turn > 0.0:
        least_of_both(params, onboard, nav, memory, out, slowest=slowest)
    elif memory.turn > 0.0 and abs(memory.aside) > params.tolerance:
        correct_turn(params, onboard, nav, memory, out, slowest=slowest)


@kernel
def start(params, onboard, nav, memory, out, slowest):
    """Set the plan before the first correction: speeds of reversals in a fixed ratio."""
    memory.side = first_side(out)
    memory.left = params.reversals
    memory.bank = abs(nav.bank)
    foresee(params, nav.speed * params.spacing, memory, slowest)


@kernel
def foresee(params, turn, memory, slowest):
    """Plan the next reversal at ``turn`` (m/s), not below ``slowest``, and the one after it, whose speed
    stays until the next has been flown.
    """
    memory.turn = max(turn, slowest) if memory.left > 0 else 0.0
    memory.later = params.spacing * memory.turn if memory.left > 1 else 0.0


@kernel
def reverse_when_due(params, nav, memory, slowest):
    """Change the side at the planned speed; the reversal after it becomes the next."""
    if memory.left > 0 and nav.speed <= memory.turn:
        memory.side = -memory.side
        memory.left -= 1
        foresee(params, memory.later, memory, slowest)


@kernel
def least_climb(params, onboard, nav):
    """Lowest altitude rate (m/s) at which load and heat rate respect their limits, less the margin.

    With exponential air the load changes at the rate -h'/H + 2 V'/V, the heat rate at -h'/(2 H) + 3 V'/V;
    either may reach its limit within the limit time.
    """
    limits = onboard.guidance.entry.limits
    density, _, scale_height = model_atmosphere(onboard.atmosphere, nav.altitude)
    slowing = (nav.drag + nav.gravity * sin(nav.flight_path_angle)) / nav.speed
    load = max(sqrt(nav.drag * nav.drag + nav.lift * nav.lift), 1e-3)
    heat = onboard.planet.sutton_graves_constant * sqrt(density / limits.nose_radius) * nav.speed**3
    most = 1.0 - limits.margin
    load_growth = (most * limits.load / load - 1.0) / params.limit_time + 2.0 * slowing
    heat_growth = (most * limits.heat_rate / max(heat, 1e-3) - 1.0) / params.limit_time + 3.0 * slowing
    return -scale_height * min(load_growth, 2.0 * heat_growth)


@kernel
def within_limits(params, onboard, nav, bank):
    """Bank angle (rad) with the vertical lift of ``bank`` plus the lift that the limits require."""
    short = least_climb(params, onboard, nav) - nav.speed * sin(nav.flight_path_angle)
    if short <= 0.0 or nav.lift <= 0.0:
        return bank
    return copysign(acos(clamp(cos(bank) + short / (params.lift_time * nav.lift), -1.0, 1.0)), bank)


@kernel
def fly_plan(params, onboard, nav, memory, out):
    """Wanted bank angle, its sign included."""
    entry = onboard.guidance.entry
    slowest = max(entry.align_speed, entry.heading.speed)
    if memory.side == 0.0:
        start(params, onboard, nav, memory, out, slowest=slowest)
    if nav.drag >= params.start_drag:
        memory.started = 1
    controls = memory.started != 0 and nav.speed > slowest
    if controls:
        correct(params, onboard, nav, memory, out, slowest=slowest)
        reverse_when_due(params, nav, memory, slowest)
    ahead = bank_plan(params, onboard, nav, memory, memory.bank, turn=memory.turn)
    bank = planned_bank(onboard, ahead, nav.speed)
    if controls and params.stretch and memory.bank <= entry.bank_min and memory.miss < -params.tolerance:
        bank = stretched(onboard, nav, out, memory.side, memory.turn, later=memory.later)
        out.least_bank = min(abs(bank), entry.bank_min)
    return within_limits(params, onboard, nav, bank)
