"""Whether a reversal can be afforded: rolling through lift up takes its time and adds range, and what the
largest bank angle cannot take out again is missed.

While the aim point stays in reach a reversal is made when the logic asks for it.  Where it does not, the
miss of range and crossrange together decides: a reversal waits as long as a little later, or none at all,
ends nearer to the aim point or hardly farther away: shortly before the aim point a corridor of heading is
narrower than anything that matters.  Source: derived; flown ahead at the vehicle's bank rate.
"""

from __future__ import annotations

from edl6dof.fsw.guidance.entry.prediction.bank_plan import linear
from edl6dof.fsw.guidance.entry.prediction.predictor import predict
from edl6dof.jit import kernel
from edl6dof.spatial.elementary import hypot

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
    beyond, aside, _, _ = predict(
        onboard,
        nav,
        out,
        linear(most, last_bank=most, speed=nav.speed, side=side, first_turn=turn, second_turn=0.0),
    )
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
