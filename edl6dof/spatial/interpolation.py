"""Smooth interpolation in tables of evenly spaced rows."""

from __future__ import annotations

from edl6dof.kernels import kernel


@kernel
def smooth(profile, rows, row, t):
    """Catmull-Rom cubic through ``profile`` between ``row`` and the next (t in 0..1): continuous slope, exact
    at the rows.
    """
    p1 = profile[row]
    p2 = profile[row + 1]
    p0 = profile[max(row - 1, 0)]
    p3 = profile[min(row + 2, rows - 1)]
    s1 = 0.5 * (p2 - p0)
    s2 = 0.5 * (p3 - p1)
    rise = p2 - p1
    return p1 + t * (s1 + t * (3.0 * rise - 2.0 * s1 - s2 + t * (s1 + s2 - 2.0 * rise)))
