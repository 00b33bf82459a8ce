"""The straight line in time that stands for a jagged thrust over one integration step.

A pulse begins and ends anywhere in a step, of which Runge-Kutta sees the ends and the middle.  The line that
has the first and the second time integral of the thrust gives the vehicle the same speed and the same
displacement, and is integrated exactly.
"""

from __future__ import annotations

from edl6dof.kernels import kernel


@kernel
def line_in_step(first, second, step):
    """Mean, and slope (per s) about the middle, of the line over ``step`` s whose integral over the step is
    ``first``, and the integral of that, as it grows, ``second``.
    """
    mean = first / step
    return mean, (6.0 * mean - 12.0 * second / (step * step)) / step
