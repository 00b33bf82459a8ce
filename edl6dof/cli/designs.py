"""Commands that make the files of a mission: new ones to start from, and a designed entry or landing."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping
from importlib.util import find_spec
from math import cos, pi, sin, sqrt
from pathlib import Path
from string import Template
from typing import TYPE_CHECKING, Annotated

import typer

from edl6dof.api.functions import activate
from edl6dof.cli.group import (
    NOT_WITHIN_LIMITS,
    UNAVAILABLE,
    Command,
    Sets,
    argument,
    check_target,
    examples,
    flag,
    option,
)
from edl6dof.config.errors import refusal

if TYPE_CHECKING:
    from edl6dof.scenario.schema import Scenario

new = typer.Typer(no_args_is_help=True, help="Write files to start from, which fly as they are.")

TEMPLATES = Path(__file__).parents[1] / "data" / "new"
#: Mass and diameter of the canopy of Mars Pathfinder, from which a capsule is scaled.
LIKE_KG, LIKE_CANOPY_M = 585.3, 12.5
#: Mass over area of the heat shield (kg/m2) up to which its parachute opens within limits: at a diameter of
#: 2 m it does with 500 kg and does not with 520 kg.
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
) -> None:
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


@new.command("law", cls=Command, epilog=examples("new law"))
def new_law(name: Name, force: Force = False) -> None:
    """Write an entry guidance law, and a scenario that flies it."""
    _write_plugin("energy_law", name, force)


@new.command("controller", cls=Command, epilog=examples("new controller"))
def new_controller(name: Name, force: Force = False) -> None:
    """Write an attitude controller, and a scenario that flies it."""
    _write_plugin("stop_rates", name, force)


@new.command("campaign", cls=Command, epilog=examples("new campaign"))
def new_campaign(
    scenario: Annotated[str, argument("SCENARIO", "Scenario file, or the name of a shipped one.")],
    force: Force = False,
) -> None:
    """Write a campaign that disperses a scenario.

    Entry state, masses, aerodynamics, air and thrust vary. The file is SCENARIO_mc.yaml, or
    my_SCENARIO_mc.yaml where the package has a scenario of the first name.
    """
    activate(scenario)
    from edl6dof.config.document.locate import find_shipped
    from edl6dof.scenario.loading import load_scenario

    loaded = load_scenario(scenario).scenario
    name = f"{Path(scenario).stem}_mc"
    if find_shipped("scenarios", name):
        name = f"my_{name}"
    lines = "\n".join(f"    {path}: {{kind: normal, {spread}}}" for path, spread in dispersions(loaded))
    title = loaded.description or loaded.name
    values = {"name": name, "scenario": scenario, "title": title, "dispersions": lines}
    _write({Path(f"{name}.yaml"): _filled("campaign.yaml", values)}, force)
    print(f"next: edl6dof campaign {name}.yaml")


def capsule(name: str, mass_kg: float, diameter_m: float, thrusters: int) -> dict[str, str]:
    """Values of the template of a capsule, in proportion to its mass and diameter."""
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


def _write_plugin(shipped: str, name: str, force: bool) -> None:
    """Write a shipped plugin and its scenario under another name, and record the consent to run it."""
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


def _class(name: str) -> str:
    return "".join(word.capitalize() for word in name.split("_"))


def _write(files: Mapping[Path, str], force: bool) -> None:
    """Write files of the current folder, all of them or none."""
    from edl6dof.config.document.locate import find_shipped, why_no_folder
    from edl6dof.runs.files import atomic_file, refuse_existing_file

    for path in files:
        if path.name != str(path):
            raise refusal(path, "names a folder; give a name only")
        if (why := why_no_folder(path.stem)) is not None:
            raise refusal(path.stem, why)
        if find_shipped("scenarios", path.stem):
            raise refusal(path.stem, "is the name of a shipped scenario, which the file would hide")
        refuse_existing_file(path, force)
    for path, text in files.items():
        with atomic_file(path, force) as partial:
            partial.write_text(text, encoding="utf-8")
        print(path)


design = typer.Typer(
    no_args_is_help=True,
    help="Design a part of a mission: its entry or landing.",
)


@design.command("entry", cls=Command, epilog=examples("design entry"))
def design_entry(
    scenario: Annotated[str, argument("SCENARIO", "Scenario file, or the name of a shipped one.")],
    sets: Sets = None,
    maximise: Annotated[str | None, option("WHAT", "parachute_altitude; the default.")] = None,
    minimise: Annotated[
        str | None, option("WHAT", "dispersion: of the open loop, by density, L/D and entry angle.")
    ] = None,
    points: Annotated[int, option("N", "Speeds at which the bank angle is free.", min=2, max=16)] = 6,
    reserve: Annotated[
        float, option("DEG", "Distance of the plan from the bank limits.", min=0.0, max=60.0)
    ] = 10.0,
    out: Annotated[
        Path | None, option("FILE", "Write a scenario (.yaml) that extends this one; with --set, all of it.")
    ] = None,
    force: Annotated[bool, flag("Replace an existing file.", "--force")] = False,
) -> int:
    """Optimise the bank profile of the planned entry.

    The result is compared with the profile of the scenario. Load, heat rate and dynamic pressure stay within
    flight_software.guidance.entry.limits, the bank angles within their limits less the reserve, and the
    profile changes by at most a quarter of the bank rate.

    Exit status: 0 within all limits, 1 not, 2 bad input, 130 interrupted.
    """
    activate(scenario)
    from edl6dof.cli.design_tables import designed_text, goal_of, show
    from edl6dof.design.entry_profile import design_entry as optimise
    from edl6dof.runs.files import atomic_file
    from edl6dof.scenario.loading import load_scenario

    goal = goal_of(maximise, minimise)
    check_target(out, (".yaml", ".yml"), force)
    loaded = load_scenario(scenario, sets or ())
    if all(phase.guidance != "entry" for phase in loaded.scenario.mission.phases):
        raise refusal(scenario, "has no phase with guidance: entry, so there is no entry to design")
    entry = loaded.scenario.flight_software.guidance.entry
    if entry.bank_min_deg + reserve >= entry.bank_max_deg - reserve:
        raise refusal(
            "--reserve",
            f"{reserve:g} leaves nothing between bank_min_deg {entry.bank_min_deg:g} and "
            f"bank_max_deg {entry.bank_max_deg:g}",
        )
    found = optimise(loaded.scenario, goal, points, reserve)
    show(loaded.scenario.name, found)
    if out is not None:
        with atomic_file(out, force) as partial:
            partial.write_text(designed_text(scenario, bool(sets), loaded, found), encoding="utf-8")
        print(out)
    return NOT_WITHIN_LIMITS if found.broken else 0


@design.command("landing", cls=Command, epilog=examples("design landing"))
def design_landing(
    scenario: Annotated[str, argument("SCENARIO", "Scenario file, or the name of a shipped one.")],
    sets: Sets = None,
    divert_m: Annotated[
        float | None,
        option("M", "Divert against the drift; replaces the scenario's target.divert_m.", min=0.0),
    ] = None,
    out: Annotated[Path | None, option("FILE", "Write states and controls (.csv).")] = None,
    figure: Annotated[
        Path | None, option("FILE", "Plot the result with the scenario's own flight (.png, .pdf, .svg).")
    ] = None,
    force: Annotated[bool, flag("Replace an existing file.", "--force")] = False,
) -> int:
    """Design the powered landing with the least propellant.

    Successive convexification optimises the landing of the rigid lander, from the true state of the
    scenario's own flight at engine ignition to rest at its powered target. The result is compared with the
    flight of the scenario's own law. Needs cvxpy: pip install 'edl6dof[design]'.

    Exit status: 0 designed, 1 no landing within the limits or one that exceeds them on its way, 2 bad input,
    69 cvxpy is missing, 130 interrupted.
    """
    activate(scenario)
    check_target(out, (".csv",), force)
    check_target(figure, (".png", ".pdf", ".svg"), force)
    if find_spec("cvxpy") is None:
        message = "design landing needs cvxpy, which is not installed; try: pip install 'edl6dof[design]'"
        print(message, file=sys.stderr)
        return UNAVAILABLE
    from edl6dof.cli.design_tables import design_landing_of
    from edl6dof.interface.roles import POWERED_DECELERATION
    from edl6dof.scenario.loading import load_scenario

    divert = () if divert_m is None else (f"flight_software.guidance.powered.target.divert_m={divert_m}",)
    loaded = load_scenario(scenario, [*(sets or ()), *divert])
    phases = loaded.scenario.mission.phases
    if all(phase.guidance != "powered" or phase.role != POWERED_DECELERATION for phase in phases):
        words = f"guidance: powered and role: {POWERED_DECELERATION}"
        raise refusal(scenario, f"has no phase with {words}, so there is no powered landing to design")
    return design_landing_of(loaded, scenario, out, figure, force)


@design.command("aim", cls=Command, epilog=examples("design aim"))
def design_aim(
    scenario: Annotated[str, argument("SCENARIO", "Scenario file, or the name of a shipped one.")],
    site: Annotated[
        tuple[float, float], option("LAT LON", "Geodetic latitude and east longitude of the site, deg.")
    ],
    sets: Sets = None,
    elevation: Annotated[
        float | None,
        option("M", "Elevation of the site above the areoid; by default that of the relief map."),
    ] = None,
    date: Annotated[
        str | None, option("UTC", "Date and time of the entry, such as 2031-01-28T12:00:00.")
    ] = None,
    out: Annotated[
        Path | None, option("FILE", "Write a scenario (.yaml) that extends this one; with --set, all of it.")
    ] = None,
    force: Annotated[bool, flag("Replace an existing file.", "--force")] = False,
) -> int:
    """Find the entry point that reaches another landing site.

    Speed, flight-path angle, azimuth and altitude of the entry state stay. The planned entry ends at the new
    site as it ends at the old one; then the scenario is flown with its guidance to both sites.

    Exit status: 0 reached and within limits, 1 not, 2 bad input, 130 interrupted.
    """
    activate(scenario)
    from edl6dof.cli.design_tables import aimed_text, show_aim
    from edl6dof.design.aim import aim_entry, site_overrides
    from edl6dof.runs.files import atomic_file
    from edl6dof.scenario.loading import load_scenario
    from edl6dof.sim.flight import fly

    check_target(out, (".yaml", ".yml"), force)
    own = load_scenario(scenario, sets or ())
    moved = site_overrides(own.scenario, site, elevation_m=elevation, epoch_utc=date)
    found = aim_entry(scenario, sets or (), moved)
    aimed = load_scenario(scenario, [*(sets or ()), *moved, *found.overrides])
    flights = [fly(loaded) for loaded in (own, aimed)]
    show_aim(own.scenario, aimed.scenario, found, flights)
    if out is not None:
        with atomic_file(out, force) as partial:
            partial.write_text(aimed_text(scenario, bool(sets), aimed), encoding="utf-8")
        print(out)
    return 0 if found.reached and flights[1].success else NOT_WITHIN_LIMITS
