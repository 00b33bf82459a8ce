"""Commands that make the files of a mission: new ones to start from, and a designed entry or landing."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from functools import partial
from importlib.util import find_spec
from math import pi
from pathlib import Path
from typing import Annotated

import typer

from edl6dof.api.functions import activate
from edl6dof.cli.group import NOT_WITHIN_LIMITS, UNAVAILABLE, Command, check_target, write_file
from edl6dof.cli.options import Scenario, Sets, argument, flag, option
from edl6dof.config.errors import refusal

new = typer.Typer(no_args_is_help=True, help="Write files to start from, which fly as they are.")

#: Mass over area of the heat shield (kg/m2) up to which its parachute opens within limits: at a diameter of
#: 2 m it does with 500 kg and does not with 520 kg.
HEAVIEST_KG_M2 = 160.0
Name = Annotated[str, argument("NAME", "Name of the files, and of what is in them.")]
Force = Annotated[bool, flag("Replace existing files.", "--force")]
NewScenario = Annotated[
    Path | None, option("FILE", "Write a scenario (.yaml) that extends this one; with --set, all of it.")
]


@new.command("capsule", cls=Command)
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

    edl6dof new capsule lander --mass 300 --diameter 1.8 --rcs 8
    edl6dof fly lander.yaml
    """
    if rcs % 2:
        raise refusal("--rcs", f"thrusters come in pairs: give an even number (got {rcs})")
    from edl6dof.design.templates import capsule

    _write({Path(f"{name}.yaml"): capsule(name, mass, diameter, rcs)}, force)
    if mass > HEAVIEST_KG_M2 * 0.25 * pi * diameter**2:
        words = f"above {HEAVIEST_KG_M2:g} kg per m2 of heat shield it is too fast for its parachute"
        print(f"warning: heavy for its size: {words}", file=sys.stderr)
    print(f"next: edl6dof fly {name}.yaml, edl6dof show {name}.yaml, edl6dof new campaign {name}.yaml")


@new.command("law", cls=Command)
def new_law(name: Name, force: Force = False) -> None:
    """Write an entry guidance law, and a scenario that flies it.

    edl6dof new law my_law
    edl6dof fly my_law.yaml
    """
    _write_plugin("energy_law", name, force)


@new.command("controller", cls=Command)
def new_controller(name: Name, force: Force = False) -> None:
    """Write an attitude controller, and a scenario that flies it.

    edl6dof new controller my_controller
    edl6dof fly my_controller.yaml
    """
    _write_plugin("stop_rates", name, force)


@new.command("campaign", cls=Command)
def new_campaign(
    scenario: Scenario,
    force: Force = False,
) -> None:
    """Write a campaign that disperses a scenario.

    Entry state, masses, aerodynamics, air and thrust vary. The file is SCENARIO_mc.yaml, or
    my_SCENARIO_mc.yaml where the package has a scenario of the first name.

    edl6dof new campaign tianwen1
    edl6dof campaign my_tianwen1_mc.yaml -n 100
    """
    activate(scenario)
    from edl6dof.config.document.locate import find_shipped
    from edl6dof.design.templates import campaign
    from edl6dof.scenario.loading import load_scenario

    loaded = load_scenario(scenario).scenario
    name = f"{Path(scenario).stem}_mc"
    if find_shipped("scenarios", name):
        name = f"my_{name}"
    _write({Path(f"{name}.yaml"): campaign(name, scenario, loaded)}, force)
    print(f"next: edl6dof campaign {name}.yaml")


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


design = typer.Typer(no_args_is_help=True, help="Design a part of a mission: its entry or landing.")


