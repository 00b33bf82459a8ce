"""The check case ``nesc`` passes, and fails for this planted error: gravity 1e-5 too strong, 0.14 ft after 30
s.

More planted errors, one for each model: ``tests/nesc/test_check_cases.py``.
"""

from __future__ import annotations

import pytest

from edl6dof.verify.cases import nesc


@pytest.mark.exact_start  # its tolerances are below a millimetre
def test_passes():
    assert nesc.run().passed


def test_planted_error_is_caught():
    caught = {
        result.quantity
        for result in nesc.run(["planet.gravity.mu_m3_s2=3.98604427804418e14"]).results
        if not result.passed
    }
    assert "case 6: altitude" in caught, caught
