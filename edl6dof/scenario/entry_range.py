"""An estimate of the range of an entry, for a warning when the landing site lies elsewhere.

A point mass flies over a sphere without rotation in exponential air, once with its lift down and once with
its lift up.  Drag coefficient and lift-to-drag ratio are those of a blunt body whose force stays nearly along
its axis: the ratio is below the tangent of the trim angle of attack (Mars Science Laboratory 0.24 at 16 deg).
The margins cover the effects that this model leaves out.
"""

from __future__ import annotations

from math import pi, radians

from edl6dof.scenario.schema import Scenario
from edl6dof.spatial.elementary import cos, exp, sin, tan
from edl6dof.spatial.frames import great_circle

#: Drag coefficient.
DRAG = 1.5
#: Slowest entry that is estimated, and speed at which it ends, m/s.
FAST, SLOW = 1500.0, 300.0
#: Step (s), and longest entry.
STEP, LONGEST = 2.0, 3000.0
#: Margins: share of the range, and metres.
SHARE, METRES = 0.1, 20e3


def out_of_range(scenario: Scenario, radius_m: float) -> str:
    """Describe by how much the landing site lies outside what the entry can reach; empty if it may reach it.

    Args:
        scenario: validated scenario.
        radius_m: radius of the vehicle; 0 if it is not known.
    """
    initial = scenario.initial
    slow = initial.speed_m_s is None or initial.speed_m_s < FAST or initial.azimuth_deg is None
    if slow or radius_m == 0.0 or scenario.atmosphere.exponential is None:
        return ""
    guided = any(phase.guidance == "entry" for phase in scenario.mission.phases)
    lift = abs(tan(radians(scenario.flight_software.guidance.entry.trim_alpha_deg))) if guided else 0.0
    shortest, longest = (flown(scenario, radius_m, ratio) for ratio in (-lift, lift))
    distance, bearing = great_circle(initial.place, scenario.site_place)
    if distance == 0.0:  # a mission without a site
        return ""
    off = bearing - radians(initial.azimuth_deg or 0.0)
    along, across = scenario.planet.mean_radius_m * distance * cos(off), distance * sin(off)
    low, high = (1.0 - SHARE) * shortest - METRES, (1.0 + SHARE) * longest + METRES
    aside = abs(scenario.planet.mean_radius_m * across)
    if low <= along <= high and aside <= SHARE * longest + METRES:
        return ""
    side = "right" if across > 0.0 else "left"
    place = f"lies {along / 1e3:,.0f} km ahead and {aside / 1e3:,.0f} km to the {side} of the entry point"
    reach = f"{max(low, 0.0) / 1e3:,.0f} to {high / 1e3:,.0f} km"
    return (
        f"the site {place}, beyond the estimated range of this entry, {reach}; "
        "edl6dof design aim finds an entry point that reaches the site"
    )


def flown(scenario: Scenario, radius_m: float, lift_to_drag: float) -> float:
    """Range (m) over the sphere of a planar entry with a constant lift-to-drag ratio; midpoint rule."""
    planet, initial, air = scenario.planet, scenario.initial, scenario.atmosphere.exponential
    radius, mu = planet.mean_radius_m, planet.gravity.mu_m3_s2
    ballistic = scenario.vehicle.mass.entry_kg / (DRAG * pi * radius_m * radius_m)
    angle = radians(initial.flight_path_angle_deg or 0.0)
    speed = initial.speed_m_s or 0.0
    height = initial.altitude_m if initial.altitude_m is not None else initial.height_above_areoid_m or 0.0

    def rates(h: float, v: float, gamma: float) -> tuple[float, float, float, float]:
        r = radius + h
        drag = 0.5 * air.density_kg_m3 * exp(-h / air.scale_height_m) * v * v / ballistic
        gravity = mu / (r * r)
        turn = lift_to_drag * drag / v + (v / r - gravity / v) * cos(gamma)
        return v * sin(gamma), -drag - gravity * sin(gamma), turn, v * cos(gamma) * radius / r

    covered, t = 0.0, 0.0
    while speed > SLOW and height > -10e3 and t < LONGEST:
        half = [0.5 * STEP * rate for rate in rates(height, speed, angle)]
        full = rates(height + half[0], speed + half[1], angle + half[2])
        height, speed, angle = height + STEP * full[0], speed + STEP * full[1], angle + STEP * full[2]
        covered, t = covered + STEP * full[3], t + STEP
    return covered
