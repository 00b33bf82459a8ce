"""Values that were refused, and checks of what is left."""

from __future__ import annotations

import numpy as np
import pytest
from config_toy import Toy, document

from edl6dof.config.refused import REFUSED, NotKnown, findings
from edl6dof.config.validate import judged

TEXT = "seed: one\nstop_s: 3.0\nvehicle: {mass: {entry_mass_kg: 5, cg_m: [0, up, 1]}}\n"


def test_valid_values_are_kept_beside_refused_ones():
    toy, problems = judged(Toy, document(TEXT))
    assert [problem.path for problem in problems] == ["seed", "vehicle.mass.cg_m.1"]
    assert (toy.stop_s, toy.vehicle.mass.entry_mass_kg, toy.method) == (3.0, 5.0, "rk4")
    assert toy.seed is REFUSED and toy.vehicle.mass.cg_m[1] is REFUSED


@pytest.mark.parametrize(
    "use",
    [
        lambda one: one + 1, lambda one: 2.0 * one, lambda one: one < 3, lambda one: one == 3, float,
        lambda one: one.name, lambda one: one[0], lambda one: 3 in [1, one], bool, list,
        lambda one: f"{one:g}", lambda one: np.array([one]) * 2.0, lambda one: {one: 1},
    ],
)  # fmt: skip
def test_a_refused_value_cannot_be_used(use):
    with pytest.raises(NotKnown):
        use(REFUSED)


def test_a_check_finds_nothing_where_it_needs_a_refused_value():
    toy, _ = judged(Toy, document(TEXT))

    def of_seed(toy):
        yield "stop_s", "found before the seed is used"
        yield "method", f"seed {toy.seed + 1}"

    def joined(toy):
        yield "method", ", ".join([toy.method, toy.seed])

    found = findings((of_seed, joined, lambda toy: [("title", "found")]), toy)
    assert found == {"stop_s": "found before the seed is used", "title": "found"}


def test_a_defect_of_a_check_is_not_hidden():
    toy, problems = judged(Toy, document("vehicle: {mass: {entry_mass_kg: 5}}\n"))
    assert not problems
    with pytest.raises(ZeroDivisionError):
        findings((lambda toy: [("seed", str(1 / 0))],), toy)
