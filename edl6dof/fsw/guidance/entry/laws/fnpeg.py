"""FNPEG, fully numerical predictor-corrector entry guidance: bank linear in energy, and the reversals, so
that the predicted flight ends at the aim point in range and crossrange.

Every call flies the onboard prediction to the parachute: from the bank angle that the vehicle has, at the
rate at which it rolls, through the reversals that are left.  The bank magnitude runs linearly in energy from
the one that is sought to a fixed one at the end; it is corrected by Gauss-Newton steps, halved until the
predicted range is better.  The speed of the next reversal is corrected alike until the predicted crossrange
is none; the one after it is foreseen at a set share of that speed.  Where the largest bank angle ends beyond
the aim point all the same, the reversal is moved to where both misses together are least: rolling through
lift up adds range, the more the slower the vehicle rolls.  Where the smallest bank angle ends short, it is
let go (:mod:`~edl6dof.fsw.guidance.entry.reach`).  Where load or heat rate would pass
their limits, vertical lift is added until the altitude rate is one that keeps them.
Sources: Lu 2014, "Entry guidance: a unified method", J. Guidance, Control, and Dynamics 37(4), sections IV
and V (range, altitude-rate feedback, filters); Lu, Brunner, Stachowiak, Mendeck, Tigges & Cerimele 2017,
"Verification of a fully numerical entry guidance algorithm", J. Guidance 40(2); Smith 2016, AAS 16-216
(reversals by prediction).

Differences: energy here is kinetic energy, which at the low end is known beforehand; Smith decides by the
ratio of two predicted crossranges, here the reversal is solved for.  With ``reversal.logic: own_sign`` the
planned reversals are flown; with another logic the magnitude alone.
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
from edl6dof.registry import Member
from edl6dof.spatial.elementary import acos, cos, hypot, sin
from edl6dof.spatial.vector import clamp

#: Changes of bank angle (rad) and of reversal speed (m/s) by which slopes are measured.
NUDGE_BANK, NUDGE_TURN = 0.02, 20.0
#: Largest steps of one correction: bank (rad), reversal speed (m/s).
STEP_BANK, STEP_TURN = 0.5, 500.0


class FnpegParams(Params):
    """Fully numerical predictor-corrector entry guidance."""

    last_bank_deg: float = param(
        60.0, "bank magnitude at the end of the prediction", status="design", ge=0.0, le=180.0
    )
    tolerance_m: float = param(50.0, "predicted miss at which the correction stops", gt=0.0, le=10e3)
    authority_m: float = param(
        200.0, "bank is corrected while all bank angles span this range", status="design", ge=0.0, le=100e3
    )
    start_drag_m_s2: float = param(
        0.3, "drag at which correction begins; before, the reference bank is held", ge=0.0
    )
    halvings: int = param(3, "most times that a step is halved in one call", ge=0, le=10)
    limit_time_s: float = param(
        8.0, "time in which load or heat rate may come up to its limit", status="design", gt=0.0, le=100.0
    )
    lift_time_s: float = param(
        3.0, "time in which lift makes up for an altitude rate too low", status="design", gt=0.0, le=100.0
    )
    reversals: int = param(3, "reversals planned", ge=0, le=10)
    spacing: float = param(
        0.55, "first guess of the speed of a reversal over the one before it", status="design", gt=0.0, lt=1.0
    )
    stretch: bool = param(
        True, "whether bank_min_deg is let go where it leaves range too short", status="design"
    )
    heading_speed_m_s: float | None = param(
        None, "this law's own value of heading.speed_m_s", status="design", record=False, ge=0.0, le=10e3
    )


MEMORY = record(
    ("started", FLAG),
    ("side", "f8"),  # +1 right, -1 left
    ("bank", "f8"),  # magnitude now, rad; beyond the largest, what is added to the last
    ("turn", "f8"),  # speed of the next reversal, m/s; 0 when none is left
    ("later", "f8"),  # speed at which the one after it is foreseen, m/s; 0 for none
    ("left", COUNT),  # reversals left
    ("miss", "f8"),  # predicted, m: downrange, and crossrange
    ("aside", "f8"),
)


@kernel
def bank_plan(params, onboard, nav, memory, bank, turn):
    """The plan of bank magnitude ``bank`` (rad) now and the next reversal at ``turn`` (m/s); what ``bank`` is
    beyond the largest is added to the last bank.
    """
    now = min(bank, onboard.guidance.entry.bank_max)
    return linear(
        now,
        last_bank=params.last_bank + (bank - now),
        speed=nav.speed,
        side=memory.side,
        first_turn=turn,
        second_turn=memory.later,
    )


@kernel
def most_bank(params, entry):
    """The largest bank angle all the way, as the number that is sought (rad)."""
    return entry.bank_max + max(entry.bank_max - params.last_bank, 0.0)


@kernel
def ends(params, onboard, nav, memory, out, bank, turn):
    """Predicted downrange and crossrange miss, m."""
    down, aside, _, _ = predict(onboard, nav, out, bank_plan(params, onboard, nav, memory, bank, turn=turn))
    return down, aside


@kernel
def correct_range(params, onboard, nav, memory, out):
    """One Gauss-Newton step of the bank magnitude, halved until the predicted range is better."""
    entry = onboard.guidance.entry
    most = most_bank(params, entry)
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
    """Move the next reversal's speed by ``way`` (m/s), halved until the predicted crossrange, together with
    ``weight`` times the downrange miss, is less.
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
    """One step of the next reversal's speed to where the predicted crossrange is none."""
    nudge = NUDGE_TURN if memory.turn + NUDGE_TURN <= nav.speed else -NUDGE_TURN
    _, beside = ends(params, onboard, nav, memory, out, bank=memory.bank, turn=memory.turn + nudge)
    slope = (beside - memory.aside) / nudge
    # turning at a higher speed leaves less of the present side
    if memory.side * slope < 0.0:
        move_turn(params, onboard, nav, memory, out, slowest=slowest, way=-memory.aside / slope, weight=0.0)


