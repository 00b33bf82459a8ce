"""Checks of a scenario beyond single values: sections that must fit together, and the data files it names.

The builders of the models report mistakes in a file; here each builder is called before a flight begins, and
its message is put at the key that names the file.  They cache their results, which the flight uses.
"""

from __future__ import annotations

import csv
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from edl6dof.config.document.document import Document
from edl6dof.config.document.locate import shown
from edl6dof.config.document.regular import read_regular
from edl6dof.config.errors import Inconsistent
from edl6dof.config.refused import Found, NotKnown, findings, judging
from edl6dof.environment.areoid import areoid_path, require_areoid_of
from edl6dof.environment.atmosphere import air_inputs
from edl6dof.environment.atmosphere_table import build_table, profile_path, read_profile
from edl6dof.environment.gravity import GRAVITY, coefficients_path, fill_gravity
from edl6dof.environment.landing_area.relief import landing_area_problems
from edl6dof.environment.terrain import ground_arrays, ground_inputs, require_topography_of
from edl6dof.environment.wind import require_winds
from edl6dof.fsw.check_out import check_out_problems
from edl6dof.fsw.control.registry import HEEDS
from edl6dof.fsw.hazard.elevation_map import MAX_RADIUS
from edl6dof.fsw.navigation.filters.registry import NAVIGATION_FILTERS
from edl6dof.interchange.meshes import read_mesh_file
from edl6dof.metrics.published import published_problems
from edl6dof.scenario.mission_events import event_problems, quantity_problems, way_problems
from edl6dof.scenario.schema import Scenario
from edl6dof.sensors.registry import sensor_problems
from edl6dof.spatial.arrays import lengths
from edl6dof.vehicle.aerodynamics.body_table import body_inputs, build_body_table
from edl6dof.vehicle.aerodynamics.capsule_table import (
    aero_inputs,
    build_aero_table,
    read_static_table,
    static_table_path,
)
from edl6dof.vehicle.faults.fault import fault_problems
from edl6dof.vehicle.propulsion.engine_models import THRUSTER_SET


def section_problems(scenario: Scenario) -> dict[str, str]:
    """Return a message by dotted path for values of different sections that do not fit together."""
    return findings(CROSS_CHECKS, scenario)


def _cycle_problems(scenario: Scenario) -> Iterator[Found]:
    step, cycle = scenario.simulation.step_s, 1.0 / scenario.flight_software.rates.base_hz
    steps = cycle / step
    if abs(steps - round(steps)) > 1e-9 * steps or round(steps) < 1:
        rule = f"must divide the base cycle 1/flight_software.rates.base_hz = {cycle:g} s"
        yield "simulation.step_s", f"{rule} (got {step:g})"


def _landing_area_problems(scenario: Scenario) -> Iterator[Found]:
    for key, message in landing_area_problems(scenario.terrain.landing_area).items():
        yield f"terrain.landing_area.{key}", message


def _lag_problems(scenario: Scenario) -> Iterator[Found]:
    """Limit the step to the lag of every engine: one lag follows the thrust to 2 %, three lags diverge."""
    step = scenario.simulation.step_s
    for engine in scenario.vehicle.engines:
        lags = {"throttled": engine.throttled, "pulsed": engine.pulsed, "solid": engine.solid}
        lag = lags[engine.model].lag_s if engine.model in lags else step
        if step > (1.0 + 1e-9) * lag:
            own = f"vehicle.engines.{engine.name}.{engine.model}.lag_s"
            yield "simulation.step_s", f"must not exceed {own} = {lag:g} s (got {step:g})"


def _heed_problems(scenario: Scenario) -> Iterator[Found]:
    """Refuse settings of a phase that its controller ignores."""
    for k, phase in enumerate(scenario.mission.phases):
        asked = {"hold_alpha": phase.hold_alpha, "bandwidth": phase.bandwidth != 1.0}
        for key in (key for key, is_asked in asked.items() if is_asked):
            if key not in HEEDS.get(phase.control, (key,)):
                those = ", ".join(name for name, heeded in HEEDS.items() if key in heeded)
                message = f"has no effect with control {phase.control}; it has with: {those}"
                yield f"mission.phases.{k}.{key}", message


