"""The check case ``rk4_order`` passes, and fails for this planted error: an error of second order, 1e-6 h^2
relative, in the end state.

(A changed weight of the Runge-Kutta formula leaves an error of at most third order; to change it would
recompile the simulator.)
"""

from __future__ import annotations

from edl6dof.verify.cases import rk4_order


def test_passes():
    assert rk4_order.run().passed


def test_planted_error_is_caught():
    assert not rk4_order.run(
        state=lambda step, planted: rk4_order.end_state(step, planted) * (1.0 + 1e-6 * step**2)
    ).passed
