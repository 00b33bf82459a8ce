"""The report of one flight, put together from its parts."""

from __future__ import annotations

from edl6dof.report.document import Report, Section
from edl6dof.report.flight import (
    actuators,
    diagnosis,
    hazards,
    navigation,
    phase_planes,
    site,
    trajectory,
    words,
)
from edl6dof.report.flight.parts import over_flight
from edl6dof.report.panels import STACKS
from edl6dof.runs.run import Run


def flight_report(run: Run) -> Report:
    """The review of a run; a section about what the flight did not have is left out."""
    sections = [
        Section("limits", "Limits and published flight", list(words.limits_and_published(run))),
        Section("events", "Timeline", list(words.timeline(run))),
        Section("trajectory", "Trajectory", list(trajectory.figures(run))),
        Section("guidance", "Entry guidance", list(over_flight(run, STACKS["guidance"]))),
        Section("navigation", "Navigation", list(navigation.figures(run))),
        Section("attitude", "Attitude", list(over_flight(run, STACKS["attitude"]))),
        Section("phase_planes", "Phase planes", list(phase_planes.figures(run))),
        Section("actuators", "Thrusters and propellant", list(actuators.figures(run))),
        Section("disturbances", "Disturbances", list(actuators.disturbances(run))),
        Section("diagnosis", "Fault diagnosis", list(diagnosis.figures(run))),
        Section("chute", "Parachute", list(over_flight(run, STACKS["chute"]))),
        Section(
            "landing",
            "Powered descent",
            [*trajectory.descent_plane(run), *over_flight(run, STACKS["landing"])],
        ),
        Section("hazards", "Hazards and the chosen spot", list(hazards.figures(run))),
        Section("site", "Ground track and landing site", list(site.figures(run))),
        Section("configuration", "Configuration", list(words.configuration(run))),
        Section("software", "Software and data", [words.software(run)]),
    ]
    return Report(
        title=run.name,
        subtitle=words.subtitle(run),
        headline=words.headline(run),
        mood=words.mood(run.summary),
        facts=words.facts(run),
        sections=[section for section in sections if section.blocks],
        footer=f"edl6dof {run.summary['edl6dof_version']}; scenario SHA-256 {run.summary['scenario_sha256']}",
    )
