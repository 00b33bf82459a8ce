"""The scenario file: planet, environment, vehicle, initial state, flight software, mission, limits; its
landing site and initial state in planet-fixed axes.
"""

from __future__ import annotations

from functools import partial
from math import radians
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import field_validator

from edl6dof.config.base import REQUIRED, Capacity, Params, group, param, section, stated
from edl6dof.config.document.locate import why_no_folder
from edl6dof.environment.areoid import areoid_height
from edl6dof.environment.atmosphere import AtmosphereParams
from edl6dof.environment.planet import PlanetParams
from edl6dof.environment.site_climate import Place
from edl6dof.environment.terrain import TerrainParams
from edl6dof.environment.wind import WindParams
from edl6dof.fsw.mission import MissionParams
from edl6dof.fsw.onboard import FlightSoftwareParams
from edl6dof.interface.capacities import MAX_FAULTS
from edl6dof.metrics.published import PublishedFigure
from edl6dof.scenario.initial import InitialState
from edl6dof.sensors.registry import SensorParams, instrument_names
from edl6dof.spatial.elementary import atan2, cos, hypot, sin
from edl6dof.spatial.frames import fill_local_frame, from_geodetic, ned_to_fixed
from edl6dof.vehicle.faults.component import Component, vehicle_components
from edl6dof.vehicle.faults.fault import FaultParams
from edl6dof.vehicle.motion.point_mass import PointMassParams
from edl6dof.vehicle.vehicle import VehicleParams


class SimulationParams(Params):
    """Integration, logging and when to stop."""

    step_s: float = param(0.02, "integration step", ge=1e-4, le=0.1)
    canopy_step_s: float = param(0.01, "longest step while a parachute is out", ge=1e-4, le=0.1)
    contact_step_s: float = param(0.0025, "longest step once the ground was touched", ge=1e-4, le=0.1)
    log_every: int = param(1, "base cycles of the flight software per row of telemetry", ge=1, le=1000)
    time_limit_s: float = param(
        900.0,
        "flight time after which the run ends",
        gt=0.0,
        le=20000.0,
        usual=(1, 20000, "drop tests to descents through thick air"),
    )
    rest_s: float = param(
        2.0,
        "time at rest on the ground after which a flight has landed; 0: it lands at contact",
        ge=0.0,
        le=60.0,
    )


#: A limit that a mission may set.
_limit = partial(param, None, record=False, gt=0.0)


class LimitParams(Params):
    """Limits of a successful landing, and limits that end a flight.

    A limit that is not set is not checked.
    """

    touchdown_vertical_m_s: float | None = _limit("vertical speed at first contact")
    touchdown_horizontal_m_s: float | None = _limit("horizontal speed at first contact")
    touchdown_tilt_deg: float | None = _limit("tilt from the vertical at first contact")
    touchdown_rate_deg_s: float | None = _limit("body rate at first contact")
    slope_deg: float | None = _limit("ground slope")
    largest_rock_m: float | None = _limit("largest rock under the lander")
    ground_under_belly_m: float | None = _limit(
        "ground under the belly, rocks too, above the plane of the footpads"
    )
    landing_distance_m: float | None = _limit("distance from the landing site")
    entry_load_g0: float | None = _limit("peak load of the entry, up to parachute deployment")
    entry_dynamic_pressure_pa: float | None = _limit("peak dynamic pressure")
    entry_heat_flux_w_cm2: float | None = _limit("peak heat flux at the stagnation point")
    parachute_mach_max: float | None = _limit("Mach number at mortar fire")
    parachute_dynamic_pressure_pa: float | None = _limit("dynamic pressure at mortar fire")
    parachute_total_alpha_deg: float | None = _limit("total angle of attack at mortar fire")
    backshell_speed_m_s: float | None = _limit("speed at backshell separation")
    backshell_height_m: float | None = _limit("height above ground at backshell separation")
    backshell_distance_m: float | None = _limit(
        "distance from backshell and canopy after their separation (least allowed value)"
    )
    skip_out_m: float = param(
        5000.0,
        "height above the initial altitude at which a flight that should land has skipped out",
        status="estimate",
        gt=0.0,
    )
    crash_speed_m_s: float = param(
        8.0, "speed at first contact beyond which the vehicle is lost", status="estimate", gt=0.0
    )
    body_rate_deg_s: float = param(
        300.0, "body rate beyond which attitude is lost (gyro range)", status="published", source="S1", gt=0.0
    )
    powered_tilt_deg: float = param(
        90.0,
        "tilt of -x of B from the vertical while an engine is on beyond which attitude is lost",
        gt=0.0,
        le=180.0,
    )
    total_alpha_deg: float = param(
        60.0, "total angle of attack in the flow beyond which attitude is lost", status="estimate", gt=0.0
    )