def _delay_problems(scenario: Scenario) -> Iterator[Found]:
    """Limit delays to the control cycle, for which the flight computer keeps its valve commands."""
    oldest = scenario.flight_software.rates.control_every
    for name in ("imu", "inertial_unit"):
        delay = getattr(scenario.sensors, name).delay_cycles
        if name in scenario.sensors_in_flight.flown and delay > oldest:
            message = f"must not exceed flight_software.rates.control_every {oldest} (got {delay})"
            yield f"sensors.{name}.delay_cycles", message


def _thruster_set_problems(scenario: Scenario) -> Iterator[Found]:
    """Refuse the table of thrusters if an engine is made of thrusters, by which the table does not steer."""
    made_so = any(engine.model == THRUSTER_SET.name for engine in scenario.vehicle.engines)
    if scenario.flight_software.allocation.method == "table" and made_so:
        message = f"table does not steer by an engine that is a {THRUSTER_SET.name}; choose least_squares"
        yield "flight_software.allocation.method", message


def _metering_problems(scenario: Scenario) -> Iterator[Found]:
    """Require equal delays of flow meters and inertial unit: diagnosis compares both over one cycle."""
    sensors = scenario.sensors_in_flight
    name = "inertial_unit" if "inertial_unit" in sensors.flown else "imu"
    own, other = sensors.flow_meters.delay_cycles, getattr(sensors, name).delay_cycles
    if "flow_meters" in sensors.flown and own != other:
        message = f"must be sensors.{name}.delay_cycles {other}: diagnosis compares the two (got {own})"
        yield "sensors.flow_meters.delay_cycles", message


def _sensor_problems(scenario: Scenario) -> Iterable[Found]:
    """Require the sensors that the navigation filter reads, and those of contact and trim wing."""
    read = NAVIGATION_FILTERS.member(scenario.navigation_filter).reads
    return sensor_problems(scenario.sensors_in_flight, (*read, "footpad_contact", "wing_open")).items()


def _hazard_problems(scenario: Scenario) -> Iterator[Found]:
    """Require the lidar for hazard detection, and a footprint that does not span too many map cells."""
    section, hazard = "flight_software.hazard", scenario.flight_software.hazard
    if hazard.detection == "given":
        return
    if "lidar" not in scenario.sensors_in_flight.flown:
        message = f"needs sensors.carried to name lidar (got {hazard.detection}); given detects nothing"
        yield f"{section}.detection", message
    if hazard.footprint_radius_m > (largest := MAX_RADIUS * hazard.cell_m):
        rule = f"must not exceed {MAX_RADIUS} cells of {section}.cell_m, {largest:g} m"
        yield f"{section}.footprint_radius_m", f"{rule} (got {hazard.footprint_radius_m:g})"


def _stars_problems(scenario: Scenario) -> Iterator[Found]:
    """Require that the event that ends the view of the stars is an event of the mission."""
    name, known = scenario.sensors.star_tracker.until, scenario.mission.events
    if name is not None and name not in known:
        words = ", ".join(known) or "none"
        yield "sensors.star_tracker.until", f"no event named {name!r} in the mission; names: {words}"


def _alignment_problems(scenario: Scenario) -> Iterator[Found]:
    """Require a star fix in the first cycle, in which a filter starts with it and the tracked state."""
    reads = NAVIGATION_FILTERS.member(scenario.navigation_filter).reads
    if "star_tracker" not in scenario.sensors_in_flight.flown or "stars" not in reads:
        return
    stars, why = scenario.sensors.star_tracker, "navigation needs a star fix then to begin with"
    altitude, rate = scenario.initial_altitude_m, float(lengths(np.array(scenario.initial.rate_deg_s)))
    if altitude < stars.lowest_m:
        rule = f"must not exceed the altitude at the start, {altitude:g} m"
        yield "sensors.star_tracker.lowest_m", f"{rule}: {why} (got {stars.lowest_m:g})"
    if rate > stars.rate_deg_s:
        rule = f"must not be below the rate at the start, {rate:g} deg/s"
        yield "sensors.star_tracker.rate_deg_s", f"{rule}: {why} (got {stars.rate_deg_s:g})"


