"""Bridle of three legs between the vehicle and the confluence, at which the riser begins.

The legs do not stretch (their share is in the stiffness of lines and riser); they go slack.  The
confluence is the point nearest to the canopy of all that the legs can reach: of the intersection of three
balls about the attachments.  While every leg pulls it stays where they meet, as if fixed to the vehicle.  A
pull from outside the cone of the legs slackens one or two of them; the confluence then swings about the
others, and arm and attitude stiffness are smaller than those of a fixed point.  As the nearest point it moves
across the riser only, so that rate of stretch and work of the riser are those of a point fixed to the
vehicle.  Left out: mass and stretch of the legs, and that they can wrap around the vehicle.
"""

from __future__ import annotations

from math import sqrt

from edl6dof.kernels import kernel
from edl6dof.spatial.vector import add, cross, dot, norm, scale, sub, take3, unit

LEGS = 3
#: A leg is taken to reach what is nearer than its length and this share of it.
_ROUNDING = 1e-12


@kernel
def confluence(chute, canopy_B):
    """Where the riser begins (m, B) when the canopy is at ``canopy_B``; ``chute.confluence`` if no bridle is
    given.
    """
    meeting = take3(chute.confluence, 0)
    if chute.n_bridle_attachments == 0 or _all_taut(chute.bridle_attachments, meeting, canopy_B):
        return meeting
    return _nearest(chute.bridle_attachments, meeting, canopy_B)


@kernel
def _all_taut(attachments, meeting, canopy):
    """True if the pull of the canopy on the point where the legs meet is a sum of pulls of all three."""
    a = sub(meeting, take3(attachments[0], 0))
    b = sub(meeting, take3(attachments[1], 0))
    c = sub(meeting, take3(attachments[2], 0))
    pull = sub(canopy, meeting)
    bc, ca, ab = cross(b, c), cross(c, a), cross(a, b)
    volume = dot(a, bc)
    return volume * dot(pull, bc) >= 0.0 and volume * dot(pull, ca) >= 0.0 and volume * dot(pull, ab) >= 0.0


@kernel
def _nearest(attachments, meeting, canopy):
    """Point nearest to the canopy that every leg reaches: with all three taut on either side of the
    attachments, with two, with one, or the canopy itself.
    """
    if _reached(attachments, meeting, canopy):
        return canopy
    first = take3(attachments[0], 0)
    across = unit(cross(sub(take3(attachments[1], 0), first), sub(take3(attachments[2], 0), first)))
    other = sub(meeting, scale(2.0 * dot(sub(meeting, first), across), across))
    best = _nearer(attachments, meeting, canopy, meeting, other)
    for k in range(LEGS):
        a = take3(attachments[k], 0)
        b = take3(attachments[(k + 1) % LEGS], 0)
        length = norm(sub(meeting, a))
        alone = add(a, scale(length, unit(sub(canopy, a))))
        best = _nearer(attachments, meeting, canopy, best, alone)
        # two taut legs hold a circle about the line between their attachments
        axis = unit(sub(b, a))
        along = dot(sub(meeting, a), axis)
        out = sub(canopy, a)
        out = unit(sub(out, scale(dot(out, axis), axis)))
        radius = sqrt(length * length - along * along)
        pair = add(a, add(scale(along, axis), scale(radius, out)))
        best = _nearer(attachments, meeting, canopy, best, pair)
    return best


@kernel
def _nearer(attachments, meeting, canopy, best, point):
    """``point`` if the legs reach it and it is nearer to the canopy than ``best``, else ``best``."""
    if norm(sub(canopy, point)) < norm(sub(canopy, best)) and _reached(attachments, meeting, point):
        return point
    return best


@kernel
def _reached(attachments, meeting, point):
    """True if every leg is long enough for a point."""
    for k in range(LEGS):
        a = take3(attachments[k], 0)
        if norm(sub(point, a)) > norm(sub(meeting, a)) * (1.0 + _ROUNDING):
            return False
    return True
