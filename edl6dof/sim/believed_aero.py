"""Trim the nominal vehicle on the ground and tabulate for the flight computer what drag and lift follow, over Mach number."""

from __future__ import annotations

from collections.abc import Callable
from math import cos, radians, sin

import numpy as np

from edl6dof.config.dtype import dtype_of, fill
from edl6dof.fsw.guidance.entry.airframe import mach_nodes
from edl6dof.sim.scenario import Scenario
from edl6dof.vehicle.aerodynamics import capsule_aero
from edl6dof.vehicle.trim_wing import wing_force
from edl6dof.vehicle.vehicle import VehicleParams

#: Density (kg/m3) dense enough for continuum flow.
CONTINUUM = 1e-3
#: Angles of attack (rad) between which the trim is sought, around the one commanded.
SEARCH = radians(12.0)


def fill_airframe(airframe: np.void, scenario: Scenario, tables: np.ndarray, drag_area: float, lift_to_drag: float) -> None:
    """Fill an ``AIRFRAME`` record for the nominal capsule of ``scenario``, relative to one drag area and lift-to-drag ratio."""
    vehicle = np.zeros(1, dtype_of(VehicleParams))
    fill(vehicle[0], scenario.vehicle)
    airframe["wing_mach"] = _wing_mach(scenario)
    goal = radians(scenario.flight_software.guidance.entry.trim_alpha_deg)
    for i, mach in enumerate(mach_nodes()):
        drag, lift = _drag_and_lift(vehicle[0], tables[0]["aero"], mach, _trim(vehicle[0], tables[0]["aero"], mach, goal), 0.0)
        airframe["drag"][i] = drag / drag_area
        airframe["lift"][i] = lift / drag / lift_to_drag if lift_to_drag else 1.0
        airframe["drag_with_wing"][i] = _drag_and_lift(vehicle[0], tables[0]["aero"], mach, 0.0, 1.0)[0] / drag_area


def _wing_mach(scenario: Scenario) -> float:
    """Mach number at which the mission table opens the trim wing; 0 when it does not, or not by Mach number."""
    events = [event for phase in scenario.mission.phases for event in phase.events if event.do == "trim_wing"]
    return next((event.when.value for event in events if event.when.quantity == "mach"), 0.0)


def _force_and_moment(vehicle: np.void, table: np.void, mach: float, alpha: float, wing: float) -> tuple[float, float, float]:
    """Fx and Fz (m2, force over dynamic pressure) and pitching moment about the centre of mass (m3)."""
    u, w = cos(alpha), sin(alpha)
    fx, _, fz, _, my, _ = capsule_aero(vehicle["aero"], table, 1.0, mach, CONTINUUM, u, 0.0, w, 0.0, 0.0, 0.0)
    gx, _, gz, _, ny, _ = wing_force(vehicle["trim_wing"], wing, 1.0, u, 0.0, w)
    cg_x, _, cg_z = vehicle["mass"]["entry_centre"]
    my += (0.0 - cg_z) * fx - (table["moment_reference_x"] - cg_x) * fz
    ny += -cg_z * gx + cg_x * gz
    return fx + gx, fz + gz, my + ny


def _trim(vehicle: np.void, table: np.void, mach: float, goal: float) -> float:
    """Angle of attack (rad) without pitching moment nearest the commanded one; that itself where there is none."""

    def moment(alpha: float) -> float:
        return _force_and_moment(vehicle, table, mach, alpha, 0.0)[2]

    low, high = goal - SEARCH, goal + SEARCH
    return _bisect(moment, low, high) if moment(low) * moment(high) < 0.0 else goal


def _bisect(function: Callable[[float], float], low: float, high: float) -> float:
    """Root between two arguments where ``function`` has different signs; scipy's solvers cost 34 MB and 0.4 s of every start."""
    rising = function(high) > 0.0
    while low < (middle := 0.5 * (low + high)) < high and high - low > 1e-12:
        low, high = (low, middle) if (function(middle) > 0.0) == rising else (middle, high)
    return middle


def _drag_and_lift(vehicle: np.void, table: np.void, mach: float, alpha: float, wing: float) -> tuple[float, float]:
    """Drag and upward lift area (m2) at bank 0."""
    fx, fz, _ = _force_and_moment(vehicle, table, mach, alpha, wing)
    return -(fx * cos(alpha) + fz * sin(alpha)), fx * sin(alpha) - fz * cos(alpha)
