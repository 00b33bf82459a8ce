"""Scenario files to start from: a capsule, and a campaign that disperses a scenario."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import cos, pi, sin, sqrt
from string import Template
from typing import TYPE_CHECKING

from edl6dof.config.document.locate import PACKAGE

if TYPE_CHECKING:
    from edl6dof.scenario.schema import Scenario

TEMPLATES = PACKAGE / "data" / "new"
#: Mass and diameter of the canopy of Mars Pathfinder, from which a capsule is scaled.
LIKE_KG, LIKE_CANOPY_M = 585.3, 12.5
#: Angular acceleration (rad/s2) about pitch that two thrusters of a capsule give.
TURN_RAD_S2 = 0.15


def capsule(name: str, mass_kg: float, diameter_m: float, thrusters: int) -> str:
    """Return a scenario with a capsule whose parts are in proportion to its mass and diameter."""
    d, shield_kg = diameter_m, 0.125 * mass_kg
    canopy_m = LIKE_CANOPY_M * sqrt(mass_kg / LIKE_KG)
    pitch = mass_kg * (0.225 * d) ** 2
    thrust_n = 0.5 * TURN_RAD_S2 * pitch / (0.42 * d * sqrt(0.5))
    shares_of_diameter = {
        **{"diameter": 1.0, "nose": 0.25, "centre": 0.27, "shield_x": 0.105, "pack_x": 0.57},
        **{"shoulder": 0.025, "break_radius": 0.264, "base_radius": 0.15, "pressure_x": 0.415},
        **{"confluence": 0.98, "bridle_x": 0.49, "bridle_r": 0.17, "bridle_y": 0.085, "bridle_z": 0.147},
    }
    shares_of_mass = {"mass": 1.0, "pack": 0.03, "propellant": 0.01, "stiffness": 51.0}
    numbers = {
        **{key: share * d for key, share in shares_of_diameter.items()},
        **{key: share * mass_kg for key, share in shares_of_mass.items()},
        **{"roll": mass_kg * (0.25 * d) ** 2, "pitch": pitch, "area": 0.25 * pi * d * d},
        "shield": shield_kg,
        "shield_roll": shield_kg * (0.31 * d) ** 2,
        "shield_pitch": shield_kg * (0.228 * d) ** 2,
        **{"canopy": canopy_m, "line": 1.76 * canopy_m, "torque": thrust_n * 0.42 * d},
    }
    shown = {key: f"{float(f'{value:.4g}')}" for key, value in numbers.items()}
    jets = "\n".join(_thrusters(d, thrust_n, thrusters))
    return _filled("capsule.yaml", {**shown, "name": name, "rcs": str(thrusters), "thrusters": jets})


def _thrusters(diameter_m: float, thrust_n: float, count: int) -> Iterator[str]:
    """Lines of thrusters: pairs around the backshell, at its greatest width first below and above."""
    x_m, radius_m, slant = -0.3 * diameter_m, 0.42 * diameter_m, sqrt(0.5)
    for pair in range(count // 2):
        angle = 0.5 * pi + 4.0 * pi * pair / count
        y, z = cos(angle), sin(angle)
        for letter, side in (("a", 1.0), ("b", -1.0)):
            place = f"[{x_m:.3f}, {radius_m * y:.3f}, {radius_m * z:.3f}]"
            along = f"[{slant:.6f}, {-side * slant * z:.6f}, {side * slant * y:.6f}]"
            keys = f"name: T{pair + 1}{letter}, group: attitude, position_m: {place}, direction: {along}"
            more = f"thrust_n: {thrust_n:.3g}, specific_impulse_s: 220.0, minimum_pulse_s: 0.02"
            yield f"      - {{{keys}, {more}}}  # [E]"


def campaign(name: str, scenario: str, loaded: Scenario) -> str:
    """Return a campaign that disperses a scenario."""
    lines = "\n".join(f"    {path}: {{kind: normal, {spread}}}" for path, spread in _dispersions(loaded))
    title = loaded.description or loaded.name
    values = {"name": name, "scenario": scenario, "title": title, "dispersions": lines}
    return _filled("campaign.yaml", values)


def _dispersions(scenario: Scenario) -> Iterator[tuple[str, str]]:
    """Dotted paths of the uncertain parameters of a scenario, and their spreads as YAML."""
    from edl6dof.scenario.unusual import radius_m

    vehicle, initial = scenario.vehicle, scenario.initial
    diameter_m = 2.0 * radius_m(vehicle)
    if initial.speed_m_s is not None:
        yield "initial.flight_path_angle_deg", "three_sigma: 0.3"
        yield "initial.speed_m_s", "three_sigma: 6.0"
        yield "initial.azimuth_deg", "three_sigma: 0.1"
    yield "initial.latitude_deg", "three_sigma: 0.1"
    yield "initial.longitude_deg", "three_sigma: 0.1"
    yield "vehicle.mass.entry_kg", f"three_sigma: {0.0117 * vehicle.mass.entry_kg:.3g}"
    for axis, share in enumerate((0.003, 0.0015, 0.0015)):
        if diameter_m:
            yield f"vehicle.mass.entry_centre_m.{axis}", f"three_sigma: {share * diameter_m:.3g}"
    if vehicle.aero.model == "capsule":
        for key, spread in (("axial", 0.05), ("normal", 0.1), ("damping", 0.75)):
            yield f"vehicle.aero.capsule.{key}_factor", f"three_sigma: {spread}"
    for parachute in vehicle.parachutes:
        yield f"vehicle.parachutes.{parachute.name}.drag_factor", "three_sigma: 0.15"
    if vehicle.engines:
        yield "vehicle.engines.*.thrust_factor", "three_sigma: 0.03"
    if vehicle.rcs.thrusters:
        yield "vehicle.rcs.thrusters.*.thrust_n", "three_sigma_pct: 5.0"
    yield "atmosphere.density_factor", "three_sigma: 0.20"
    if scenario.wind.model != "none":
        yield "wind.scale", "three_sigma: 0.50"


def _filled(template: str, values: Mapping[str, str]) -> str:
    return Template((TEMPLATES / template).read_text(encoding="utf-8")).substitute(values)
