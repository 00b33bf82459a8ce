"""A case made in memory is the case that ``--set`` and ``truth:`` would make, bit for bit."""

from __future__ import annotations

import numpy as np
import pytest

import edl6dof
from edl6dof.campaign.design import variants
from edl6dof.campaign.design.case import Case
from edl6dof.campaign.design.plan import load_plan
from edl6dof.campaign.design.variants import Variants
from edl6dof.config.document.overrides import apply_overrides
from edl6dof.config.errors import ConfigError
from edl6dof.scenario import records
from edl6dof.scenario.schema import Scenario, check_document

CASES = {
    "truth only": {
        "truth": {"vehicle.mass.entry_kg": 1291.3, "atmosphere.density_factor": 1.07, "wind.scale": 1.4}
    },
    "belief only": {
        "belief": {"vehicle.mass.entry_kg": 1279.0, "flight_software.guidance.entry.preset_bank_deg": 52.5}
    },
    "truth beside belief": {
        "truth": {"vehicle.mass.entry_kg": 1291.3},
        "belief": {"vehicle.mass.entry_kg": 1280.0},
    },
    "list elements": {
        "truth": {"vehicle.mass.entry_centre_m.2": -0.0352, "vehicle.rcs.thrusters.D3.thrust_n": 243.0}
    },
    "whole list": {"truth": {"vehicle.mass.entry_inertia_kg_m2": [1160.0, 905.0, 955.0]}},
    "default not in the file": {
        "truth": {"vehicle.engine.thrust_factor": 0.98, "wind.gust.scale_length_m": 350.0}
    },
    "random profiles": {
        "truth": {"atmosphere.perturbation.enabled": True, "wind.gust.enabled": True},
        "profile": 12,
    },
    "shape, hence tables": {
        "truth": {"vehicle.aero.capsule.nose_radius_m": 0.8, "planet.gas.gas_constant_j_kg_k": 190.0}
    },
    "entry state": {
        "truth": {"initial.flight_path_angle_deg": -11.7, "initial.rate_deg_s": [0.2, 0.0, -0.1]}
    },
    "text, the long way": {"belief": {"flight_software.guidance.powered.law": "gravity_turn"}},
    "faults": {"truth": {"faults": [{"kind": "stuck_off", "thruster": "D7", "at": {"phase": "lift"}}]}},
    "point mass": {"belief": {"dynamics": "point_mass", "mission.goal": "deployment"}},
    "nothing": {},
}
BASES = {
    "plain": [],
    "with a truth of its own": [("truth={vehicle.mass.entry_kg: 1300.0, atmosphere.density_factor: 0.9}")],
}


def the_long_way(base, case):
    loaded = check_document(apply_overrides(base.document, case.overrides(base.scenario.truth), Scenario))
    return loaded, records.build_records(loaded)


@pytest.fixture(scope="module", params=BASES.values(), ids=BASES)
def base(request):
    return edl6dof.load("tianwen1", request.param)


@pytest.mark.parametrize("changes", CASES.values(), ids=CASES)
def test_quick_variant_equals_the_loaded_one(base, changes):
    case = Case(3, **changes)
    quick = Variants(base).build(case)
    loaded, parts = the_long_way(base, case)
    assert quick.loaded.scenario == loaded.scenario
    assert quick.loaded.truth == loaded.truth
    for mine, expected in zip(quick.parts, parts, strict=True):
        assert mine.tobytes() == expected.tobytes()


def test_variants_do_not_leak_into_each_other(base):
    made = Variants(base)
    before = made.build(Case(0))
    for index, changes in enumerate(CASES.values()):
        made.build(Case(index, **changes))
    after = made.build(Case(0))
    assert all(one.tobytes() == other.tobytes() for one, other in zip(before.parts, after.parts, strict=True))


@pytest.mark.parametrize("section, fields", records.FLOWN.items())
def test_parameters_applied_in_flight_do_not_enter_the_tables(section, fields):
    """What ``records.FLOWN`` promises: a case may share the tables when only these change."""
    base = edl6dof.load("tianwen1")
    tables = records.build_tables(base.scenario)
    prefix = {"atmosphere": "atmosphere", "capsule": "vehicle.aero.capsule", "gas": "planet.gas"}[section]
    for field in fields - {"exponential"}:
        value = float(np.nextafter(getattr(_section(base.scenario, prefix), field), 10.0)) * 1.01
        changed = edl6dof.load("tianwen1", [f"{prefix}.{field}={value!r}"])
        assert records.build_tables(changed.scenario).tobytes() == tables.tobytes(), field


def _section(scenario, prefix):
    for part in prefix.split("."):
        scenario = getattr(scenario, part)
    return scenario


@pytest.mark.parametrize(
    "changes, words",
    [
        ({"truth": {"vehicle.mass.entry_mass_kg": 1.0}}, "unknown key"),
        ({"truth": {"vehicle.mass.entry_kg": -5.0}}, "greater than 0"),
        ({"truth": {"vehicle.mass.entry_kg": 300.0}}, "the parts weigh"),
        ({"belief": {"initial.speed_m_s": 100.0}}, "must be above"),
    ],
)
def test_impossible_case_is_refused(base, changes, words):
    with pytest.raises(ConfigError, match=words):
        Variants(base).build(Case(0, **changes))


def test_every_part_of_the_case_record_is_filled():
    assert set(records.PARTS) == set(records.CASE.names)
    assert set().union(*(part.sections for part in records.PARTS.values())) <= set(Scenario.model_fields)


def test_the_shipped_campaign_never_validates_a_section_again(monkeypatch):
    """Its cases cost a few milliseconds only on the short way."""
    plan = load_plan("tianwen1_mc")
    quick = Variants(plan.loaded)
    monkeypatch.setattr(variants, "_SECTIONS", dict.fromkeys(variants._SECTIONS))
    for case in plan.cases(0, 3):
        truth = quick.build(case).loaded.truth
        assert truth.vehicle.rcs.thrusters[3].thrust_n == case.truth["vehicle.rcs.thrusters.D4.thrust_n"]
