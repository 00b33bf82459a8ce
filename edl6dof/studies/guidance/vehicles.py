"""The entries that the comparison flies: two missions in six degrees of freedom on instruments, with either
trigger of their parachute, and the point masses of three papers.

A paper's point mass is flown here with what a vehicle has: a bank angle that turns at a rate, and a drag
reference that is updated by the range to go.  The paper as it is printed is flown by its own study.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from math import degrees
from typing import Any

import numpy as np

from edl6dof.config.base import stated
from edl6dof.config.model_paths import value_at
from edl6dof.fsw.guidance.entry.prediction.reference import reference_bank
from edl6dof.scenario.loading import LoadedScenario, load_scenario
from edl6dof.scenario.records import build_records
from edl6dof.scenario.schema import Scenario
from edl6dof.studies.cases import Spread, draw

ENTRY = "flight_software.guidance.entry"
SEED = 2021

_BANK_RATE_DEG_S = 20.0
#: What the point mass of a paper is given to be flown like a vehicle.
_AS_A_VEHICLE = (
    "point_mass.bank_response=rate_limited",
    f"point_mass.bank_rate_deg_s={_BANK_RATE_DEG_S:g}",
    f"{ENTRY}.bank_rate_deg_s={_BANK_RATE_DEG_S:g}",
    f"{ENTRY}.tracking.update=true",
)


@dataclass(frozen=True)
class Vehicle:
    """An entry by the name of its scenario.

    Attributes:
        name: of the scenario.
        changes: ``--set`` texts that this comparison adds.
        dispersed: whether it is flown with everything dispersed, too.
    """

    name: str
    changes: tuple[str, ...] = ()
    dispersed: bool = False

    def load(self, *more: str) -> LoadedScenario:
        """The scenario down to the mortar."""
        return load_scenario(self.name, ["mission.goal=deployment", *self.changes, *more])


VEHICLES = (
    *(Vehicle(name, dispersed=True) for name in ("tianwen1", "tianwen1_range_trigger")),
    *(Vehicle(name, dispersed=True) for name in ("msl", "msl_range_trigger")),
    Vehicle("zheng2015", _AS_A_VEHICLE),
    Vehicle("wu2013", _AS_A_VEHICLE),
    Vehicle("yan2016", _AS_A_VEHICLE),
)

#: What a law is flown with besides: FNPEG plans its reversals itself.
_WITH_LAW = {"fnpeg": (f"{ENTRY}.reversal.logic=own_sign",)}

_INERTIA = "vehicle.mass.entry_inertia_kg_m2"
#: Three sigma, absolute.
_ABSOLUTE = {
    "initial.flight_path_angle_deg": 0.3,
    "initial.speed_m_s": 6.0,
    "initial.latitude_deg": 0.1,
    "initial.longitude_deg": 0.1,
    "initial.azimuth_deg": 0.1,
    "vehicle.aero.capsule.axial_factor": 0.05,
    "vehicle.aero.capsule.normal_factor": 0.1,
    "vehicle.aero.capsule.moment_bias": 0.0025,
    "vehicle.aero.capsule.damping_factor": 0.75,
    "vehicle.surfaces.trim_wing.moment_factor": 0.15,
    "atmosphere.density_factor": 0.2,
    "wind.scale": 0.5,
}
#: Three sigma, of the nominal value.
_RELATIVE = {"vehicle.mass.entry_kg": 15.0 / 1285.0, **{f"{_INERTIA}.{i}": 0.1 for i in range(3)}}
#: Three sigma of the centre of mass (x, y, z), of the diameter: 10 mm along and 5 mm across the axis for
#: Tianwen-1.
_CENTRE = (0.010 / 3.4, 0.005 / 3.4, 0.005 / 3.4)
_THRUST = 0.05


def with_law(vehicle: Vehicle, law: str) -> LoadedScenario:
    """The entry flown by a law; the open-loop law flies the bank angle that was planned."""
    planned = vehicle.load(f"{ENTRY}.reference_bank.fit_range=true")
    return vehicle.load(
        "simulation.log_every=5",
        f"{ENTRY}.law={law}",
        *_WITH_LAW.get(law, ()),
        f"{ENTRY}.bank_profile={json.dumps({'points': planned_bank(planned)})}",
    )


def planned_bank(loaded: LoadedScenario) -> list[dict[str, float]]:
    """The planned bank angle as points of an open-loop profile over speed."""
    onboard = build_records(loaded).onboard[0]
    shift = float(onboard["reference"]["shift"])
    slowest = loaded.scenario.flight_software.guidance.entry.align_speed_m_s + 1.0
    return [
        {"at": round(float(v), 3), "bank_deg": degrees(reference_bank(onboard, shift, v))}
        for v in np.linspace(slowest, loaded.scenario.initial.speed, 16)
    ]


def spreads(scenario: Scenario) -> Iterator[Spread]:
    """Dispersions of a vehicle in six degrees of freedom about its own nominal.

    Section 8 of the Tianwen-1 reference numbers, as in the campaign ``tianwen1_mc``, as far as they act
    before the parachute; one factor of 5 % stands for the axial force, whose error there depends on the Mach
    number.  The mean wind is off by half at three sigma; more of it is a condition of its own.  The other
    vehicle gets the same relative errors.
    """
    for path, three_sigma in _ABSOLUTE.items():
        yield Spread(path, value_at(scenario, path), three_sigma)
    for path, share in _RELATIVE.items():
        yield Spread(path, mean := value_at(scenario, path), share * abs(mean))
    diameter = scenario.vehicle.aero.capsule.diameter_m
    for axis, share in enumerate(_CENTRE):
        path = f"vehicle.mass.entry_centre_m.{axis}"
        yield Spread(path, value_at(scenario, path), share * diameter)
    for jet in scenario.vehicle.rcs.thrusters:
        yield Spread(f"vehicle.rcs.thrusters.{jet.name}.thrust_n", jet.thrust_n, _THRUST * jet.thrust_n)


def entries(scenario: Scenario, flights: int) -> list[dict[str, Any]]:
    """True values of dispersed entries.

    The three moments of inertia grow and shrink together: a body whose axes are dispersed one by one may be
    none that exists.
    """
    nominal = stated(scenario.vehicle.mass.entry_inertia_kg_m2)
    drawn: list[dict[str, Any]] = list(draw(list(spreads(scenario)), flights, SEED))
    for truth in drawn:
        factor = truth[f"{_INERTIA}.0"] / nominal[0]
        truth.update({f"{_INERTIA}.{i}": factor * value for i, value in enumerate(nominal)})
    return drawn
