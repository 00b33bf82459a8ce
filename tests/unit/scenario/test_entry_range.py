"""A site that the entry cannot reach gives a warning: shipped sites never, sites moved away always."""

from math import degrees

import pytest
from scipy.integrate import solve_ivp

import edl6dof
from edl6dof.config.document.locate import shipped_names
from edl6dof.scenario.entry_range import DRAG, SLOW, flown

NAMES = [name for name in shipped_names("scenarios") if "/" not in name and not name.endswith("_mc")]


def about_site(warnings):
    return [line for line in warnings if "beyond the estimated range" in line]


@pytest.mark.parametrize("name", NAMES)
def test_no_shipped_site_gives_a_warning(name):
    assert not about_site(edl6dof.load(name).warnings)


@pytest.mark.parametrize(
    "name, north_deg, east_deg, words",
    [
        ("tianwen1", -9.0, 0.0, "1,295 km ahead"),
        ("tianwen1", 9.0, 0.0, "230 km ahead"),
        ("tianwen1", -5.066, 0.075, "km ahead"),  # 300 km: 20 N, 110 E
        ("tianwen1", 0.0, 12.0, "km to the left"),
        ("phoenix", 0.0, 40.0, "km ahead"),
        ("schiaparelli", 0.0, 10.0, "km ahead"),
    ],
)
def test_a_site_moved_by_hundreds_of_kilometres_does(name, north_deg, east_deg, words):
    site = edl6dof.load(name).scenario.terrain
    moved = edl6dof.load(
        name,
        [
            f"terrain.site_latitude_deg={site.site_latitude_deg + north_deg}",
            f"terrain.site_longitude_deg={site.site_longitude_deg + east_deg}",
        ],
    )
    (line,) = about_site(moved.warnings)
    assert "terrain.site_latitude_deg" in line and words in line and "design aim" in line


@pytest.mark.parametrize("lift_to_drag", [-0.3, 0.0, 0.3])
def test_range_is_that_of_the_planar_equations_by_scipy(lift_to_drag):
    """Cartesian coordinates in the plane of motion, adaptive steps."""
    import numpy as np

    scenario, size = edl6dof.load("tianwen1").scenario, 1.7
    planet, start, air = scenario.planet, scenario.initial, scenario.atmosphere.exponential
    radius, ballistic = planet.mean_radius_m, scenario.vehicle.mass.entry_kg / (DRAG * np.pi * size**2)

    def rates(t, s):
        r, v = s[:2], s[2:]
        speed = np.linalg.norm(v)
        density = air.density_kg_m3 * np.exp((radius - np.linalg.norm(r)) / air.scale_height_m)
        drag = 0.5 * density * speed / ballistic * v
        lift = lift_to_drag * np.array([-drag[1], drag[0]])
        return np.concatenate([v, -drag + lift - planet.gravity.mu_m3_s2 * r / np.linalg.norm(r) ** 3])

    def slow(t, s):
        return np.linalg.norm(s[2:]) - SLOW

    slow.terminal = True
    angle = np.radians(start.flight_path_angle_deg)
    first = [0.0, radius + start.altitude_m, start.speed_m_s * np.cos(angle), start.speed_m_s * np.sin(angle)]
    path = solve_ivp(rates, (0.0, 3000.0), first, events=slow, rtol=1e-9, atol=1e-3)
    end = np.degrees(np.arctan2(path.y[0, -1], path.y[1, -1]))
    assert degrees(flown(scenario, size, lift_to_drag) / radius) == pytest.approx(end, rel=2e-3)
