"""Campaign files: what they mean, and what is refused with file and line before anything flies."""

# ruff: noqa: E501  (a mistake and its message read best on one line)
from __future__ import annotations

import re

import numpy as np
import pytest

from edl6dof.campaign.design.plan import load_plan, parse_plan
from edl6dof.config.errors import ConfigError
from edl6dof.scenario.loading import load_scenario

NOMINAL_KG = load_scenario("tianwen1").scenario.vehicle.mass.entry_kg
HEAD = "extends: tianwen1\nname: test\ncampaign:\n  cases: 40\n  seed: 5\n"


def plan(tmp_path, body, head=HEAD, **options):
    file = tmp_path / "c.yaml"
    file.write_text(head + body)
    return load_plan(str(file), **options)


def test_shipped_campaign_disperses_the_reference_quantities():
    shipped = load_plan("tianwen1_mc")
    assert shipped.count == 1000
    names = set(shipped.columns)
    assert {
        "truth.vehicle.mass.entry_kg",
        "truth.vehicle.rcs.thrusters.F6.thrust_n",
        "truth.vehicle.mass.entry_inertia_kg_m2.2",
    } <= names
    assert (
        shipped.loaded.scenario.wind.gust.enabled and shipped.loaded.scenario.atmosphere.perturbation.enabled
    )


def test_drawn_values_have_the_widths_of_the_file():
    shipped = load_plan("tianwen1_mc")
    values = {target.path: column for target, column in shipped.values(0, 1000)}
    assert values["vehicle.mass.entry_kg"].std() == pytest.approx(5.0, rel=0.01)
    assert values["vehicle.mass.entry_kg"].mean() == pytest.approx(NOMINAL_KG, abs=0.01)
    assert values["vehicle.rcs.thrusters.F1.thrust_n"].std() == pytest.approx(25.0 * 0.05 / 3.0, rel=0.01)
    inertia = np.stack([values[f"vehicle.mass.entry_inertia_kg_m2.{k}"] for k in range(3)])
    assert np.corrcoef(inertia)[0, 1:] == pytest.approx([0.9, 0.9], abs=0.02)
    assert inertia.std(axis=1) == pytest.approx([115.0 / 3, 90.0 / 3, 95.0 / 3], rel=0.05)


def test_plan_written_out_gives_the_same_cases(tmp_path):
    body = """\
  sampling: sobol
  truth: {vehicle.mass.entry_kg: {kind: normal, three_sigma: 15.0}, wind.scale: {kind: discrete, choices: [1.0, 2.0]}}
  belief: {vehicle.parachutes.main.drag_coefficient: {kind: uniform, half_width: 0.05}}
  faults: [{chance: 0.5, later_s: 20.0, one_of: [{kind: stuck_off, thruster: D7, at: {phase: lift}}]}]
sweep:
  axes: [{path: simulation.step_s, values: [0.01, 0.02]}]
"""
    first = plan(tmp_path, body)
    again = parse_plan(first.text, "again")
    assert again.text == first.text
    assert list(again.cases()) == list(first.cases())
    assert len(list(first.cases())) == first.count == 80


def test_pieces_are_those_of_the_whole_across_the_points_of_a_sweep(tmp_path):
    body = (
        "  truth: {wind.scale: {kind: uniform, low: 0.0, high: 2.0}}\nsweep:\n  axes: [{path: seed, "
        "values: [1, 2, 3]}]\n"
    )
    swept = plan(tmp_path, body)
    whole = list(swept.cases())
    assert [case.index for case in whole] == list(range(120))
    assert list(swept.cases(35, 85)) == whole[35:85]
    assert [case.belief["seed"] for case in whole[::40]] == [1, 2, 3]
    assert whole[0].truth == whole[40].truth == whole[80].truth, "common random numbers at every point"


def test_dispersed_belief_leaves_the_truth_at_its_nominal(tmp_path):
    dispersed = plan(tmp_path, "  belief: {vehicle.mass.entry_kg: {kind: normal, three_sigma: 30.0}}\n")
    assert dispersed.loaded.truth.vehicle.mass.entry_kg == NOMINAL_KG
    assert dispersed.loaded.scenario.truth == {"vehicle.mass.entry_kg": NOMINAL_KG}
    assert {case.belief["vehicle.mass.entry_kg"] for case in dispersed.cases()} - {NOMINAL_KG}


def test_dispersion_known_to_both_has_no_truth_of_its_own(tmp_path):
    case = next(
        plan(tmp_path, "  both: {vehicle.mass.entry_kg: {kind: normal, three_sigma: 30.0}}\n").cases()
    )
    assert not case.truth and "vehicle.mass.entry_kg" in case.belief


def test_faults_happen_with_their_chance(tmp_path):
    body = (
        "  faults: [{chance: 0.2, later_s: 9.0, one_of: [{kind: stuck_off, thruster: D7, at: {time_s: "
        "100.0}}, {kind: wing_lost, at: {phase: lift}}]}]\n"
    )
    faults = [case.truth.get("faults", []) for case in plan(tmp_path, body, cases=4000).cases()]
    happened = [fault for case in faults for fault in case]
    assert len(happened) / 4000 == pytest.approx(0.2, abs=0.02)
    assert sum(fault["kind"] == "wing_lost" for fault in happened) / len(happened) == pytest.approx(
        0.5, abs=0.06
    )
    times = [fault["at"]["time_s"] for fault in happened if fault["kind"] == "stuck_off"]
    assert 100.0 <= min(times) < 101.0 and 108.0 < max(times) <= 109.0


