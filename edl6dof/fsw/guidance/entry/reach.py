"""Reach of the entry: the range that is left at the smallest bank angle, and the reversals that the largest
one affords.  Both are predicted; source: derived.

Range at the smallest bank.  It is kept for crossrange: flown now to one side, now to the other, it leaves
both in reach.  The range that it costs grows with its square, while the crossrange of the two sides cancels.
The longest range without crossrange is that of one bank angle held to the end, its sign included, mostly all
but lift up.  Where the smallest bank ends short even if it is held to the end, that one is flown; with a
reserve of range as large as the gain from giving up the smallest bank, the smallest bank is; in between the
mean of the two by that reserve.  Density that has been met does not come back: range is to be saved before it
is short.  Crossrange is taken as linear between two predictions.

Reversals.  Rolling through lift up takes time and adds range, and an excess that the largest bank angle
cannot take out again is missed.  While the aim point stays in reach a reversal is made when the logic asks
for it.  Otherwise the miss of range and crossrange together decides: a reversal waits as long as a later one,
or none at all, ends nearer to the aim point or hardly farther away, since shortly before the aim point a
corridor of heading is narrower than anything that matters.  Flown ahead at the vehicle's bank rate.
"""

from __future__ import annotations

from edl6dof.fsw.guidance.entry.predictor import held, linear, predict
from edl6dof.kernels import kernel
from edl6dof.spatial.elementary import hypot
from edl6dof.spatial.vector import clamp


@kernel
def straight_bank(onboard, nav, out):
    """Bank angle (rad), within the smallest magnitude, of least predicted crossrange if held to the end."""
    least = onboard.guidance.entry.bank_min
    _, right, _, _ = predict(onboard, nav, out, held(least))
    _, left, _, _ = predict(onboard, nav, out, held(-least))
    return -least * clamp((right + left) / max(right - left, 1.0), -1.0, 1.0)


@kernel
def stretched(onboard, nav, out, side, turn, later):
    """Bank angle (rad), its sign included, in the place of the smallest one to ``side`` with reversals at the
    speeds ``turn`` and ``later`` (m/s), 0 for none.
    """
    least = onboard.guidance.entry.bank_min
    smallest = linear(least, least, nav.speed, side, turn, second_turn=later)
    reserve, _, _, _ = predict(onboard, nav, out, smallest)
    straight = straight_bank(onboard, nav, out)
    longest, _, _, _ = predict(onboard, nav, out, held(straight))
    share = clamp(reserve / max(longest - reserve, 1.0), 0.0, 1.0)
    return straight + share * (side * least - straight)


#: Speed (m/s) by which a reversal is put off to see whether later is better.
LATER = 100.0
#: By how much (m) a reversal has to end nearer to be made: what guidance itself leaves in calm air.
WORTH = 100.0


@kernel
def nearest_end(onboard, nav, out, side, turn):
    """Range (m) by which the aim point is overflown at the largest bank angle, none if it is not, and the
    crossrange, from ``side`` with a reversal at the speed ``turn`` (m/s), 0 for none.
    """
    most = onboard.guidance.entry.bank_max
    largest = linear(most, most, nav.speed, side, turn, second_turn=0.0)
    beyond, aside, _, _ = predict(onboard, nav, out, largest)
    return max(beyond, 0.0), aside


@kernel
def reversed_in_reach(onboard, nav, out, sign):
    """Side to bank to where the logic asks to leave side ``sign``: the other one, or ``sign`` while that ends
    nearer to the aim point or hardly farther away.
    """
    over, aside = nearest_end(onboard, nav, out, -sign, 0.0)
    if over == 0.0:
        return -sign
    now = hypot(over, aside)
    for turn in (nav.speed - LATER, 0.0):
        over, aside = nearest_end(onboard, nav, out, sign, turn)
        if hypot(over, aside) < now + WORTH:
            return sign
    return -sign
