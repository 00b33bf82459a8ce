"""What makes a vehicle what it is has no default: a file that leaves it out is refused."""

import pytest

from edl6dof.config.document.source import read_document
from edl6dof.config.errors import ConfigError
from edl6dof.scenario.loading import check_document, load_scenario

SIZES = {
    "parachutes": ("diameter_m", "drag_coefficient", "mortar_speed_m_s", "line_length_m", "confluence_m"),
    "engines": ("full_thrust_n", "full_specific_impulse_s", "nozzle_m", "throttle_max_n"),
    "surfaces": ("area_m2", "force_coefficient", "position_x_m", "position_z_m", "deploy_time_s"),
    "tanks": ("mass_kg",),
}


def refused_without(scenario, *path):
    """What is said of a shipped scenario without one key of its vehicle."""
    document = load_scenario(scenario).document
    inside = document.data["vehicle"]
    for key in path[:-1]:
        inside = inside[key]
    del inside[path[-1]]
    with pytest.raises(ConfigError) as caught:
        check_document(document)
    return str(caught.value)


@pytest.mark.parametrize(("things", "key"), [(things, key) for things, keys in SIZES.items() for key in keys])
def test_size_of_a_part_is_never_assumed(things, key):
    assert f"vehicle.{things}.0.{key}: " in refused_without("tianwen1", things, 0, key)


@pytest.mark.parametrize(
    ("scenario", "shape", "key"),
    [
        ("tianwen1", "capsule", "diameter_m"),
        ("msl_landing", "capsule", "nose_radius_m"),
        ("phoenix", "backshell", "reference_area_m2"),
        ("viking1", "lander", "drag_coefficient"),
        ("wu2013", "lift_drag", "lift_to_drag"),
        ("nesc/case03", "constant", "reference_area_m2"),
    ],
)
def test_shape_that_flies_is_never_another_vehicles(scenario, shape, key):
    assert f"vehicle.aero.{shape}.{key}: required key is missing" in refused_without(
        scenario, "aero", shape, key
    )


def test_canopy_of_a_new_name_is_refused_without_its_size(tmp_path):
    """One that is laid over another canopy is of the size of that one."""
    path = tmp_path / "mine.yaml"
    path.write_text("extends: tianwen1\nvehicle: {parachutes: [{name: second, drag_coefficient: 0.6}]}\n")
    with pytest.raises(ConfigError, match=r"mine.yaml:2:\d+: vehicle.parachutes.1.diameter_m: required key"):
        check_document(read_document(path))