class Scenario(Params):
    """Everything one flight needs."""

    name: str = param(
        REQUIRED,
        "name of the scenario and of its run folder; where it extends another, by default that of its file",
        record=False,
        min_length=1,
    )
    description: str = param("", "subject of the scenario in a few words", record=False)
    plugins: list[str] = param(
        None,
        "Python files, relative to the folder of the scenario, whose members it may choose; "
        "they run with your user rights",
        record=False,
        factory=list,
    )
    seed: int = param(1, "seed of all random profiles", record=False, ge=0)
    profile: int = param(
        0,
        "number of the random profiles of this seed; a campaign gives each case its own",
        record=False,
        ge=0,
    )
    planet: PlanetParams = section("planet, by name or in full")
    atmosphere: AtmosphereParams = group(AtmosphereParams, "atmosphere")
    wind: WindParams = group(WindParams, "wind")
    terrain: TerrainParams = section("landing site and ground")
    vehicle: VehicleParams = section("vehicle, by file or in full")
    initial: InitialState = section("initial state")
    dynamics: Literal["six_dof", "point_mass"] = param(
        "six_dof",
        "rigid body, or a point mass whose bank angle follows the command down to the parachute",
        record=False,
    )
    point_mass: PointMassParams = group(PointMassParams, "used by dynamics point_mass")
    simulation: SimulationParams = group(SimulationParams, "integration and logging")
    sensors: SensorParams = group(SensorParams, "sensors")
    flight_software: FlightSoftwareParams = group(FlightSoftwareParams, "flight software")
    mission: MissionParams = group(MissionParams, "mission phases")
    limits: LimitParams = group(LimitParams, "limits of a successful flight")
    faults: Annotated[list[FaultParams], Capacity(MAX_FAULTS)] = param(
        None,
        "faults, unknown to the flight computer",
        record=False,
        factory=list,
        max_length=MAX_FAULTS,
    )
    truth: dict[str, Any] = param(
        None,
        "true values that differ from the on-board model, by dotted path, such as "
        "'vehicle.mass.entry_kg: 1300'",
        record=False,
        factory=dict,
    )
    published: dict[str, float | PublishedFigure | None] = param(
        None,
        "figures of the real flight: a flown value, or a requirement; null removes that of the extended file",
        status="published",
        record=False,
        factory=dict,
    )

    @field_validator("name")
    @classmethod
    def _names_a_folder(cls, value: str) -> str:
        if problem := why_no_folder(value):
            raise ValueError(problem)
        return value

    @property
    def initial_altitude_m(self) -> float:
        """Height (m) of the initial state above the ellipsoid."""
        initial = self.initial
        if initial.altitude_m is not None:
            return initial.altitude_m
        return stated(initial.height_above_areoid_m) + areoid_height(self.planet, *initial.place)

    @property
    def site_place(self) -> tuple[float, float]:
        """Geodetic latitude and east longitude (rad) of the landing site."""
        return radians(self.terrain.site_latitude_deg), radians(self.terrain.site_longitude_deg)

    @property
    def site(self) -> tuple[float, float, float]:
        """Geodetic latitude and east longitude (rad) of the landing site, and its altitude (m)."""
        return *self.site_place, self.site_areoid_m + self.terrain.site_elevation_m

    @property
    def site_areoid_m(self) -> float:
        """Height (m) of the areoid at the landing site above the ellipsoid."""
        return areoid_height(self.planet, *self.site_place)

    @property
    def place(self) -> Place:
        """The landing site and the moment of t = 0, on which the air may depend."""
        return Place(self.initial.epoch_utc, *self.site_place, self.terrain.site_elevation_m)

    @property
    def thruster_names(self) -> list[str]:
        """Names of the thrusters in the order of the vehicle file."""
        return [jet.name for jet in self.vehicle.rcs.thrusters]

    @property
    def beam_names(self) -> list[str]:
        """Names of the radar beams that fly."""
        return self.components.get("beam", [])

    @property
    def branches(self) -> dict[str, list[str]]:
        """Names of the propellant branches, and of the thrusters of each."""
        return {branch.name: branch.thrusters for branch in self.vehicle.rcs.laid_branches}

    @property
    def navigation_filter(self) -> str:
        """Name of the navigation filter that flies; ``given`` with perfect sensors, which need none."""
        perfect = self.sensors_in_flight.set == "perfect"
        return "given" if perfect else self.flight_software.navigation.filter

    @property
    def sensors_in_flight(self) -> SensorParams:
        """The sensors as they fly; a point mass has perfect ones, with its given navigation error."""
        if self.dynamics == "six_dof":
            return self.sensors
        return self.sensors.model_copy(update={"set": "perfect"})

    @property
    def components(self) -> dict[Component, list[str]]:
        """Names of all components that may fail, by kind."""
        sensors, branches = self.sensors_in_flight, list(self.branches)
        return {**vehicle_components(self.vehicle), **instrument_names(sensors, branches)}

    @property
    def phase_names(self) -> list[str]:
        """Names of the mission phases in order."""
        return [phase.name for phase in self.mission.phases]

    @property
    def phase_roles(self) -> list[str]:
        """Roles of the mission phases in order."""
        return [phase.role for phase in self.mission.phases]

    @property
    def steps_per_cycle(self) -> int:
        """Integration steps in one base cycle of the flight software."""
        return round(1.0 / self.flight_software.rates.base_hz / self.simulation.step_s)


