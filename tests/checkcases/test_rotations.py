"""The check case ``rotations`` passes, and fails for each of these planted errors:

* one sign of the product turned (i j = -k),
* components turned the wrong way (to the body instead of from it),
* quaternion rate with the rate taken in I instead of B.
"""

from __future__ import annotations

import pytest

from edl6dof.spatial import quaternion
from edl6dof.verify.cases import rotations

multiply, to_frame = quaternion.multiply, quaternion.to_frame


def test_passes():
    assert rotations.run().passed


@pytest.mark.parametrize(
    ("kernel", "wrong", "quantity"),
    [
        ("multiply", lambda p, q: (*multiply(p, q)[:3], multiply(p, q)[3] - 2.0 * p[1] * q[2]), "product"),
        pytest.param("from_frame", lambda q, v: to_frame(q, v), "to inertial", marks=pytest.mark.long),
        pytest.param(
            "rate",
            lambda q, w: tuple(0.5 * c for c in multiply((0.0, *w), q)),
            "rate",
            marks=pytest.mark.long,
        ),
    ],
)
def test_planted_error_is_caught(monkeypatch, kernel, wrong, quantity):
    monkeypatch.setattr(quaternion, kernel, wrong)
    assert [result.quantity for result in rotations.run().results if not result.passed] == [quantity]
