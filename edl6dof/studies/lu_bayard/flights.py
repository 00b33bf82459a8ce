"""The law and two constant bank angles flown by the simulator, whose bank angle has limits; w from the errors
that each flight was given.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from edl6dof.config.base import stated
from edl6dof.fsw.guidance.entry.profiles.drag_velocity import profile_drag
from edl6dof.interface.roles import LIFT
from edl6dof.scenario.loading import load_scenario
from edl6dof.scenario.records import build_onboard
from edl6dof.sim.flight import Flight, fly
from edl6dof.studies.lu_bayard.disturbance import disturbance_of
from edl6dof.studies.lu_bayard.drag_model import Design, Response, state_energy
from edl6dof.studies.lu_bayard.settings import AS_PRINTED, ENTRY, FLOWN, SCENARIO, design_of

LIFT_TO_DRAG = "vehicle.aero.lift_drag.lift_to_drag"
#: Settings, and true values of which the flight computer is not told.
FLIGHTS: dict[str, tuple[tuple[str, ...], dict[str, Any]]] = {
    "flown": (FLOWN, {}),
    "flown, lift 10 % low": (FLOWN, {LIFT_TO_DRAG: 0.216}),
    "flown, density 10 % high": (FLOWN, {"atmosphere.density_factor": 1.1}),
    "flown, path disturbed": (
        FLOWN,
        {
            "point_mass.disturbance.amplitude_rad_s": 0.0005,
            "point_mass.disturbance.frequency_rad_s": 0.3,
        },
    ),
    "as printed": (AS_PRINTED, {}),
    **{
        f"bank {bank} deg": (
            (*FLOWN, f"{ENTRY}.law=constant_bank", f"{ENTRY}.constant_bank.bank_deg={bank}"),
            {},
        )
        for bank in (20, 100)
    },
}


@dataclass(frozen=True)
class Flown:
    """One flight from the beginning of the profile to its end; arrays of shape (rows,) at the rate of
    guidance.
    """

    design: Design
    response: Response
    speed: np.ndarray
    drag: np.ndarray
    bank_deg: np.ndarray
    at_limit: float


def fly_one(overrides: tuple[str, ...], truth: dict[str, Any]) -> Flown:
    """Fly with these settings and true values."""
    changes = ", ".join(f"{path}: {value}" for path, value in truth.items())
    return flown(fly(load_scenario(SCENARIO, [*overrides, f"truth={{{changes}}}"])))


def flown(flight: Flight) -> Flown:
    """Drag error and the disturbance that its given errors are."""
    onboard = build_onboard(flight.scenario)
    design, entry = design_of(onboard), flight.scenario.flight_software.guidance.entry
    rows = _rows(flight, entry.adaptive_hinf.start_drag_m_s2)
    t, speed, drag = rows["t_s"], rows["truth.speed_m_s"], rows["nav.drag_m_s2"]
    profile = onboard[0]["plan"]["adaptive_hinf"]
    error = drag - np.array([profile_drag(profile, v)[0] for v in speed])
    bank = np.abs(rows["guide.bank_deg"])
    limits = (entry.bank_min_deg, entry.bank_max_deg)
    return Flown(
        design,
        Response(
            t,
            error,
            disturbance_of(design, t, drag, speed, _excess(flight, rows), _lift_error(flight, rows)),
            state_energy(design, error, np.gradient(error, t)),
        ),
        speed,
        drag,
        bank,
        float(np.mean(np.min([np.abs(bank - limit) for limit in limits], axis=0) < 0.01)),
    )


def _rows(flight: Flight, start_drag: float) -> dict[str, np.ndarray]:
    every = flight.scenario.flight_software.rates.entry_guidance_every
    rows = {name: column[::every] for name, column in flight.telemetry.items()}
    begun = np.cumsum(rows["nav.drag_m_s2"] >= start_drag) > 0
    kept = flight.during(LIFT)[::every] & begun
    return {name: column[kept] for name, column in rows.items()}


def _excess(flight: Flight, rows: dict[str, np.ndarray]) -> np.ndarray:
    """ln(rho / rho_model) + 2 ln(V_air / V)."""
    air = stated(flight.scenario.atmosphere.exponential)
    model = np.log(air.density_kg_m3) - rows["truth.height_above_areoid_m"] / air.scale_height_m
    wind = 2.0 * np.log(rows["truth.airspeed_m_s"] / rows["truth.speed_m_s"])
    return np.log(rows["truth.density_kg_m3"]) - model + wind


def _lift_error(flight: Flight, rows: dict[str, np.ndarray]) -> np.ndarray:
    """True less believed (L/D) cos(bank), and the input that a disturbance of the path rate amounts to."""
    loaded = flight.loaded
    true, believed = (
        scenario.vehicle.aero.lift_drag.lift_to_drag for scenario in (loaded.truth, loaded.scenario)
    )
    path = loaded.truth.point_mass.disturbance
    push = path.amplitude_rad_s * np.sin(path.frequency_rad_s * rows["t_s"])
    lift = (true - believed) * np.cos(np.radians(rows["truth.bank_deg"]))
    return lift + push * rows["truth.speed_m_s"] / rows["nav.drag_m_s2"]
