"""A file of the package, under another name, is a plugin: one for each family of the world is accepted, and
each mistake is named in one line.
"""

import ast
import json
from pathlib import Path

import pytest
from test_plugins import cli

import edl6dof
from edl6dof.config.plugin_files import accept
from edl6dof.scenario.loading import viewed_scenario

PACKAGE = Path(edl6dof.__file__).parent
AIR = {"density_kg_m3": 0.02, "scale_height_m": 9e3, "temperature_k": 200.0}

#: The member of families whose members share a file, and the base class of all distributions.
SHARED = {
    **{"atmosphere": "EXPONENTIAL", "wind": "SHEAR", "parachute_model": "REEFED", "engine_model": "PULSED"},
    "distribution": "UNIFORM",
}
BASE = "DistributionParams"
#: What the navigation filter cannot do without.
INSTRUMENTS = ("inertial_unit", "star_tracker", "ground_tracking")
#: From the ground up: FAMILY, the file of a member, its name there and as a plugin, and the sections of a
#: scenario that choose it.
FAMILIES = [
    (
        *("atmosphere", "environment/atmosphere_models.py", "exponential", "isothermal"),
        {"atmosphere": {"model": "isothermal", "isothermal": AIR}},
    ),
    (
        *("wind", "environment/wind_models.py", "shear", "gradient"),
        {"wind": {"model": "gradient", "gradient": {"east_m_s": 3.0}}},
    ),
    (
        *("parachute_model", "vehicle/parachutes/canopy_models.py", '"reefed"', '"skirt"'),
        {
            "truth": {
                "vehicle.parachutes.main.model": "skirt",
                "vehicle.parachutes.main.skirt.filling_exponent": 2.0,
            }
        },
    ),
    (
        *("engine_model", "vehicle/propulsion/engine_models.py", '"pulsed"', '"bang_bang"'),
        {
            "truth": {
                "vehicle.engines.main.model": "bang_bang",
                "vehicle.engines.main.bang_bang.period_s": 0.2,
            }
        },
    ),
    (
        *("sensor", "sensors/imu.py", '"imu"', '"imu_b"'),
        {"sensors": {"carried": ["perfect", *INSTRUMENTS, "imu_b"]}},
    ),
    (
        *("navigation_filter", "fsw/navigation/filters/dead_reckoning.py", '"dead_reckoning"', '"unaided"'),
        {"flight_software": {"navigation": {"filter": "unaided", "unaided": {"every_s": 2.0}}}},
    ),
    (
        *("distribution", "campaign/design/distributions.py", "uniform", "level"),
        {"campaign": {"cases": 5, "truth": {"wind.scale": {"kind": "level", "half_width": 0.2}}}},
    ),
]


def source(family, member):
    """Source of a plugin: the file of a member; of families whose members share a file, the imports and all
    that one member needs.
    """
    text = (PACKAGE / member).read_text(encoding="utf-8")
    if family not in SHARED:
        return text
    body = [node for node in ast.parse(text).body if not isinstance(node, ast.If)]
    nodes = {}
    for node in body:
        names = [
            one.id for one in ast.walk(node) if isinstance(one, ast.Name) and isinstance(node, ast.Assign)
        ]
        nodes[getattr(node, "name", names[0] if names else "")] = node
    needed, found = [SHARED[family]], {}
    while needed:
        one = needed.pop()
        found[one] = nodes[one]
        used = {node.id for node in ast.walk(nodes[one]) if isinstance(node, ast.Name)}
        needed += sorted(used & nodes.keys() - found.keys() - {BASE})
    imports = [node for node in body if isinstance(node, ast.Import | ast.ImportFrom)]
    lines, kept = text.splitlines(), sorted((*imports, *found.values()), key=lambda node: node.lineno)
    begin = [
        min([node.lineno, *(one.lineno for one in getattr(node, "decorator_list", []))]) for node in kept
    ]
    blocks = ["\n".join(lines[a - 1 : node.end_lineno]) for a, node in zip(begin, kept, strict=True)]
    if BASE in nodes:
        blocks.insert(1, f"from edl6dof.{member[:-3].replace('/', '.')} import {BASE}")
    return "\n\n".join([*blocks, f"MEMBER = {SHARED[family]}", ""])


def checked(folder, *members):
    """What the program says of a scenario that chooses a member outside the package of each family."""
    sections = {"extends": "tianwen1", "name": "mine", "plugins": []}
    for family, member, old, new, chosen in members:
        text = source(family, member)
        assert old in text
        file = folder / f"my_{family}.py"
        file.write_text(f'{text.replace(old, new)}\nFAMILY = "{family}"\n', encoding="utf-8")
        accept(file, file.read_bytes())
        sections["plugins"].append(f"my_{family}.py")
        for section, values in chosen.items():
            sections[section] = {**sections.get(section, {}), **values}
    lines = [f"{name}: {json.dumps(value)}" for name, value in sections.items()]
    (folder / "mine.yaml").write_text("\n".join([*lines, ""]), encoding="utf-8")
    return cli("check", folder / "mine.yaml")


