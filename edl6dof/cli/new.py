"""``edl6dof new``: files to start from that fly as they are."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping
from math import cos, pi, sin, sqrt
from pathlib import Path
from string import Template
from typing import TYPE_CHECKING, Annotated

import typer

from edl6dof.api.functions import activate
from edl6dof.cli.group import Command, argument, examples, flag, option
from edl6dof.config.errors import refusal

if TYPE_CHECKING:
    from edl6dof.scenario.schema import Scenario

new = typer.Typer(no_args_is_help=True, help="Write files to start from, which fly as they are.")

TEMPLATES = Path(__file__).parents[1] / "data" / "new"
#: Mass and diameter of the canopy of Mars Pathfinder, which a capsule is made from.
LIKE_KG, LIKE_CANOPY_M = 585.3, 12.5
#: Mass over area of the heat shield (kg/m2) up to which its parachute opens within limits: at a diameter of
#: 2 m, 500 kg do and 520 kg do not.
HEAVIEST_KG_M2 = 160.0
#: Angular acceleration (rad/s2) about pitch that two thrusters of a capsule give.
TURN_RAD_S2 = 0.15

Name = Annotated[str, argument("NAME", "Name of the files, and of what is in them.")]
Force = Annotated[bool, flag("Replace existing files.", "--force")]


@new.command("capsule", cls=Command, epilog=examples("new capsule"))
def new_capsule(
    name: Name,
    mass: Annotated[float, option("KG", "Mass at entry.", min=80.0, max=5_000.0)] = 300.0,
    diameter: Annotated[float, option("M", "Diameter of the heat shield.", min=1.1, max=6.0)] = 1.8,
    rcs: Annotated[int, option("N", "Thrusters, an even number.", min=4, max=16)] = 8,
    force: Force = False,
) -> int:
    """Write a scenario with a capsule of a mass and a diameter.

    Shape, inertia, centre of mass, thrust and parachute are scaled. It enters the atmosphere of Mars and
    opens its parachute.
    """
    if rcs % 2:
        raise refusal("--rcs", f"thrusters come in pairs: give an even number (got {rcs})")
    text = _filled("capsule.yaml", capsule(name, mass, diameter, rcs))
    _write({Path(f"{name}.yaml"): text}, force)
    if mass > HEAVIEST_KG_M2 * 0.25 * pi * diameter**2:
        words = f"above {HEAVIEST_KG_M2:g} kg per m2 of heat shield it is too fast for its parachute"
        print(f"warning: heavy for its size: {words}", file=sys.stderr)
    print(f"next: edl6dof fly {name}.yaml, edl6dof show {name}.yaml, edl6dof new campaign {name}.yaml")
    return 0


@new.command("law", cls=Command, epilog=examples("new law"))
def new_law(name: Name, force: Force = False) -> int:
    """Write an entry guidance law, and a scenario that flies it."""
    return _write_plugin("energy_law", name, force)


@new.command("controller", cls=Command, epilog=examples("new controller"))
def new_controller(name: Name, force: Force = False) -> int:
    """Write an attitude controller, and a scenario that flies it."""
    return _write_plugin("stop_rates", name, force)


@new.command("campaign", cls=Command, epilog=examples("new campaign"))
def new_campaign(
    scenario: Annotated[str, argument("SCENARIO", "Scenario file, or the name of a shipped one.")],
    force: Force = False,
) -> int:
    """Write a campaign that disperses a scenario.

    Entry state, masses, aerodynamics, air and thrust vary.
    """
    activate(scenario)
    from edl6dof.scenario.loading import load_scenario

    loaded = load_scenario(scenario).scenario
    name = f"{Path(scenario).stem}_mc"
    lines = "\n".join(f"    {path}: {{kind: normal, {spread}}}" for path, spread in dispersions(loaded))
    title = loaded.description or loaded.name
    values = {"name": name, "scenario": scenario, "title": title, "dispersions": lines}
    _write({Path(f"{name}.yaml"): _filled("campaign.yaml", values)}, force)
    print(f"next: edl6dof campaign {name}.yaml")
    return 0


def capsule(name: str, mass_kg: float, diameter_m: float, thrusters: int) -> dict[str, str]:
    """Values of the template of a capsule, in proportion to its mass and diameter."""
    d, shield_kg = diameter_m, 0.125 * mass_kg
    canopy_m = LIKE_CANOPY_M * sqrt(mass_kg / LIKE_KG)
    pitch = mass_kg * (0.225 * d) ** 2
    thrust_n = 0.5 * TURN_RAD_S2 * pitch / (0.42 * d * sqrt(0.5))
    numbers = {
        "mass": mass_kg,
        "diameter": d,
        "nose": 0.25 * d,
        "centre": 0.27 * d,
        "roll": mass_kg * (0.25 * d) ** 2,
        "pitch": pitch,
        "shield": shield_kg,
        "shield_x": 0.105 * d,
        "shield_roll": shield_kg * (0.31 * d) ** 2,
        "shield_pitch": shield_kg * (0.228 * d) ** 2,
        "area": 0.25 * pi * d * d,
        "pack": 0.03 * mass_kg,
        "pack_x": 0.57 * d,
        "shoulder": 0.025 * d,
        "break_radius": 0.264 * d,
        "base_radius": 0.15 * d,
        "pressure_x": 0.415 * d,
        "propellant": 0.01 * mass_kg,
        "canopy": canopy_m,
        "line": 1.76 * canopy_m,
        "confluence": 0.98 * d,
        "bridle_x": 0.49 * d,
        "bridle_r": 0.17 * d,
        "bridle_y": 0.085 * d,
        "bridle_z": 0.147 * d,
        "stiffness": 51.0 * mass_kg,
        "torque": thrust_n * 0.42 * d,
    }
    shown = {key: f"{float(f'{value:.4g}')}" for key, value in numbers.items()}
    jets = "\n".join(_thrusters(d, thrust_n, thrusters))
    return {**shown, "name": name, "rcs": str(thrusters), "thrusters": jets}


def _thrusters(diameter_m: float, thrust_n: float, count: int) -> Iterator[str]:
    """A line for each thruster: pairs around the backshell, at its greatest width first below and above."""
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


def dispersions(scenario: Scenario) -> Iterator[tuple[str, str]]:
    """Dotted paths of what is uncertain in a scenario, and their spreads as YAML."""
    from edl6dof.scenario.loaded import radius_m

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


def _write_plugin(shipped: str, name: str, force: bool) -> int:
    """Write a shipped plugin and its scenario under another name; as it comes from here, it may run."""
    from edl6dof.config.document.locate import find_shipped
    from edl6dof.config.plugin_files import accept

    if not name.isidentifier() or name != name.lower():
        raise refusal(name, "must be a lower-case identifier, such as my_law")
    scenario = find_shipped("scenarios", f"plugin/{shipped}")
    assert scenario is not None, "it is in the package"
    files = {}
    for suffix in (".py", ".yaml"):
        text = scenario.with_suffix(suffix).read_text(encoding="utf-8").replace(shipped, name)
        files[Path(name + suffix)] = text.replace(_class(shipped), _class(name))
    _write(files, force)
    plugin = Path(f"{name}.py")
    accept(plugin, plugin.read_bytes())
    print(f"next: edl6dof fly {name}.yaml; after each change: edl6dof trust {plugin}")
    return 0


def _class(name: str) -> str:
    return "".join(word.capitalize() for word in name.split("_"))


def _write(files: Mapping[Path, str], force: bool) -> None:
    """Write files of the current folder, all of them or none."""
    from edl6dof.config.document.locate import why_no_folder
    from edl6dof.runs.files import atomic_file, refuse_existing_file

    for path in files:
        if path.name != str(path):
            raise refusal(path, "names a folder; give a name only")
        if (why := why_no_folder(path.stem)) is not None:
            raise refusal(path.stem, why)
        refuse_existing_file(path, force)
    for path, text in files.items():
        with atomic_file(path, force) as partial:
            partial.write_text(text, encoding="utf-8")
        print(path)
