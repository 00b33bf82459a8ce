"""State feedback that bounds what a disturbance does to the tracking error, and parameter adaptation inside a
box.

Error dynamics z' = A z + B (v + d), z = (e, e'), two integrators.  P > 0 solves P A + A' P + P B (1/lambda^2
- 1/rho) B' P + C' C = 0 with C = (1, 0) and the weight rho on the control; v = F z, F = -B' P / (2 rho), then
gives d/dt (z' P z) <= lambda^2 d^2 - e^2, so int e^2 <= lambda^2 int d^2 + z(0)' P z(0).  For two integrators
P is known in closed form (checked in the tests against scipy.linalg.solve_continuous_are); it exists when
lambda^2 > rho.
Source: Lu & Bayard, sections 3.3-3.4, eqs. 17-20; Lu & Packard 1997.

Differences from the print: F = +B' P / 2 lacks the minus sign that its own equation P (A + B F) + (A + B F)'
P + ... = 0 needs; the L2 inequality holds from z(0) = 0, otherwise z(0)' P z(0) is added; rho is 1 in the
print (``settings: as_printed``), which in seconds means a drag loop of 0.7 rad/s, faster than a capsule can
bank: the weight sets the bandwidth.
"""

from __future__ import annotations

from math import sqrt

from edl6dof.kernels import kernel
from edl6dof.spatial.vector import clamp


@kernel
def riccati(disturbance_gain, control_weight):
    """(P11, P12, P22) for lambda in s^2 and rho in s^4; needs lambda^2 > rho."""
    strength = 1.0 / control_weight - 1.0 / (disturbance_gain * disturbance_gain)
    p12 = 1.0 / sqrt(strength)
    p22 = sqrt(2.0 * p12 / strength)
    return strength * p12 * p22, p12, p22


@kernel
def feedback(disturbance_gain, control_weight):
    """Gains F = (F1, F2) on the drag error and its rate."""
    _, p12, p22 = riccati(disturbance_gain, control_weight)
    return -0.5 * p12 / control_weight, -0.5 * p22 / control_weight


@kernel
def adapt(estimate, low, high, regressor, adjoint, energy, dt):
    """One step of p' = projection of -Q^-1 g1' (P z)_2 (eq. 20), in place.

    Q is diagonal, such that (p - theta)' Q (p - theta) <= ``energy`` (epsilon of the inequality) for any two
    points of the box ``low`` .. ``high``; for a box the projection is the limit of each component.
    """
    n = estimate.shape[0]
    for i in range(n):
        width = high[i] - low[i]
        estimate[i] = clamp(
            estimate[i] - dt * n * width * width / energy * regressor[i] * adjoint, low[i], high[i]
        )
