"""A case made in memory is the case that ``--set`` and ``truth:`` would make, bit for bit."""

from __future__ import annotations

import json

import numpy as np
import pytest
from pydantic import BaseModel

import edl6dof
from edl6dof.campaign.design import case as cases
from edl6dof.campaign.design.case import Case, Variants
from edl6dof.campaign.design.plan import load_plan
from edl6dof.config.document.overrides import apply_overrides
from edl6dof.config.errors import ConfigError
from edl6dof.scenario import records
from edl6dof.scenario.loading import check_document
from edl6dof.scenario.onboard import believe
from edl6dof.scenario.schema import Scenario
from edl6dof.vehicle.aerodynamics.capsule_table import FLOWN, AeroInputs, aero_inputs, build_aero_table

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
        "truth": {"vehicle.engines.main.thrust_factor": 0.98, "wind.gust.scale_length_m": 350.0}
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
    "with a truth of its own": ["truth={vehicle.mass.entry_kg: 1300.0, atmosphere.density_factor: 0.9}"],
}


def the_long_way(base, case):
    changes = case.changes(base.scenario.truth)
    texts = [f"{path}={json.dumps(value)}" for path, value in changes.items()]
    loaded = check_document(apply_overrides(base.document, texts, Scenario))
    return loaded, records.build_records(loaded)


@pytest.fixture(
    scope="module",
    params=[pytest.param(BASES["plain"], marks=pytest.mark.long), BASES["with a truth of its own"]],
    ids=BASES,
)
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


def test_parameters_applied_in_flight_do_not_enter_the_table_of_the_capsule():
    """What ``table.FLOWN`` promises: a case may share the table when only these change."""
    capsule, ratio = edl6dof.load("tianwen1").scenario.vehicle.aero.capsule, 1.3
    table = build_aero_table(aero_inputs(capsule, ratio))
    content = aero_inputs(capsule, ratio).content
    for name in FLOWN:
        changed = capsule.model_copy(update={name: getattr(capsule, name) * 1.01 + 0.001})
        assert build_aero_table(aero_inputs(changed, ratio)) is table, name
        anew = build_aero_table.__wrapped__(AeroInputs(changed, ratio, content))
        assert anew.tobytes() == table.tobytes(), name


def test_cases_share_tables_and_plans_until_an_input_of_theirs_changes(base):
    made = Variants(base)
    first, thin = made.build(Case(0)), made.build(Case(1, truth={"atmosphere.density_factor": 0.9}))
    blunt = made.build(Case(2, truth={"vehicle.aero.capsule.nose_radius_m": 0.8}))
    assert thin.parts.tables is first.parts.tables
    assert blunt.parts.tables is not first.parts.tables
    assert thin.loaded.truth.mission is base.scenario.mission


def test_a_table_that_changes_on_disk_is_read_again(tmp_path):
    table = tmp_path / "air.csv"
    rows = "h_km,rho,T_K\n0.0,{},210.0\n1.0,1.4e-2,209.0\n2.0,1.3e-2,208.0\n"
    table.write_text(rows.format("1.5e-2"))
    changes = ["atmosphere.model=table", f"atmosphere.table={table}", "wind.model=none"]
    changes.append("flight_software.guidance.entry.expected_wind.table_factor=0")
    made = Variants(edl6dof.load("tianwen1", changes))
    before = made.build(Case(0)).parts
    table.write_text(rows.format("1.6e-2"))
    after = made.build(Case(0)).parts
    assert not np.array_equal(before.tables, after.tables)
    assert not np.array_equal(before.onboard["atmosphere"], after.onboard["atmosphere"])


def test_plans_do_not_leak_into_each_other():
    scenario = edl6dof.load("tianwen1").scenario
    one = records.build_onboard(scenario)
    one["imu_delay"] = -1.0
    assert records.build_onboard(scenario)["imu_delay"] >= 0.0


@pytest.mark.parametrize("section", sorted(Scenario.model_fields.keys() - records.BELIEVED))
def test_belief_follows_from_what_is_declared_alone(section):
    """What ``records.BELIEVED`` promises: the plan is kept by these sections only."""
    scenario = edl6dof.load("tianwen1").scenario
    without = scenario.model_copy(update={section: None})
    assert (
        believe(without, records.build_tables(scenario)).tobytes()
        == records.build_onboard(scenario).tobytes()
    )