@pytest.mark.parametrize(
    "names",
    [
        ("atmosphere", "engine_model", "distribution"),
        pytest.param(tuple(row[0] for row in FAMILIES), marks=pytest.mark.long),
    ],
    ids=["three", "all"],
)
def test_members_outside_the_package_are_chosen_by_their_names(tmp_path, names):
    """One of each family, all in one scenario: one that is not accepted would be refused by its line."""
    status, out, error = checked(tmp_path, *(row for row in FAMILIES if row[0] in names))
    assert (status, error) == (0, "")
    assert "mine.yaml: ok" in out


def mistaken(family, before, after):
    """A member that is chosen, its file's text with a mistake in the place of what is right."""
    family, member, old, new, chosen = next(row for row in FAMILIES if row[0] == family)
    text = source(family, member)
    wrong = text.replace(old, new).replace(before, after)
    assert before in text.replace(old, new)
    return family, member, text, wrong, chosen


@pytest.mark.long
def test_each_mistake_is_refused_in_one_line(tmp_path):
    """The goal of an engine that is no line, a sensor that writes what does not cross."""
    line = "return line_in_step(engine.full_thrust * first, engine.full_thrust * second, step)"
    engine = mistaken("engine_model", line, "return engine.full_thrust * first / step")
    sensor = mistaken("sensor", "sensed.imu_gain_B", "sensed.gain_B")
    status, _, error = checked(tmp_path, engine, sensor)
    assert status == 2
    lines = error.strip().splitlines()
    assert len(lines) == 2 and "my_engine_model.py" in lines[0] and "my_sensor.py" in lines[1]
    assert "goal: must return two numbers: mean and slope" in lines[0]
    assert "uses a field that its records do not have" in lines[1]


def resolved(name):
    """A shipped scenario as a run with a plugin holds it."""
    given = edl6dof.load(name).scenario.model_dump(mode="json", exclude_none=True)
    return given | {"plugins": ["skirt.py"]}


def viewed(given):
    return viewed_scenario(json.dumps(given), "received.yaml").scenario


@pytest.mark.parametrize("name", ["tianwen1_hazards", "msl_landing", "titan_probe"])
def test_result_whose_plugin_brings_nothing_is_shown_whole(name):
    assert viewed(resolved(name)) == edl6dof.load(name).scenario


def test_result_with_models_that_only_a_plugin_has_is_shown_without_them():
    given = resolved("tianwen1")
    given["vehicle"]["parachutes"][0] |= {"model": "skirt", "skirt": {"filling_exponent": 2.0}}
    given["vehicle"]["engines"][0] |= {"model": "bang_bang", "bang_bang": {"period_s": 0.2}}
    software = given["flight_software"]
    software["guidance"]["entry"] |= {"law": "mine", "mine": {"gain": 1.0}}
    software["guidance"]["powered"] |= {"law": "mine", "mine": {"gain": 1.0}}
    software["control"]["mine"] = {"gain": 1.0}
    software["navigation"] |= {"filter": "mine", "mine": {"gain": 1.0}}
    given["atmosphere"] |= {"model": "mine", "mine": {"density": 1.0}}
    given["wind"] |= {"model": "mine", "mine": {"east_m_s": 1.0}}
    given["sensors"] |= {"carried": [*given["sensors"]["carried"], "mine"], "mine": {"noise": 1.0}}
    given["mission"]["phases"][1]["control"] = "mine"
    given["faults"] = [{"kind": "mine", "thruster": "D7", "at": {"time_s": 1.0}, "mine": {"share": 1.0}}]
    shown, own = viewed(given), edl6dof.load("tianwen1").scenario
    assert (shown.vehicle.parachutes[0].model, shown.vehicle.engines[0].model) == (
        "disk_gap_band",
        "throttled",
    )
    assert (shown.atmosphere.model, shown.wind.model) == ("us76", "none")
    assert shown.mission.phases[1].control == "off" and shown.faults == []
    assert shown.sensors.carried == type(shown.sensors)().carried
    assert shown.mission.phases[2:] == own.mission.phases[2:]


def test_distribution_without_its_kind_is_refused_in_one_line(tmp_path):
    family, member, _, _, chosen = FAMILIES[-1]
    names = 'Member("uniform"', 'Member("level"'
    status, _, error = checked(tmp_path, (family, member, *names, chosen))
    assert status == 2
    assert "with kind: Literal['level']" in error and len(error.strip().splitlines()) == 1