def _last_event_problems(scenario: Scenario) -> Iterator[Found]:
    """Require that the event that ends the flight is an event of the mission, if the mission needs one."""
    mission = scenario.mission
    last, known = mission.goal_event, ", ".join(mission.events) or "none"
    if last not in mission.events and (last is not None or mission.goal == "event"):
        named = "name the event" if last is None else f"no event named {last!r}"
        yield "mission.goal_event", f"{named} with which the flight ends; names: {known}"


def _goal_problems(scenario: Scenario) -> Iterator[Found]:
    if scenario.dynamics == "point_mass" and scenario.mission.goal == "landing":
        rule = "must be 'deployment' or 'time' with dynamics point_mass, which ends at the parachute"
        yield "mission.goal", f"{rule} (got 'landing')"


def _entry_problems(scenario: Scenario) -> Iterator[Found]:
    """Require an initial speed above the final speed of entry guidance, which plans in between."""
    initial, final = scenario.initial, scenario.flight_software.guidance.entry.final_speed_m_s
    if initial.speed <= final and any(phase.guidance == "entry" for phase in scenario.mission.phases):
        given = "speed_m_s" if initial.velocity_ned_m_s is None else "velocity_ned_m_s"
        rule = f"must be above flight_software.guidance.entry.final_speed_m_s {final:g}"
        yield f"initial.{given}", f"{rule} when a phase flies entry guidance (got {initial.speed:g})"


CROSS_CHECKS: tuple[Callable[[Scenario], Iterable[Found]], ...] = (
    _cycle_problems,
    _landing_area_problems,
    _lag_problems,
    _sensor_problems,
    _stars_problems,
    _alignment_problems,
    _delay_problems,
    _hazard_problems,
    _metering_problems,
    _thruster_set_problems,
    _goal_problems,
    _last_event_problems,
    lambda s: way_problems(s.mission),
    lambda s: quantity_problems(s.mission),
    _heed_problems,
    lambda s: event_problems(s.mission, s.vehicle),
    _entry_problems,
    lambda s: published_problems(s.published, s.mission.events).items(),
    lambda s: check_out_problems(s.flight_software.check_out, s.thruster_names).items(),
    lambda s: fault_problems(s.faults, s.components, s.phase_names).items(),
)


#: Keys of a scenario that name a table, and the file that such a name means.
TABLES: dict[str, Callable[[str], Path]] = {
    "atmosphere.table": profile_path,
    "planet.areoid": areoid_path,
    "terrain.landing_area.dtm.file": Path,
    "planet.gravity.coefficients": coefficients_path,
    "vehicle.aero.capsule.static_table": static_table_path,
    "vehicle.aero.body.file": Path,
}

#: Section of names for tables of the air.
PROFILES = "atmosphere.profiles"
#: Where a scenario names the meshes of its vehicle, and the file of a body of any shape.
MESHES = ("vehicle", "appearance", "meshes")
BODY = ("vehicle", "aero", "body")

#: Beginnings of the messages of Python and numpy for text that is no number, and for rows of unequal length.
_NUMPY_WORDS = (
    *("could not convert", "invalid literal", "setting an array", "zero-size array", "need at least"),
)
_UNREADABLE = (OSError, ValueError, LookupError, ModuleNotFoundError, ArithmeticError, MemoryError, csv.Error)


