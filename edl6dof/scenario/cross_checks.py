"""Checks of what must fit together between the sections of a scenario."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from edl6dof.environment.landing_area.params import landing_area_problems
from edl6dof.fsw.check_out import check_out_problems
from edl6dof.fsw.control.registry import HEEDS
from edl6dof.fsw.hazard.footprint import MAX_RADIUS
from edl6dof.fsw.navigation.filters.registry import NAVIGATION_FILTERS
from edl6dof.metrics.published import published_problems
from edl6dof.scenario.events import event_problems, quantity_problems, way_problems
from edl6dof.scenario.schema import Scenario
from edl6dof.sensors.registry import sensor_problems
from edl6dof.spatial.arrays import lengths
from edl6dof.vehicle.faults.fault import fault_problems
from edl6dof.vehicle.propulsion.engine_models import thruster_set


def section_problems(scenario: Scenario) -> dict[str, str]:
    """Return a message by dotted path for values of different sections that do not fit together."""
    found: dict[str, str] = {}
    for problems in CROSS_CHECKS:
        found |= problems(scenario)
    return found


def _cycle_problems(scenario: Scenario) -> dict[str, str]:
    cycle = 1.0 / scenario.flight_software.rates.base_hz
    steps = cycle / scenario.simulation.step_s
    if abs(steps - round(steps)) <= 1e-9 * steps and round(steps) >= 1:
        return {}
    message = (
        f"must divide the base cycle 1/flight_software.rates.base_hz = {cycle:g} s (got "
        f"{scenario.simulation.step_s:g})"
    )
    return {"simulation.step_s": message}


def _landing_area_problems(scenario: Scenario) -> dict[str, str]:
    found = landing_area_problems(scenario.terrain.landing_area)
    return {f"terrain.landing_area.{key}": message for key, message in found.items()}


def _lag_problems(scenario: Scenario) -> dict[str, str]:
    """A step as long as the lag of an engine follows its thrust to 2 %; three times as long, it diverges."""
    step = scenario.simulation.step_s
    found = {}
    for engine in scenario.vehicle.engines:
        lags = {"throttled": engine.throttled, "pulsed": engine.pulsed, "solid": engine.solid}
        lag = lags[engine.model].lag_s if engine.model in lags else step
        if step > (1.0 + 1e-9) * lag:
            own = f"vehicle.engines.{engine.name}.{engine.model}.lag_s"
            found["simulation.step_s"] = f"must not exceed {own} = {lag:g} s (got {step:g})"
    return found


def _heed_problems(scenario: Scenario) -> dict[str, str]:
    """Return what a phase asks of a controller that ignores it."""
    found = {}
    for k, phase in enumerate(scenario.mission.phases):
        asked = {"hold_alpha": phase.hold_alpha, "bandwidth": phase.bandwidth != 1.0}
        for key in (key for key, is_asked in asked.items() if is_asked):
            if key not in HEEDS.get(phase.control, (key,)):
                those = ", ".join(name for name, heeded in HEEDS.items() if key in heeded)
                found[f"mission.phases.{k}.{key}"] = (
                    f"has no effect with control {phase.control}; it has with: {those}"
                )
    return found


def _delay_problems(scenario: Scenario) -> dict[str, str]:
    """The flight computer keeps its valve commands for the age of a reading."""
    oldest, found = scenario.flight_software.rates.control_every, {}
    for name in ("imu", "inertial_unit"):
        delay = getattr(scenario.sensors, name).delay_cycles
        if name in scenario.sensors_in_flight.flown and delay > oldest:
            message = f"must not exceed flight_software.rates.control_every {oldest} (got {delay})"
            found[f"sensors.{name}.delay_cycles"] = message
    return found


def _thruster_set_problems(scenario: Scenario) -> dict[str, str]:
    """The table of thrusters takes axial ones whole or not at all, so that they do not steer."""
    made_so = any(engine.model == thruster_set.NAME for engine in scenario.vehicle.engines)
    if scenario.flight_software.allocation.method != "table" or not made_so:
        return {}
    message = f"table does not steer by an engine that is a {thruster_set.NAME}; choose least_squares"
    return {"flight_software.allocation.method": message}


def _metering_problems(scenario: Scenario) -> dict[str, str]:
    """Diagnosis sets what branches use against what the vehicle does: over the same cycle."""
    sensors = scenario.sensors_in_flight
    if "flow_meters" not in sensors.flown:
        return {}
    name = "inertial_unit" if "inertial_unit" in sensors.flown else "imu"
    own, other = sensors.flow_meters.delay_cycles, getattr(sensors, name).delay_cycles
    message = f"must be sensors.{name}.delay_cycles {other}: diagnosis compares the two (got {own})"
    return {} if own == other else {"sensors.flow_meters.delay_cycles": message}


def _sensor_problems(scenario: Scenario) -> dict[str, str]:
    """The navigation filter must find what it reads; contact and trim wing are sensed by every set."""
    read = NAVIGATION_FILTERS.member(scenario.navigation_filter).reads
    return sensor_problems(scenario.sensors_in_flight, (*read, "footpad_contact", "wing_open"))


def _hazard_problems(scenario: Scenario) -> dict[str, str]:
    """Require the lidar for hazard detection, and for its map a footprint of cells that is not too large."""
    hazard, found = scenario.flight_software.hazard, {}
    if hazard.detection == "given":
        return {}
    if "lidar" not in scenario.sensors_in_flight.flown:
        found["flight_software.hazard.detection"] = (
            f"needs sensors.carried to name lidar (got {hazard.detection}); given detects nothing"
        )
    if hazard.footprint_radius_m > MAX_RADIUS * hazard.cell_m:
        found["flight_software.hazard.footprint_radius_m"] = (
            f"must not exceed {MAX_RADIUS} cells of flight_software.hazard.cell_m, "
            f"{MAX_RADIUS * hazard.cell_m:g} m (got {hazard.footprint_radius_m:g})"
        )
    return found


def _stars_problems(scenario: Scenario) -> dict[str, str]:
    """The event that ends the view of the stars is one of the mission."""
    name, known = scenario.sensors.star_tracker.until, scenario.mission.events
    if name is None or name in known:
        return {}
    words = ", ".join(known) or "none"
    return {"sensors.star_tracker.until": f"no event named {name!r} in the mission; names: {words}"}


def _alignment_problems(scenario: Scenario) -> dict[str, str]:
    """A filter starts in the first cycle: with a star fix, and the state that ground tracking sends then."""
    reads = NAVIGATION_FILTERS.member(scenario.navigation_filter).reads
    if "star_tracker" not in scenario.sensors_in_flight.flown or "stars" not in reads:
        return {}
    stars, found = scenario.sensors.star_tracker, {}
    altitude, rate = scenario.initial_altitude_m, float(lengths(np.array(scenario.initial.rate_deg_s)))
    if altitude < stars.lowest_m:
        found["sensors.star_tracker.lowest_m"] = (
            f"must not exceed the altitude at the start, {altitude:g} m: navigation needs a star fix then to "
            f"begin with (got {stars.lowest_m:g})"
        )
    if rate > stars.rate_deg_s:
        found["sensors.star_tracker.rate_deg_s"] = (
            f"must not be below the rate at the start, {rate:g} deg/s: navigation needs a star fix then to "
            f"begin with (got {stars.rate_deg_s:g})"
        )
    return found


def _last_event_problems(scenario: Scenario) -> dict[str, str]:
    """The event with which the flight ends is one of the mission, and named where it does."""
    mission = scenario.mission
    last, known = mission.goal_event, ", ".join(mission.events) or "none"
    if last in mission.events or last is None and mission.goal != "event":
        return {}
    named = "name the event" if last is None else f"no event named {last!r}"
    return {"mission.goal_event": f"{named} with which the flight ends; names: {known}"}


def _goal_problems(scenario: Scenario) -> dict[str, str]:
    if scenario.dynamics == "six_dof" or scenario.mission.goal != "landing":
        return {}
    return {
        "mission.goal": (
            "must be 'deployment' or 'time' with dynamics point_mass, which ends at the parachute (got "
            "'landing')"
        )
    }


def _entry_problems(scenario: Scenario) -> dict[str, str]:
    """Entry guidance plans from the initial state down to its final speed: there must be something to
    plan.
    """
    initial, final = scenario.initial, scenario.flight_software.guidance.entry.final_speed_m_s
    if initial.speed > final or not any(phase.guidance == "entry" for phase in scenario.mission.phases):
        return {}
    name = "flight_software.guidance.entry.final_speed_m_s"
    message = f"must be above {name} {final:g} when a phase flies entry guidance (got {initial.speed:g})"
    given = "speed_m_s" if initial.velocity_ned_m_s is None else "velocity_ned_m_s"
    return {f"initial.{given}": message}


CROSS_CHECKS: tuple[Callable[[Scenario], Mapping[str, str]], ...] = (
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
    lambda s: published_problems(s.published, s.mission.events),
    lambda s: check_out_problems(s.flight_software.check_out, s.thruster_names),
    lambda s: fault_problems(s.faults, s.components, s.phase_names),
)