#: Position (m) and velocity relative to the planet (m/s), in F.
Start = tuple[float, float, float, float, float, float]


def start_of(scenario: Scenario) -> Start:
    """Position and velocity of the initial state of a scenario."""
    planet, place = scenario.planet, scenario.initial.place
    r = from_geodetic(planet.equatorial_radius_m, planet.flattening, *place, scenario.initial_altitude_m)
    return *r, *ned_to_fixed(*vertical_axes(scenario), scenario.initial.velocity_ned)


def vertical_axes(scenario: Scenario) -> tuple[float, float, float, float]:
    """Return sine and cosine of the latitude, and sine and cosine of the longitude, of the vertical that the
    initial velocity refers to.
    """
    planet, (lat, lon) = scenario.planet, scenario.initial.place
    vertical = lat
    if scenario.initial.vertical == "geocentric":
        x, y, z = from_geodetic(
            planet.equatorial_radius_m, planet.flattening, lat, lon, scenario.initial_altitude_m
        )
        vertical = atan2(z, hypot(x, y))
    return sin(vertical), cos(vertical), sin(lon), cos(lon)


def fill_site(frame: np.void, scenario: Scenario) -> None:
    """Fill the ``LOCAL_FRAME`` record of the landing site."""
    planet = scenario.planet
    fill_local_frame(frame, planet.equatorial_radius_m, planet.flattening, *scenario.site)