@pytest.mark.parametrize("name", ["tianwen1_mc", "msl_mc", "stardust_mc"])
def test_every_dispersion_alone_changes_what_flies(name):
    """The classic failure of Monte Carlo tools: a dispersion that nobody applies."""
    plan = load_plan(name)
    made, case = Variants(plan.loaded), next(plan.cases(0, 1))
    nominal = made.nominal
    for path, value in case.truth.items():
        alone = made.build(Case(0, truth={path: value}))
        assert world(alone) != world(nominal), path
        assert alone.parts.onboard.tobytes() == nominal.parts.onboard.tobytes(), path
    for path, value in case.belief.items():
        alone = made.build(Case(0, belief={path: value}))
        assert alone.parts.onboard.tobytes() != nominal.parts.onboard.tobytes(), path


def world(variant):
    """What the flight computer is not told: case, tables, and where the flight begins."""
    case, tables, _ = variant.parts
    plant = records.initial_plant(variant.loaded.truth, case)
    return case.tobytes(), tables.tobytes(), plant.tobytes()


@pytest.mark.parametrize(
    "changes, words",
    [
        ({"truth": {"vehicle.mass.entry_mass_kg": 1.0}}, "unknown key"),
        ({"truth": {"vehicle.mass.entry_kg": -5.0}}, "must be > 0 kg"),
        ({"truth": {"vehicle.mass.entry_kg": 300.0}}, "parts and propellant weigh"),
        ({"belief": {"initial.speed_m_s": 100.0}}, "must be above"),
    ],
)
def test_impossible_case_is_refused(base, changes, words):
    with pytest.raises(ConfigError, match=words):
        Variants(base).build(Case(0, **changes))


REFUSED = {
    "a bound": {"truth": {"vehicle.rcs.thrusters.D3.thrust_n": -1.0}},
    "a bound of the unit": {"truth": {"initial.altitude_m": 1e300}},
    "a fraction for a whole number": {"belief": {"simulation.log_every": 1.5}},
    "no number for a number": {"truth": {"wind.scale": True}},
    "an element too many": {"truth": {"vehicle.mass.entry_inertia_kg_m2": [1.0, 2.0, 3.0, 4.0]}},
    "a check of a field": {"truth": {"vehicle.engines.main.direction": [-1.0, 0.5, 0.0]}},
    "a check of a model": {"truth": {"wind.gust.altitudes_m.0": 30e3}},
    "a check of the model around": {"truth": {"vehicle.engines.main.throttle_max_n": 9000.0}},
    "a check of sections": {"belief": {"simulation.step_s": 0.0123}},
    "an item that is not there": {"truth": {"vehicle.rcs.thrusters.-1.thrust_n": 250.0}},
    "a key that is not there": {"truth": {"initial.speed": 4000.0}},
    "inside a number": {"truth": {"initial.speed_m_s.real": 4000.0}},
    "no truth": {"truth": {"mission.phases.0.bandwidth": 1.5}},
}


@pytest.mark.parametrize("changes", REFUSED.values(), ids=REFUSED)
def test_a_case_is_refused_in_the_words_of_the_whole_check(base, changes):
    case = Case(0, **changes)
    with pytest.raises(ConfigError) as quick:
        Variants(base).build(case)
    with pytest.raises(ConfigError) as whole:
        cases.scenario_of(base, case)
    assert [(one.path, one.message) for one in quick.value.problems] == [
        (one.path, one.message) for one in whole.value.problems
    ]


@pytest.mark.parametrize("name", ["tianwen1", "msl"])
def test_validating_again_changes_nothing(name):
    """What cases rely on: the other numbers of a model that a case changes keep their bits."""
    scenario = edl6dof.load(name).scenario
    assert again(scenario) == scenario


def again(value):
    """Every model inside made from its own values."""
    if isinstance(value, BaseModel):
        return type(value).model_validate({key: again(inside) for key, inside in vars(value).items()})
    return [again(item) for item in value] if isinstance(value, list) else value


def test_the_shipped_campaign_never_checks_a_whole_document_again(monkeypatch):
    """Its cases cost a few milliseconds only as overrides of the nominal."""
    plan = load_plan("tianwen1_mc")
    made = Variants(plan.loaded)
    monkeypatch.setattr(cases, "check_document", None)
    for case in plan.cases(0, 3):
        truth = made.build(case).loaded.truth
        assert truth.vehicle.rcs.thrusters[3].thrust_n == case.truth["vehicle.rcs.thrusters.D4.thrust_n"]
