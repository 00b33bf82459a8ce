"""Scenario and settings of the study, and the law and the vehicle as its models take them."""

from __future__ import annotations

import numpy as np

from edl6dof.config.base import stated
from edl6dof.fsw.guidance.entry.laws.adaptive_hinf import MEMORY, begin
from edl6dof.scenario.loading import LoadedScenario
from edl6dof.scenario.records import build_onboard
from edl6dof.studies.lu_bayard.drag_model import Design
from edl6dof.studies.lu_bayard.free_lift import Setting

ENTRY = "flight_software.guidance.entry"
#: The scenario of the vehicle, and what is changed in it; limits of the vehicle are estimates.
SCENARIO = "wu2013"
VEHICLE = (
    f"{ENTRY}.law=adaptive_hinf",
    f"{ENTRY}.limits={{heat_rate_w_cm2: 100.0, nose_radius_m: 1.1, "
    "load_g0: 15.0, dynamic_pressure_pa: 18000.0}",
    f"{ENTRY}.tracking.update=false",
)
#: The paper prints rho = 1 and lambda > 1, no number of either lambda or epsilon.
AS_PRINTED = (
    *VEHICLE,
    f"{ENTRY}.adaptive_hinf={{settings: as_printed, start_drag_m_s2: 7.0, disturbance_gain: 2.0, "
    "adaptation_energy: 20.0}",
)
FLOWN = (
    *VEHICLE,
    f"{ENTRY}.adaptive_hinf={{start_drag_m_s2: 7.0, disturbance_gain: 40.0, control_weight: 625.0, "
    "adaptation_energy: 20.0}",
)
#: Drag error (m/s2) at the start of what is integrated.
START_ERROR = 2.0


def design_of(onboard: np.ndarray) -> Design:
    """Settings of the law as it flies."""
    law, planet = onboard[0]["guidance"]["entry"]["adaptive_hinf"], onboard[0]["planet"]
    memory = np.zeros(1, MEMORY)[0]
    begin(law, memory)
    radius = float(planet["equatorial_radius"])
    return Design(
        float(law["disturbance_gain"]),
        float(law["control_weight"]),
        float(law["adaptation_energy"]),
        memory["low"].copy(),
        memory["high"].copy(),
        float(planet["mu"]) / radius**2,
        radius,
        scale_height_of(onboard),
    )


def scale_height_of(onboard: np.ndarray) -> float:
    """Scale height (m) of the air that is believed, which is exponential."""
    air = onboard[0]["atmosphere"]
    return float(-air["spacing"] / (air["ln_density"][1] - air["ln_density"][0]))


def setting_of(loaded: LoadedScenario) -> Setting:
    """What the flights with free lift need of a scenario."""
    onboard = build_onboard(loaded.scenario)
    vehicle, air = onboard[0]["vehicle"], stated(loaded.scenario.atmosphere.exponential)
    return Setting(
        onboard,
        design_of(onboard),
        float(vehicle["drag_area"] / vehicle["entry_mass"]),
        air.density_kg_m3,
        START_ERROR,
    )