def file_problems(scenario: Scenario) -> dict[str, str]:
    """Dotted path to message of every table that cannot be built."""
    problems: dict[str, str] = {}
    collected = partial(_collected, scenario, problems)
    with collected("planet.areoid"):
        require_areoid_of(scenario.planet)
    with collected("atmosphere.table"):
        without_map = scenario.planet.model_copy(update={"areoid": ""})  # its mistakes have their own key
        of_air = air_inputs(scenario.atmosphere, without_map, scenario.place)
        air = build_table(of_air._replace(climate=None))  # the column of a climate is made of the same rows
        with collected("wind.model"):
            require_winds(scenario.wind, air[0])
    with collected(PROFILES):
        for name, file in scenario.atmosphere.profiles.items():
            with collected(f"{PROFILES}.{name}"):
                read_profile(file, read_regular(profile_path(file)), scenario.planet.gas.gas_constant_j_kg_k)
    with collected("terrain.model"):
        if scenario.terrain.model == "mola":
            require_topography_of(scenario.planet.mean_radius_m)
    with collected("terrain.landing_area.dtm.file"):
        if scenario.terrain.landing_area.dtm.file:
            ground_arrays(ground_inputs(scenario.terrain, scenario.planet)._replace(map=None, hurst=None))
    with collected("planet.gravity.coefficients"):
        fill_gravity(np.zeros(1, GRAVITY)[0], scenario.planet.gravity)
    with collected("vehicle.aero.capsule.static_table"):
        if scenario.vehicle.aero.model == "capsule":
            capsule = scenario.vehicle.aero.capsule
            inputs = aero_inputs(capsule, scenario.planet.gas.shock_layer_heat_capacity_ratio)
            if capsule.coefficients == "table":
                read_static_table(capsule.static_table)
            with collected("vehicle.aero.capsule"):
                build_aero_table(inputs)
    with collected("vehicle.aero.body.file"):
        if scenario.vehicle.aero.model == "body":
            ratio = scenario.planet.gas.shock_layer_heat_capacity_ratio
            sheds = scenario.vehicle.showing("capsule") is not None
            build_body_table(body_inputs(scenario.vehicle.aero.body, ratio, sheds))
    with collected("vehicle.appearance"):
        for k, mesh in enumerate(scenario.vehicle.appearance.meshes):
            with collected(f"{'.'.join(MESHES)}.{k}.file"):
                read_mesh_file(Path(mesh.file))
    return problems


@contextmanager
def _collected(scenario: Scenario, problems: dict[str, str], key: str) -> Iterator[None]:
    with np.errstate(all="ignore"), judging(scenario):
        try:
            yield
        except Inconsistent as error:
            problems.update(error.problems)
        except _UNREADABLE as error:
            if isinstance(error.__cause__, NotKnown):
                raise
            problems[key] = _words(error)


def _words(error: Exception) -> str:
    if isinstance(error, OSError):
        file = f" ({shown(Path(error.filename))})" if error.filename else ""
        return f"cannot be read: {error.strerror or error}{file}"
    if isinstance(error, ModuleNotFoundError):
        return str(error)
    if isinstance(error, UnicodeDecodeError):
        return "is not a text file"
    if isinstance(error, LookupError):
        return "is not a complete table: a heading, a row or a column is missing"
    if isinstance(error, ValueError) and not str(error).startswith(_NUMPY_WORDS):
        return str(error)
    return f"is not a table of numbers ({error})"


def with_whole_paths(document: Document) -> Document:
    """Make the paths of mesh and body files absolute; values of another form are left to validation."""
    found = _at(document, MESHES)
    for k, mesh in enumerate(found if isinstance(found, list) else ()):
        _make_whole(document, (*MESHES, k), mesh)
    _make_whole(document, BODY, _at(document, BODY))
    return document


def _at(document: Document, keys: tuple[str, ...]) -> Any:
    found: Any = document.data
    for key in keys:
        found = found.get(key) if isinstance(found, dict) else None
    return found


def _make_whole(document: Document, keys: tuple[str | int, ...], named: Any) -> None:
    """Make the path of the ``file`` of ``named``, the value at ``keys``, absolute."""
    if isinstance(named, dict) and isinstance(name := named.get("file"), str) and name:
        named_in = Path(document.mark((*keys, "file")).file)
        folder = named_in.parent if named_in.is_file() else Path.cwd()
        named["file"] = str((folder / name).resolve())
