"""The bank angle of an entry that the smallest bank magnitude hardly brings to the aim point, or not at all.

The smallest bank is kept for crossrange: flown now to one side, now to the other, it leaves both in reach.
The range that it costs grows with its square, while the crossrange of the two sides cancels.  The longest
range without crossrange is that of one bank angle held to the end, its sign included, mostly all but lift up.
Where the smallest bank ends short even if it is held to the end, that one is flown; with a reserve of range
as large as what letting the smallest bank go would buy, the smallest bank is; in between the mean of the two
by that reserve.  Density that has been met does not come back: range is to be saved before it is short.
Source: derived; crossrange is taken as linear between two predictions.
"""

from __future__ import annotations

from edl6dof.fsw.guidance.entry.prediction.bank_plan import held, linear
from edl6dof.fsw.guidance.entry.prediction.predictor import predict
from edl6dof.jit import kernel
from edl6dof.spatial.vector import clamp


@kernel
def straight_bank(onboard, nav, out):
    """Bank angle (rad) to either side, no larger than the smallest magnitude, with which the predicted
    crossrange is least if it is held to the end.
    """
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
    reserve, _, _, _ = predict(
        onboard,
        nav,
        out,
        linear(least, last_bank=least, speed=nav.speed, side=side, first_turn=turn, second_turn=later),
    )
    straight = straight_bank(onboard, nav, out)
    longest, _, _, _ = predict(onboard, nav, out, held(straight))
    share = clamp(reserve / max(longest - reserve, 1.0), 0.0, 1.0)
    return straight + share * (side * least - straight)
