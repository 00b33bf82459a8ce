"""Extended high-gain observer of the drag: drag, drag rate, and what the model of the drag's second
derivative leaves out.

The continuous observer of eqs. 20-21 integrates D'' = phi + b + a u with phi constant, corrected by the
measured drag; the printed alpha = (6, 11, 6) puts its poles at -1, -2 and -3 over the time scale eps.
Between two samples the integrator chain is solved exactly,
and the correction gains are those that put the poles of the sampled error at exp(pole dt): stable at any
rate, with the same decay, and the estimates of a steady phi carry no error.  (Closed explicitly with the
printed eps at 10 Hz, the error would double with each step.)
Source: Wu, Cui & Cui 2013, section 3.3, eqs. 20-23; Freidovich & Khalil 2008.

Differences from the print: the states are drag and drag rate instead of their errors, which is the same
observer since the reference is known, but does not jump when the reference is updated; eq. 20's gain vector
carries a stray sqrt(a^2 + b^2), left out here, and eqs. 22 and 23 a sigma-hat where phi-hat belongs; n = 2,
as printed only by implication.
"""

from __future__ import annotations

import numpy as np

from edl6dof.kernels import kernel
from edl6dof.records import FLAG
from edl6dof.spatial.elementary import exp

#: Longest time (s) between two samples over which the chain of integrators is believed; after it the observer
#: starts afresh.
MEMORY_S = 3.0

#: Estimates; a, b and time of the last sample.
OBSERVER = np.dtype(
    [("drag", "f8"), ("rate", "f8"), ("phi", "f8"), ("a", "f8"), ("b", "f8"), ("t", "f8"), ("started", FLAG)],
    align=True,
)


@kernel
def observer_gains(epsilon, dt):
    """Gains on drag, rate and phi that put the poles of the sampled error at exp(-dt/eps), its square and its
    cube.
    """
    z1 = exp(-dt / epsilon)
    z2, z3 = z1 * z1, z1 * z1 * z1
    total, pairs, product = z1 + z2 + z3, z1 * z2 + z1 * z3 + z2 * z3, z1 * z2 * z3
    k3 = 1.0 - total + pairs - product
    k2 = 2.0 + product - total - 0.5 * k3
    return 1.0 - product, k2 / dt, k3 / (dt * dt)


@kernel
def observe(memory, epsilon, start, t, drag, a, b, u):
    """Bring the estimates to time ``t`` with the measured ``drag`` (m/s2); ``memory`` is an ``OBSERVER``,
    ``start`` the drag (m/s2) that it starts from.

    ``a`` and ``b`` are those of the drag dynamics now, ``u`` is the cosine of the bank angle flown since the
    last sample.  The model
    acceleration is the mean of both ends of the interval: that of its beginning alone would put half an
    interval of lag into phi.
    """
    dt = t - memory.t
    if memory.started == 0 or dt > MEMORY_S:
        memory.drag, memory.rate, memory.phi = start, 0.0, 0.0
    elif dt > 0.0:
        acceleration = memory.phi + 0.5 * (memory.b + b + (memory.a + a) * u)
        ahead = memory.drag + dt * (memory.rate + 0.5 * dt * acceleration)
        k1, k2, k3 = observer_gains(epsilon, dt)
        error = drag - ahead
        memory.drag = ahead + k1 * error
        memory.rate += dt * acceleration + k2 * error
        memory.phi += k3 * error
    memory.a, memory.b, memory.t, memory.started = a, b, t, 1
