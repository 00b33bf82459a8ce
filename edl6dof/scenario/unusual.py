"""Values of a scenario that are allowed but unusual, alone or for a vehicle of this size.

Usually nozzles lie within two radii of the centre of mass, the radii of gyration are between a tenth and the
whole of the radius, and the ballistic coefficient at a drag coefficient of 1.5 is between 10 and 1,000 kg/m2
(Stardust 60, Tianwen-1 90, Galileo's probe 240: Davies and Arcadi, NASA/TM-2006-213401).
"""

from __future__ import annotations

from math import dist, pi, sqrt

from pydantic.fields import FieldInfo

from edl6dof.config.document.yamltree import dotted
from edl6dof.config.model_paths import leaves, numbers, usual_range
from edl6dof.config.units import split_unit
from edl6dof.fsw.guidance.entry.registry import OWN_REVERSALS
from edl6dof.scenario.entry_range import out_of_range
from edl6dof.scenario.schema import Scenario
from edl6dof.vehicle.vehicle import VehicleParams

#: Distance of a nozzle from the centre of mass, and radius of gyration, over the radius of the vehicle.
REACH = 2.0
GYRATION = (0.1, 1.0)
#: Ballistic coefficient, kg/m2, and the drag coefficient that it is formed with.
BALLISTIC = (10.0, 1000.0)
BLUNT = 1.5


def unusual_in(scenario: Scenario) -> dict[str, str]:
    """Map the dotted path of each unusual value of a validated scenario to one line of explanation."""
    proportions = _out_of_proportion(scenario.vehicle) if scenario.dynamics == "six_dof" else {}
    alone = {
        dotted(keys): words
        for _, keys, info, value in leaves(scenario)
        if (words := _why_unusual(str(keys[-1]), info, numbers(value)))
    }
    far = out_of_range(scenario, radius_m(scenario.vehicle))
    found = alone | {f"vehicle.{path}": words for path, words in proportions.items()}
    found |= {"terrain.site_latitude_deg": far} if far else {}
    if scenario.vehicle.rcs.thrusters and not scenario.vehicle.tanks:
        found["vehicle.rcs.thrusters"] = "the vehicle has no tank (vehicle.tanks), so no thruster ever fires"
    entry = scenario.flight_software.guidance.entry
    if entry.law in OWN_REVERSALS and "logic" not in entry.reversal.model_fields_set:
        found["flight_software.guidance.entry.law"] = (
            f"{entry.law} plans its own reversals, but reversal.logic is not set, so {entry.reversal.logic} "
            "chooses the side: set reversal.logic to own_sign to fly the planned reversals"
        )
    return found


def _why_unusual(name: str, info: FieldInfo, values: list[float]) -> str:
    usual = usual_range(info) if values else None
    if usual is None:
        return ""
    if usual.of_magnitude:
        values = [largest] if (largest := max(map(abs, values))) else []
    odd = [value for value in values if not usual.low <= value <= usual.high]
    if not odd:
        return ""
    unit = f" {label}" if (label := split_unit(name)[1].label) else ""
    return f"{odd[0]:g}{unit} is unusual: {usual.low:g} to {usual.high:g}{unit} ({usual.reason})"


def radius_m(vehicle: VehicleParams) -> float:
    """Radius (m) of the vehicle at entry, from its aerodynamic shape; 0 if the shape has no size."""
    aero = vehicle.aero
    if aero.model == "capsule":
        return 0.5 * aero.capsule.diameter_m
    areas_m2 = {
        "constant": aero.constant.reference_area_m2,
        "lift_drag": aero.lift_drag.reference_area_m2,
        "body": aero.body.reference_area_m2,
    }
    return sqrt(areas_m2.get(aero.model, 0.0) / pi)


def _out_of_proportion(vehicle: VehicleParams) -> dict[str, str]:
    radius, mass = radius_m(vehicle), vehicle.mass
    if radius == 0.0:
        return {}
    found = {}
    nozzles = {f"rcs.thrusters.{k}.position_m": jet.position_m for k, jet in enumerate(vehicle.rcs.thrusters)}
    nozzles |= {f"engines.{k}.nozzle_m": engine.nozzle_m for k, engine in enumerate(vehicle.engines)}
    for path, place in nozzles.items():
        off = dist(place, mass.entry_centre_m)
        if off > REACH * radius:
            found[path] = (
                f"{off:.3g} m from the centre of mass is unusual: up to {REACH:g} radii of the vehicle, "
                f"{REACH * radius:.3g} m"
            )
    for k, inertia in enumerate(mass.entry_inertia_kg_m2 or ()):
        share = sqrt(inertia / mass.entry_kg) / radius
        if not GYRATION[0] <= share <= GYRATION[1]:
            found[f"mass.entry_inertia_kg_m2.{k}"] = (
                f"{inertia:g} kg m2 is unusual: a radius of gyration of {share:.2g} radii of the vehicle, "
                f"not {GYRATION[0]:g} to {GYRATION[1]:g}"
            )
    ballistic = mass.entry_kg / (BLUNT * pi * radius * radius)
    if not BALLISTIC[0] <= ballistic <= BALLISTIC[1]:
        found["mass.entry_kg"] = (
            f"{mass.entry_kg:g} kg is unusual: ballistic coefficient {ballistic:.3g} kg/m2 at this size, "
            f"not {BALLISTIC[0]:g} to {BALLISTIC[1]:g}"
        )
    return found
