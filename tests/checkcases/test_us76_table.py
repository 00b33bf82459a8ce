"""The check case ``us76_table`` passes, and fails for each of these planted errors, which change what flies
and not what is expected:

* density 1e-4 too large
* the Mars table in its place
"""

from __future__ import annotations

import pytest

from edl6dof.verify.cases import us76_table

PLANTED = [
    pytest.param(["atmosphere.density_factor=1.0001"], "density", id="density"),
    pytest.param(["atmosphere.model=table"], "temperature", id="table", marks=pytest.mark.long),
]


def test_passes():
    assert us76_table.run().passed


@pytest.mark.parametrize(("planted", "quantity"), PLANTED)
def test_planted_error_is_caught(planted, quantity):
    caught = [result.quantity for result in us76_table.run(planted).results if not result.passed]
    assert any(quantity in name for name in caught), caught