@kernel
def least_of_both(params, onboard, nav, memory, out, slowest):
    """One Gauss-Newton step of the next reversal's speed for downrange and crossrange together."""
    nudge = NUDGE_TURN if memory.turn + NUDGE_TURN <= nav.speed else -NUDGE_TURN
    down, aside = ends(params, onboard, nav, memory, out, bank=memory.bank, turn=memory.turn + nudge)
    down_slope, aside_slope = (down - memory.miss) / nudge, (aside - memory.aside) / nudge
    square = max(down_slope * down_slope + aside_slope * aside_slope, 1e-12)
    way = -(memory.miss * down_slope + memory.aside * aside_slope) / square
    move_turn(params, onboard, nav, memory, out, slowest=slowest, way=way, weight=1.0)


@kernel
def correct(params, onboard, nav, memory, out, slowest):
    """Correct the plan, where its predicted end is off by more than the tolerance."""
    memory.miss, memory.aside = ends(params, onboard, nav, memory, out, bank=memory.bank, turn=memory.turn)
    if abs(memory.miss) > params.tolerance:
        correct_range(params, onboard, nav, memory, out)
    beyond = memory.miss > params.tolerance and memory.bank >= most_bank(params, onboard.guidance.entry)
    if beyond and memory.left > 1:
        memory.left -= 1  # through lift up so often leads beyond the aim point, whatever the bank angle
        foresee(params, nav.speed * params.spacing, memory, slowest)
    elif beyond and memory.turn > 0.0:
        least_of_both(params, onboard, nav, memory, out, slowest=slowest)
    elif memory.turn > 0.0 and abs(memory.aside) > params.tolerance:
        correct_turn(params, onboard, nav, memory, out, slowest=slowest)


@kernel
def start(params, onboard, nav, memory, out, slowest):
    """The plan before the first correction: reversals equally far apart in speed."""
    memory.side = first_side(out)
    memory.left = params.reversals
    memory.bank = abs(nav.bank)
    foresee(params, nav.speed * params.spacing, memory, slowest)


@kernel
def foresee(params, turn, memory, slowest):
    """Foresee the next reversal at ``turn`` (m/s), no slower than range is controlled to, and where the one
    after it stays until the next is done.
    """
    memory.turn = max(turn, slowest) if memory.left > 0 else 0.0
    memory.later = params.spacing * memory.turn if memory.left > 1 else 0.0


@kernel
def reverse_when_due(params, nav, memory, slowest):
    """Change the side at the planned speed, and turn to the reversal after it where it was foreseen."""
    if memory.left > 0 and nav.speed <= memory.turn:
        memory.side = -memory.side
        memory.left -= 1
        foresee(params, memory.later, memory, slowest)


@kernel
def least_climb(params, onboard, nav):
    """Lowest altitude rate (m/s) with which load and heat rate keep their limits, less the margin.

    With exponential air the load changes at the rate -h'/H + 2 V'/V, the heat rate at -h'/(2 H) + 3 V'/V;
    either may grow by what is left to its limit within the limit time.
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
    """Bank angle (rad) whose vertical lift is that of ``bank`` plus the lift that the limits require."""
    short = least_climb(params, onboard, nav) - nav.speed * sin(nav.flight_path_angle)
    if short <= 0.0 or nav.lift <= 0.0:
        return bank
    return copysign(acos(clamp(cos(bank) + short / (params.lift_time * nav.lift), -1.0, 1.0)), bank)


@kernel
def guide(params, plan, onboard, nav, memory, out):
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


MEMBER = Member("fnpeg", FnpegParams, {"guide": guide}, "Lu 2014, J. Guidance 37(4); Smith 2016", MEMORY)
