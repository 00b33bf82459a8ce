"""Reach of the entry: the remaining range at the smallest bank angle, and the reversals that the largest bank
angle allows. Both are predicted; source: derived.

Range at the smallest bank. The smallest bank angle preserves crossrange control: flown to alternating sides,
it leaves both sides in reach. Its loss of range grows with its square, while the crossrange of the two sides
cancels. The longest range without crossrange is that of one signed bank angle, held to the end, mostly near
lift up. Where the smallest bank ends short, this straight bank angle is flown; where the reserve of range is
as large as the gain of the straight bank angle, the smallest bank is flown; in between, the mean of the two
weighed by the reserve. Lost range cannot be regained: it has to be saved before it is short. Crossrange is
interpolated linearly between two predictions.

Reversals. Rolling through lift up takes time and adds range, and an excess of range that the largest bank
angle cannot remove is a miss. While the aim point stays in reach a reversal is made when the logic requests
it. Otherwise the miss of range and crossrange together decides: a reversal waits as long as a later one, or
none, ends nearer to the aim point or hardly farther away, since shortly before the aim point a heading
corridor is narrower than any relevant miss. The predictions use the bank rate of the vehicle.
"""

from __future__ import annotations

from edl6dof.fsw.guidance.entry.predictor import held, linear, predict
from edl6dof.kernels import kernel
from edl6dof.spatial.elementary import hypot
from edl6dof.spatial.vector import clamp


@kernel
def straight_bank(onboard, nav, out):
    """Bank angle (rad), of at most the smallest magnitude, with the least predicted crossrange if held to the
    end.
    """
    least = onboard.guidance.entry.bank_min
    _, right, _, _ = predict(onboard, nav, out, held(least))
    _, left, _, _ = predict(onboard, nav, out, held(-least))
    return -least * clamp((right + left) / max(right - left, 1.0), -1.0, 1.0)


@kernel
def stretched(onboard, nav, out, side, turn, later):
    """Bank angle (rad), its sign included, that replaces the smallest one to ``side``, whose reversals are at
    the speeds ``turn`` and ``later`` (m/s; 0: none).
    """
    least = onboard.guidance.entry.bank_min
    smallest = linear(least, least, nav.speed, side, turn, second_turn=later)
    reserve, _, _, _ = predict(onboard, nav, out, smallest)
    straight = straight_bank(onboard, nav, out)
    longest, _, _, _ = predict(onboard, nav, out, held(straight))
    share = clamp(reserve / max(longest - reserve, 1.0), 0.0, 1.0)
    return straight + share * (side * least - straight)


#: Delay of a reversal, as loss of speed (m/s), in the comparison with a later one.
LATER = 100.0
#: Advantage (m) that a reversal now must have to be made: the miss of guidance in calm air.
WORTH = 100.0


@kernel
def nearest_end(onboard, nav, out, side, turn):
    """Range (m) by which the largest bank angle overflies the aim point, 0 if it does not, and crossrange
    (m), from ``side`` with a reversal at the speed ``turn`` (m/s; 0: none).
    """
    most = onboard.guidance.entry.bank_max
    largest = linear(most, most, nav.speed, side, turn, second_turn=0.0)
    beyond, aside, _, _ = predict(onboard, nav, out, largest)
    return max(beyond, 0.0), aside


@kernel
def reversed_in_reach(onboard, nav, out, sign):
    """Side to bank to where the logic requests to leave side ``sign``: the other one, or still ``sign`` while
    staying ends nearer to the aim point or hardly farther away.
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
