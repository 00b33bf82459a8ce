"""The package asks for the role of a phase, never for its name: no module holds the name of a phase of a
shipped scenario.
"""

from __future__ import annotations

import ast
import re

import pytest
from source_rules import modules, nodes

import edl6dof
from edl6dof.config.document.locate import shipped_names

#: Modules in which the word means something else, and the words.
OTHER_MEANINGS = {
    "edl6dof.campaign.covariance_flights": {"parachute"},  # an event, as in the next one
    "edl6dof.cli.campaigns": {"parachute"},
    # field of a record: a force, as in the next ones
    "edl6dof.fsw.guidance.entry.air_data": {"lift"},
    "edl6dof.fsw.guidance.entry.airframe": {"lift"},
    "edl6dof.fsw.guidance.entry.laws.etpc": {"lift"},
    "edl6dof.fsw.guidance.entry.drag_velocity": {"coast"},  # field: a range, as in the next one
    "edl6dof.fsw.guidance.entry.reference": {"coast"},
    "edl6dof.fsw.navigation.derived": {"lift"},
    "edl6dof.scenario.planned_entry": {"lift"},
    "edl6dof.scenario.onboard_vehicle": {"lift"},
    "edl6dof.gym.tasks": {"slow_descent", "landed"},  # of the flight that its task is made of
    "edl6dof.sim.commands": {"lift"},  # what is measured
    "edl6dof.replay.scene.arrows": {"lift"},  # the arrow of the force
    "edl6dof.report.catalogue": {"parachute"},  # key of a figure
    "edl6dof.report.flight.common": {"parachute"},  # word at the mortar's mark, as in the next one
    "edl6dof.report.flight.landing": {"parachute"},
    "edl6dof.sim.termination": {"landed"},  # an outcome, as in the next one
    "edl6dof.sim.outcome": {"landed"},
    "edl6dof.studies.hu2022": {"landed"},  # column of a table
    "edl6dof.vehicle.faults.component": {"parachute"},  # kind of component
    "edl6dof.vehicle.plant": {"parachute"},  # field of a record
}
#: The list of roles, which takes its words from what phases are usually called.
ROLES = "edl6dof.interface.roles"


@pytest.fixture(scope="module")
def names():
    found = {
        name
        for scenario in shipped_names("scenarios")
        if "plugin" not in scenario
        for name in edl6dof.load(scenario).scenario.phase_names
    }
    assert len(found) > 5
    return found


def phase_names_in(source, names):
    """Strings of a source that are the name of a phase, or its event or its trigger."""
    named = re.compile(rf"\bphase[.:] ?({'|'.join(map(re.escape, names))})\b")
    texts = [
        node.value for node in nodes(source) if isinstance(node, ast.Constant) and isinstance(node.value, str)
    ]
    return {text for text in texts if text in names} | {
        match[1] for text in texts for match in named.finditer(text)
    }


def test_no_module_holds_the_name_of_a_phase(names):
    found = {module: phase_names_in(source, names) for module, source in modules()}
    assert {module: words for module, words in found.items() if words and module != ROLES} == OTHER_MEANINGS


def test_planted_names_are_found(names):
    for text in ("lift", "phase.hover_imaging", "faults=[{at: {phase: hazard_avoidance}}]"):
        assert phase_names_in(f"x = {text!r}", names)
    assert not phase_names_in("x = 'trim_aoa_limit_cycle_deg'\ny = 'aerolift'", names)
