"""Records of a finished flight, its figures of merit, and the moments of its timeline that are no events of
its mission.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from edl6dof.metrics.evaluation import (
    deployment_figures,
    event_figures,
    formed,
    peak_figures,
    relaxation_figures,
)
from edl6dof.metrics.figures import Flown
from edl6dof.metrics.out_of_use import (
    Exclusion,
    IsolatedFault,
    diagnosis_figures,
    exclusion_figures,
    exclusions,
    isolated_faults,
)
from edl6dof.metrics.record_figures import (
    balance_figures,
    drift_figures,
    hazard_figures,
    touchdown_state,
    touchdown_terrain_figures,
)
from edl6dof.scenario.loaded import LoadedScenario
from edl6dof.scenario.schema import Scenario
from edl6dof.sim.checkpoint import State
from edl6dof.sim.flight_state import phase_name
from edl6dof.telemetry.columns import Telemetry
from edl6dof.telemetry.landing_map import LandingMap, landing_map
from edl6dof.telemetry.timeline import Moment, first_times, moment, moments
from edl6dof.vehicle.plant import NOT_BEGUN


@dataclass(repr=False)
class FlightRecords:
    """The records of a flight at its end, and its telemetry.

    Attributes:
        loaded: scenario and where it came from.
        case: true parameters, ``CASE`` record array of length one.
        tables: the arrays that the case reads, ``TABLES``, shared with others.
        plant: final true state, ``STATE`` record.
        outputs: quantities that follow from the final state, ``OUTPUTS`` record.
        peaks: the largest loads met, ``PEAKS`` record.
        fsw: final flight-software memory.
        log: telemetry rows, ``TICK`` or ``BRIEF`` records in SI units.
        aim_point: latitude and longitude (rad) that entry guidance steered to.
        code: outcome code of the loop.
        flown_cycles: base cycles flown by this call.
        saved: state at the time at which one was to be saved, if the flight reached it.
        not_finite: first quantity that was not finite, if that ended the flight.
    """

    loaded: LoadedScenario
    case: np.ndarray
    tables: np.ndarray
    plant: np.ndarray
    outputs: np.ndarray
    peaks: np.ndarray
    fsw: np.ndarray
    log: np.ndarray
    aim_point: tuple[float, float]
    code: int
    flown_cycles: int = 0
    saved: State | None = field(default=None, repr=False)
    not_finite: str | None = None

    @property
    def scenario(self) -> Scenario:
        """The validated scenario."""
        return self.loaded.scenario

    @property
    def name(self) -> str:
        """Name of the scenario."""
        return self.scenario.name

    @property
    def phase_names(self) -> list[str]:
        """Names of the mission phases; ``guide.phase`` is the index."""
        return self.scenario.phase_names

    @property
    def time_s(self) -> float:
        """Time at the end of the flight."""
        return float(self.plant["t"][0])

    @property
    def phase(self) -> str:
        """Name of the last phase."""
        return phase_name(self.scenario, self.fsw)

    @cached_property
    def telemetry(self) -> Telemetry:
        """Columns by name (:mod:`edl6dof.telemetry.channels`), each shape (rows,), in its unit."""
        scenario = self.scenario
        return Telemetry(self.log, scenario.thruster_names, scenario.beam_names, list(scenario.branches))

    @cached_property
    def isolated_faults(self) -> list[IsolatedFault]:
        """Thrusters the flight computer took out of use, and why."""
        return isolated_faults(self.fsw[0], self.scenario.thruster_names)

    @cached_property
    def exclusions(self) -> list[Exclusion]:
        """Instruments that the flight computer took out of use and back."""
        return exclusions(self.fsw[0], self.scenario.components)

    @cached_property
    def landing_map(self) -> LandingMap | None:
        """Map of the ground that the lander scanned, and the spot chosen; ``None`` without a scan."""
        return landing_map(self.fsw[0])


def figures_of(flight: FlightRecords) -> dict[str, float]:
    """Figures by name with unit suffix."""
    scenario, truth, plant = flight.scenario, flight.loaded.truth, flight.plant[0]
    happened = first_times(moments(plant, flight.fsw[0], scenario.mission, scenario.vehicle))
    # a flight continued from a saved state has no telemetry of what happened before
    when = {key: t for key, t in happened.items() if t >= flight.telemetry["t_s"][0] - 1e-9}
    with np.errstate(invalid="ignore", over="ignore"):  # what is not finite gives figures that are not
        flown = Flown(flight.telemetry, when, scenario.phase_roles)
        figures = formed(flown, "events", "telemetry")
        done = dict(zip(scenario.mission.events, plant["done"].tolist(), strict=False))
        figures |= event_figures(flight.telemetry, scenario.published, done)
        figures |= peak_figures(plant, flight.peaks[0], happened)
        figures |= relaxation_figures(flight.fsw[0]["guidance"]["relaxed"])
        figures |= balance_figures(flight.case, flight.plant)
        figures |= touchdown_state(flight.case, flight.plant)
        figures |= touchdown_terrain_figures(flight.case, flight.tables, flight.plant, flight.outputs)
        figures |= diagnosis_figures(
            flight.isolated_faults, truth.faults, truth.components, truth.branches, plant
        )
        if scenario.navigation_filter != "given":
            figures |= formed(flown, "navigation")
            radars = truth.sensors.radar.radars
            figures |= exclusion_figures(flight.exclusions, truth.faults, truth.components, radars, plant)
        lines = max((chute.line_length_m for chute in flight.scenario.vehicle.parachutes), default=0.0)
        figures |= drift_figures(flight.telemetry, when, lines)
        return figures | _hazard(flight, figures) | _deployment(flight, figures)


def _hazard(flight: FlightRecords, figures: dict[str, float]) -> dict[str, float]:
    """Figures of hazard detection and of the site of the map; empty without either."""
    hazard = flight.scenario.flight_software.hazard
    if hazard.detection == "given" and hazard.sites.spacing_m == 0.0:
        return {}
    return hazard_figures(flight.case, flight.fsw[0], flight.telemetry, figures)


def _deployment(flight: FlightRecords, figures: dict[str, float]) -> dict[str, float]:
    """Miss of the aim point where the parachute opened; empty without a mortar or without entry guidance."""
    phases = flight.scenario.mission.phases
    if "parachute_s" not in figures or all(phase.guidance != "entry" for phase in phases):
        return {}
    radius_m = flight.scenario.planet.equatorial_radius_m
    return deployment_figures(flight.telemetry, figures["parachute_s"], flight.aim_point, radius_m)


def timeline_moments(flight: FlightRecords) -> list[Moment]:
    """Moments for the timeline of a flight."""
    return [*_wing(flight), *_faults(flight), *_found(flight)]


def _wing(flight: FlightRecords) -> list[Moment]:
    """Moment at which the last trim wing is fully open, unless a fault stopped one before."""
    truth, plant = flight.loaded.truth, flight.plant[0]
    starts = zip(truth.vehicle.surfaces, plant["wing_start"], strict=False)
    ends = {one.name: float(t) + one.deploy_time_s for one, t in starts if t < NOT_BEGUN}
    opened = max(ends.values(), default=np.inf)
    stopped = any(
        fault.component == "surface" and since < ends.get(fault.acts_on(truth.components), -np.inf)
        for fault, since in zip(truth.faults, plant["fault_since"], strict=False)
    )
    return [] if stopped or opened > flight.time_s else [moment(opened, "trim_wing_open", "trim wing open")]


def _faults(flight: FlightRecords) -> list[Moment]:
    """Faults that began."""
    truth = flight.loaded.truth
    return [
        moment(since, "fault", f"fault: {fault.label(truth.components)}")
        for fault, since in zip(truth.faults, flight.plant["fault_since"][0], strict=False)
        if since != NOT_BEGUN
    ]


def _found(flight: FlightRecords) -> list[Moment]:
    """Thrusters and instruments that the flight computer took out of use."""
    found = [
        moment(one.t_s, "diagnosis", f"diagnosis: {one.label}", thruster=one.thruster, isolated=one.label)
        for one in flight.isolated_faults
    ]
    found += [
        moment(one.t_s, "exclusion", one.label, component=one.component, instrument=one.instrument,
               back=one.back)
        for one in flight.exclusions
    ]  # fmt: skip
    return found
