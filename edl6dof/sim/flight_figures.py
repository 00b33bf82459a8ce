"""Figures of merit of a finished flight, from all that form them."""

from __future__ import annotations

import numpy as np

from edl6dof.metrics.evaluation import (
    deployment_figures,
    event_figures,
    formed,
    peak_figures,
    relaxation_figures,
)
from edl6dof.metrics.figures import Flown
from edl6dof.metrics.out_of_use import diagnosis_figures, exclusion_figures
from edl6dof.metrics.record_figures import (
    balance_figures,
    drift_figures,
    hazard_figures,
    touchdown_state,
    touchdown_terrain_figures,
)
from edl6dof.sim.flight_records import FlightRecords
from edl6dof.telemetry.timeline import first_times, moments


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
            figures |= exclusion_figures(flight.exclusions, truth.faults, truth.components, plant)
        return figures | _hazard(flight, figures, when) | _deployment(flight, figures)


def _hazard(flight: FlightRecords, figures: dict[str, float], when: dict[str, float]) -> dict[str, float]:
    """Figures of hazard detection; empty without it."""
    if flight.scenario.flight_software.hazard.detection == "given":
        return {}
    lines = max((chute.line_length_m for chute in flight.scenario.vehicle.parachutes), default=0.0)
    return drift_figures(flight.telemetry, when, lines) | hazard_figures(
        flight.case, flight.fsw[0], flight.telemetry, figures
    )


def _deployment(flight: FlightRecords, figures: dict[str, float]) -> dict[str, float]:
    """Miss of the aim point where the parachute opened; empty without a mortar or without entry guidance."""
    phases = flight.scenario.mission.phases
    if "parachute_s" not in figures or all(phase.guidance != "entry" for phase in phases):
        return {}
    radius_m = flight.scenario.planet.equatorial_radius_m
    return deployment_figures(flight.telemetry, figures["parachute_s"], flight.aim_point, radius_m)
