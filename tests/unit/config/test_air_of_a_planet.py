"""A scenario without an atmosphere has that of its planet; what a scenario gives stays."""

import pytest

import edl6dof
from edl6dof.scenario.loading import load_scenario

SCENARIO = """\
name: probe
planet: {planet}
vehicle: phoenix
terrain: {{model: none, site_latitude_deg: 0.0, site_longitude_deg: 12.0, site_elevation_m: 0.0}}
initial:
  {{altitude_m: 125e3, latitude_deg: 0, longitude_deg: 0, speed_m_s: 5500, flight_path_angle_deg: -13, azimuth_deg: 90}}
mission: {{goal: time}}
{more}
"""


def loaded(folder, planet, more=""):
    file = folder / "probe.yaml"
    file.write_text(SCENARIO.format(planet=planet, more=more), encoding="utf-8")
    return load_scenario(file)


@pytest.mark.parametrize(
    "planet, air, wind",
    [("mars", "table", "table"), ("earth", "us76", "none"), ("titan", "exponential", "none")],
)
def test_air_and_wind_are_those_of_the_planet(tmp_path, planet, air, wind):
    found = loaded(tmp_path, planet)
    assert (found.scenario.atmosphere.model, found.scenario.wind.model) == (air, wind)
    assert found.document.files[-1].name == f"{planet}.yaml" and found.document.files[-1].parent.name == "air"
    assert found.document.mark(("atmosphere", "model")).line > 0


def test_an_atmosphere_of_the_scenario_stays_and_brings_no_wind(tmp_path):
    own = "{density_kg_m3: 0.02, scale_height_m: 11e3, temperature_k: 210}"
    more = f"atmosphere: {{model: exponential, exponential: {own}}}\nwind: {{model: none}}"
    found = loaded(tmp_path, "mars", more).scenario
    assert (found.atmosphere.model, found.atmosphere.exponential.scale_height_m) == ("exponential", 11e3)
    assert found.wind.model == "none"


def test_a_wind_of_the_scenario_stays(tmp_path):
    found = loaded(
        tmp_path, "mars", "wind: {model: constant, constant: {north_m_s: 5, east_m_s: 0}}"
    ).scenario
    assert (found.atmosphere.model, found.wind.model) == ("table", "constant")


def test_no_shipped_scenario_relies_on_it():
    for name in ("tianwen1", "msl", "earth_drop", "titan_probe", "nesc/case01"):
        assert all(file.parent.name != "air" for file in edl6dof.load(name).document.files)
