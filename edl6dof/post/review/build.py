"""The report of one flight, put together from its parts."""

from __future__ import annotations

from edl6dof.post.report.document import Report, Section
from edl6dof.post.review import trajectory, words
from edl6dof.post.run import Run


def flight_report(run: Run) -> Report:
    """The review of a run."""
    sections = [
        Section("verdict", "Verdict and limits", [words.limits(run), words.published(run)]),
        Section("timeline", "Timeline", [words.timeline(run)]),
        Section("trajectory", "Trajectory", list(trajectory.figures(run))),
        Section("configuration", "Configuration", list(words.configuration(run))),
        Section("software", "Software", [words.software(run)]),
    ]
    return Report(
        title=run.name,
        subtitle=str(run.scenario.get("description") or ""),
        verdict=words.verdict(run),
        mood=words.mood(run.summary),
        facts=words.facts(run),
        sections=[section for section in sections if section.blocks],
        footer=f"edl6dof {run.summary['edl6dof_version']}; scenario SHA-256 {run.summary['scenario_sha256']}",
    )
