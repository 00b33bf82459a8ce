"""``--set``."""

from __future__ import annotations

import pytest
from config_toy import GOOD, LEAST, Toy, document, write

from edl6dof.config.document.overrides import apply_overrides
from edl6dof.config.document.source import read_document
from edl6dof.config.errors import ConfigError
from edl6dof.config.validate import validate


def changed(*overrides: str, text: str = GOOD) -> Toy:
    return validate(Toy, apply_overrides(document(text), overrides, Toy))


def refusal(*overrides: str, text: str = GOOD) -> str:
    with pytest.raises(ConfigError) as caught:
        changed(*overrides, text=text)
    return str(caught.value)


def test_values_follow_the_rules_of_the_files():
    assert changed("vehicle.mass.entry_mass_kg=1.3e3").vehicle.mass.entry_mass_kg == 1300.0
    assert changed("logging=false").logging is False
    assert changed("title=on").title == "on"
    assert changed("title='12'").title == "12"
    assert changed("title=a=b").title == "a=b"
    assert changed("window_s=[1, 2]").window_s == (1.0, 2.0)
    assert changed("stop_s=null").stop_s is None
    assert changed("gains={a: 1}").gains == {"a": 1.0}


def test_defaults_that_the_file_leaves_out_can_be_set():
    settings = (
        "vehicle.chute.deploy_mach=2",
        "guidance.gain=3",
        "gains.new=1",
        "window_s.1=20",
        "plugin.any.component=x",
    )
    toy = changed(*settings, text=LEAST)
    assert toy.vehicle.chute.deploy_mach == 2.0
    assert toy.vehicle.chute.drag_table == ((0.0, 0.6), (2.0, 0.5))
    assert toy.guidance.gain == 3.0
    assert toy.gains == {"new": 1.0}
    assert toy.window_s == (0.0, 20.0)
    assert toy.plugin == {"any": {"component": "x"}}


def test_list_items_are_chosen_by_index_or_name():
    rcs = "vehicle.rcs.thrusters"
    toy = changed(f"{rcs}.0.thrust_n=1", f"{rcs}.D8.thrust_n=0", f"{rcs}.D8.position_m.2=5")
    assert [thruster.thrust_n for thruster in toy.vehicle.rcs.thrusters] == [1.0, 0.0]
    assert toy.vehicle.rcs.thrusters[1].position_m == (0.0, 1.0, 5.0)


def test_later_overrides_win_and_the_document_is_left_alone():
    read = document()
    result = apply_overrides(read, ["seed=8", "seed=9"], Toy)
    assert (result.data["seed"], read.data["seed"]) == (9, 7)


def test_another_law_starts_from_its_own_defaults():
    text = "guidance: {law: apollo, gain: 9}\n" + LEAST
    toy = changed("guidance.law=predictor", "guidance.step_s=3", text=text)
    assert toy.guidance.model_dump() == {"law": "predictor", "step_s": 3.0}
    assert changed("guidance.law=apollo", text=text).guidance.gain == 9.0


def test_problems_of_a_set_value_point_at_the_option():
    assert refusal("vehicle.chute.deploy_mach=9") == (
        "--set vehicle.chute.deploy_mach=9: vehicle.chute.deploy_mach: must be > 0 and <= 2.5 (got 9)"
    )
    assert refusal("window_s=[1, x]").startswith("--set window_s=[1, x]: window_s.1: must be a number")


REFUSED = {
    "seed": "must have the form path.to.key=value",
    "=3": "must have the form",
    "vehicle..mass=3": "must have the form",
    ".seed=3": "must have the form",
    "": "must have the form",
    "seed=": "no value after '='",
    "title=[1": "not valid YAML",
    "seed=.nan": "finite",
    "sed=3": "did you mean 'seed'?",
    "vehicle.mass.entry_mass_t=1": "did you mean 'entry_mass_kg'?",
    "vehicle.mas.entry_mass_kg=1": "did you mean 'mass'?",
    "seed.x=1": "seed is a single value",
    "window_s.2=1": "no entry 2: the list has 2",
    "window_s.x=1": "no entry named 'x'; use its index",
    "vehicle.rcs.thrusters.D9.thrust_n=1": "names: D7, D8",
    "vehicle.rcs.thrusters.left.thrust_n=1": "names: D7, D8",
    "vehicle.rcs.thrusters.2.thrust_n=1": "no entry 2",
    "vehicle.rcs.thrusters.-1.thrust_n=1": "no entry named '-1'",
    "vehicle.rcs.thrusters.D7.thrust=1": "did you mean 'thrust_n'?",
}


@pytest.mark.parametrize("override", REFUSED)
def test_malformed_overrides_and_unknown_paths_are_refused(override):
    message = refusal(override)
    assert REFUSED[override] in message
    assert message.startswith(f"--set {override}: ")
    assert "\n" not in message


@pytest.mark.parametrize(
    ("path", "meant"),
    [
        ("fuel_fraction", "vehicle.mass.fuel_fraction"),
        ("vehicle.fuel_fraction", "vehicle.mass.fuel_fraction"),
        ("mass.entry_mas_kg", "vehicle.mass.entry_mass_kg"),
        ("vehicle.mass.fuel_fraction.share", "vehicle.mass.fuel_fraction"),
    ],
)
def test_a_path_that_leads_nowhere_is_answered_by_a_whole_one(path, meant):
    with pytest.raises(ConfigError, match=rf"did you mean '{meant}'\?"):
        changed(f"{path}=0.1")


def test_all_refused_overrides_are_reported_together():
    assert len(refusal("sed=1", "seed=", "nothing").splitlines()) == 3


def test_an_override_inside_a_wrong_value_is_refused():
    assert "cannot set 'mass' inside 3" in refusal("vehicle.mass.entry_mass_kg=1", text="vehicle: 3\n")


def test_the_claim_of_a_replaced_value_is_dropped():
    status = apply_overrides(document(), ["vehicle.mass.cg_m.0=1"], Toy).status
    assert "vehicle.mass.cg_m" not in status
    assert "vehicle.mass.entry_mass_kg" in status
    assert not [path for path in apply_overrides(document(), ["vehicle.rcs={}"], Toy).status if "rcs" in path]


def test_an_include_key_can_name_another_file(tmp_path):
    write(tmp_path, "vehicles/small.yaml", "mass: {entry_mass_kg: 2.0}  # [P]\n")
    write(tmp_path, "vehicles/large.yaml", "mass:\n  entry_mass_kg: 3.0\n")
    read = read_document(write(tmp_path, "scenarios/a.yaml", "vehicle: small\n"))
    result = apply_overrides(read, ["vehicle=large", "vehicle.mass.fuel_fraction=0.5"], Toy)
    assert validate(Toy, result).vehicle.mass.model_dump() == {
        "entry_mass_kg": 3.0,
        "cg_m": (0.0, 0.0, 0.1),
        "fuel_fraction": 0.5,
    }
    assert result.marks["vehicle", "mass", "entry_mass_kg"].file.endswith("large.yaml")
    assert result.status == {}
    with pytest.raises(ConfigError, match=r"^--set vehicle=larg: vehicle: no such file; did you mean large"):
        apply_overrides(read, ["vehicle=larg"], Toy)