@design.command("entry", cls=Command)
def design_entry(
    scenario: Scenario,
    sets: Sets = None,
    maximise: Annotated[str | None, option("WHAT", "parachute_altitude; the default.")] = None,
    minimise: Annotated[
        str | None, option("WHAT", "dispersion: of the open loop, by density, L/D and entry angle.")
    ] = None,
    points: Annotated[int, option("N", "Speeds at which the bank angle is free.", min=2, max=16)] = 6,
    reserve: Annotated[
        float, option("DEG", "Distance of the plan from the bank limits.", min=0.0, max=60.0)
    ] = 10.0,
    out: NewScenario = None,
    force: Annotated[bool, flag("Replace an existing file.", "--force")] = False,
) -> int:
    """Optimise the bank profile of the planned entry.

    The result is compared with the profile of the scenario. Load, heat rate and dynamic pressure stay within
    flight_software.guidance.entry.limits, the bank angles within their limits less the reserve, and the
    profile changes by at most a quarter of the bank rate.

    Exit status: 0 within all limits, 1 not, 2 bad input, 130 interrupted.

    edl6dof design entry msl --out plan.yaml
    edl6dof design entry msl --minimise dispersion
    """
    activate(scenario)
    from edl6dof.cli.design_tables import goal_of, show
    from edl6dof.design.entry_profile import design_entry as optimise
    from edl6dof.design.scenario_files import write_designed
    from edl6dof.scenario.loading import load_scenario

    goal = goal_of(maximise, minimise)
    check_target(out, (".yaml", ".yml"), force)
    loaded = load_scenario(scenario, sets or ())
    if all(phase.guidance != "entry" for phase in loaded.scenario.mission.phases):
        raise refusal(scenario, "has no phase with guidance: entry, so there is no entry to design")
    entry = loaded.scenario.flight_software.guidance.entry
    if entry.bank_min_deg + reserve >= entry.bank_max_deg - reserve:
        limits = f"bank_min_deg {entry.bank_min_deg:g} and bank_max_deg {entry.bank_max_deg:g}"
        raise refusal("--reserve", f"{reserve:g} leaves nothing between {limits}")
    found = optimise(loaded.scenario, goal, points, reserve)
    show(loaded.scenario.name, found)
    write_file(out, force, partial(write_designed, scenario, bool(sets), loaded, found))
    return NOT_WITHIN_LIMITS if found.broken else 0


@design.command("landing", cls=Command)
def design_landing(
    scenario: Scenario,
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

    edl6dof design landing tianwen1 --divert-m 600 --figure landing.png
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


@design.command("aim", cls=Command)
def design_aim(
    scenario: Scenario,
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
    out: NewScenario = None,
    force: Annotated[bool, flag("Replace an existing file.", "--force")] = False,
) -> int:
    """Find the entry point that reaches another landing site.

    Speed, flight-path angle, azimuth and altitude of the entry state stay. The planned entry ends at the new
    site as it ends at the old one; then the scenario is flown with its guidance to both sites.

    Exit status: 0 reached and within limits, 1 not, 2 bad input, 130 interrupted.

    edl6dof design aim tianwen1 --site 18.44 77.45 --out jezero.yaml
    edl6dof design aim msl --site -5.4 137.8 --date 2031-01-28T12:00:00
    """
    activate(scenario)
    from edl6dof.cli.design_tables import show_aim
    from edl6dof.design.aim import aim_entry, site_overrides
    from edl6dof.design.scenario_files import write_aimed
    from edl6dof.scenario.loading import load_scenario
    from edl6dof.sim.flight import fly

    check_target(out, (".yaml", ".yml"), force)
    own = load_scenario(scenario, sets or ())
    moved = site_overrides(own.scenario, site, elevation_m=elevation, epoch_utc=date)
    found = aim_entry(scenario, sets or (), moved)
    aimed = load_scenario(scenario, [*(sets or ()), *moved, *found.overrides])
    flights = [fly(loaded) for loaded in (own, aimed)]
    show_aim(own.scenario, aimed.scenario, found, flights)
    write_file(out, force, partial(write_aimed, scenario, bool(sets), aimed))
    return 0 if found.reached and flights[1].success else NOT_WITHIN_LIMITS
