"""Profiles of users: pressure or density, metres or kilometres, any number of them, chosen by name."""

import numpy as np
import pytest

import edl6dof
from edl6dof.campaign.design.plan import load_plan
from edl6dof.campaign.identity import input_files
from edl6dof.config.errors import ConfigError
from edl6dof.environment.atmosphere_table import read_profile
from edl6dof.scenario.records import build_tables

ROWS = ((0.0, 700.0, 220.0), (1000.0, 640.0, 215.0), (2500.0, 560.0, 205.0))
PRESSURE = "h_m,T_K,P_Pa\n" + "".join(f"{h},{t},{p}\n" for h, p, t in ROWS)
DENSITY = "T_K,unread,rho_kgm3,h_km\n" + "".join(f"{t},x,{p / (191.0 * t)!r},{h / 1e3}\n" for h, p, t in ROWS)


def read(text):
    return read_profile("mine.csv", text.encode(), 191.0)


def test_pressure_and_density_metres_and_kilometres_mean_the_same():
    for one, other in zip(read(PRESSURE), read(DENSITY), strict=True):
        assert one == pytest.approx(other, rel=1e-14)
    assert read(PRESSURE).density == pytest.approx([p / (191.0 * t) for _, p, t in ROWS], rel=1e-14)
    assert not np.any(read(DENSITY).east)


@pytest.mark.parametrize(
    "text, words",
    [
        (PRESSURE.replace("P_Pa", "p_mbar"), "'rho' (density, kg/m3) or 'P_Pa' (pressure)"),
        (
            "T_C,rho\n1,2\n3,4\n",
            ":1:1: no column that begins with 'h_'; mine.csv:1:1: no column that begins with 'T_K'",
        ),
        (
            PRESSURE.replace("640.0", "").replace("205.0", "warm"),
            ":3:14: P_Pa: must be a finite number (got '');",
        ),
        (
            PRESSURE.replace("640.0", "").replace("205.0", "warm"),
            ":4:8: T_K: must be a finite number (got 'warm')",
        ),
        (PRESSURE.replace("640.0", "-640.0"), "densities be positive"),
        (PRESSURE.replace("215.0", "-5.0"), "temperatures and densities be positive"),
    ],
)
def test_every_mistake_is_named(text, words):
    with pytest.raises(ValueError, match="mine.csv:") as caught:
        read(text)
    assert words in str(caught.value)


@pytest.fixture
def profiles(tmp_path):
    """Overrides that name two files."""
    (tmp_path / "cold.csv").write_text(PRESSURE.replace("700.0", "690.0"))
    (tmp_path / "dusty.csv").write_text(DENSITY)
    return f"atmosphere.profiles={{cold: {tmp_path}/cold.csv, dusty: {tmp_path}/dusty.csv}}"


def test_profiles_are_chosen_by_name(profiles):
    cold, dusty = (
        edl6dof.load("tianwen1", [profiles, f"atmosphere.table={name}", "wind.model=none"])
        for name in ("cold", "dusty")
    )
    assert cold.scenario.atmosphere.table_file.endswith("cold.csv")
    tables = [build_tables(one.truth)[0]["atmosphere"] for one in (cold, dusty)]
    assert np.exp(tables[0]["ln_density"][0, 0]) > 0.0 and tables[0].tobytes() != tables[1].tobytes()


def test_a_broken_profile_is_found_where_it_is_named_even_if_none_flies_in_it(profiles, tmp_path):
    (tmp_path / "dusty.csv").write_text(DENSITY.replace("205.0", "?"))
    with pytest.raises(ConfigError) as caught:
        edl6dof.load("tianwen1", [profiles])
    (problem,) = caught.value.problems
    assert problem.path == "atmosphere.profiles.dusty" and ":4:1: T_K" in problem.message


def test_a_campaign_draws_among_them_and_counts_their_files_as_its_input(profiles, tmp_path):
    scenario = tmp_path / "many.yaml"
    section = profiles.partition("=")[2]
    scenario.write_text(
        f"extends: tianwen1\nwind: {{model: none}}\natmosphere: {{profiles: {section}}}\n"
        "campaign:\n  cases: 8\n  truth:\n"
        "    atmosphere.table: {kind: discrete, choices: [cold, dusty]}\n"
    )
    plan = load_plan(str(scenario))
    assert {"cold.csv", "dusty.csv"} <= {path.name for path in input_files(plan)}