REFUSED = {
    "wrong path": ("  truth:\n    vehicle.mass.entry_mas: {kind: normal, sigma: 1.0}\n", 7, "unknown key"),
    "wrong list item": ("  truth:\n    vehicle.rcs.thrusters.Z9.thrust_n: {kind: normal, sigma: 1.0}\n", 7, "no entry named 'Z9'"),
    "no such kind": ("  truth:\n    wind.scale: {kind: gaussian, sigma: 1.0}\n", 7, "kind"),
    "two widths": ("  truth:\n    wind.scale: {kind: normal, sigma: 1.0, three_sigma: 2.0}\n", 7, "exactly one of sigma"),
    "no width": ("  truth:\n    wind.scale: {kind: normal, sigma: 0.0}\n", 7, "> 0"),
    "bounds the wrong way": ("  truth:\n    wind.scale: {kind: uniform, low: 2.0, high: 1.0}\n", 7, "low must be below high"),
    "nothing left": ("  truth:\n    wind.scale: {kind: truncated_normal, sigma: 0.1, low: 9.0}\n", 7, "leave nothing"),
    "beyond the bounds": ("  truth:\n    vehicle.aero.capsule.axial_factor: {kind: normal, sigma: 0.8}\n", 7, "truncated_normal or a smaller width"),
    "whole number": ("  truth:\n    sensors.imu.delay_cycles: {kind: normal, sigma: 1.0}\n", 7, "use kind discrete"),
    "no nominal": ("  truth:\n    initial.yaw_pitch_roll_deg.0: {kind: normal, sigma: 1.0}\n", 7, "yaw_pitch_roll_deg"),
    "log of nothing": ("  truth:\n    vehicle.mass.entry_centre_m.1: {kind: log_normal, sigma_ln: 0.1}\n", 7, "positive median"),
    "no truth of its own": ("  truth:\n    limits.slope_deg: {kind: normal, sigma: 1.0}\n", 7, "is no part of the true world or vehicle"),
    "twice": (("  truth: {wind.scale: {kind: normal, sigma: 0.1}}\n  both: {wind.scale: {kind: normal, sigma: "
        "0.1}}\n"), 7, "dispersed twice"),
    "impossible correlation": (
        ("  correlated:\n    - {paths: [wind.scale, vehicle.mass.entry_kg], three_sigma: [1.0, 1.0], "
            "correlation: [[1.0, 1.2], [1.2, 1.0]]}\n"),
        7, "positive definite",
    ),
    "wrong fault": (("  faults:\n    - {chance: 0.1, one_of: [{kind: stuck_off, "
        "thruster: D99, at: {phase: lift}}]}\n"), 7, "no thruster named"),
    "star elsewhere": ("  truth:\n    vehicle.mass.*: {kind: normal, sigma: 1.0}\n", 7, "items of a list"),
    "unknown key": ("  sampels: 10\n", 6, "unknown key"),  # codespell:ignore sampels
    "sweep and dispersion": (("  truth: {wind.scale: {kind: normal, sigma: 0.1}}\nsweep:\n  axes:\n    - {path: wind.scale, "
        "values: [1.0]}\n"), 9, "dispersed too"),
}  # fmt: skip


@pytest.mark.parametrize("body, line, words", REFUSED.values(), ids=REFUSED)
def test_mistakes_are_named_with_file_and_line(tmp_path, body, line, words):
    with pytest.raises(ConfigError) as error:
        plan(tmp_path, body)
    text = str(error.value)
    assert re.search(rf"c\.yaml:{line}:\d+: ", text), text
    assert words in text


def test_all_mistakes_are_named_at_once(tmp_path):
    body = (
        "  truth:\n    wind.scal: {kind: normal, sigma: 1.0}\n    vehicle.mas.entry_kg: {kind: normal, "
        "sigma: 1.0}\n"
    )
    with pytest.raises(ConfigError) as error:
        plan(tmp_path, body)
    assert len(error.value.problems) == 2


def test_extending_file_changes_what_it_says_and_nothing_else(tmp_path):
    file = tmp_path / "e.yaml"
    file.write_text(
        "extends: tianwen1\nname: other\nvehicle: {mass: {entry_kg: 1300.0}}\nlimits: {touchdown_tilt_deg: "
        "2.0}\n"
    )
    extended, base = load_scenario(str(file)).scenario, load_scenario("tianwen1").scenario
    assert extended.vehicle.mass.entry_kg == 1300.0 and extended.limits.touchdown_tilt_deg == 2.0
    assert extended.mission == base.mission and extended.vehicle.rcs == base.vehicle.rcs


@pytest.mark.parametrize(
    "text, words",
    [
        ("extends: nowhere\n", "no such scenario"),
        ("extends: e\n", "leads back"),
        ("extends: 3\n", "name or path"),
    ],
)
def test_extending_nothing_or_itself_is_refused(tmp_path, text, words):
    file = tmp_path / "e.yaml"
    file.write_text(text.replace("extends: e\n", f"extends: {file}\n"))
    with pytest.raises(ConfigError, match=words):
        load_scenario(str(file))


def test_mistake_in_an_extending_file_is_named_in_that_file(tmp_path):
    file = tmp_path / "e.yaml"
    file.write_text("extends: tianwen1\nname: other\nvehicle:\n  mass:\n    entry_kg: -1.0\n")
    with pytest.raises(ConfigError, match=r"e\.yaml:5:5: vehicle\.mass\.entry_kg"):
        load_scenario(str(file))
