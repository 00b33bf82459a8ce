"""Reports of runs and campaigns: one page for the contents of a folder."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path

from edl6dof.config.errors import refusal
from edl6dof.report.document import Report
from edl6dof.runs.files import atomic_file, refuse_existing_file


def write_report(folder: Path, out: Path | None, pdf: bool, png: bool, force: bool) -> list[Path]:
    """Write ``report.html`` into the folder or to ``out``, or with ``pdf`` and ``png`` the forms for papers
    instead; return the paths written.

    Raises:
        ConfigError: the folder contains no results to report, or a file must not be replaced.
    """
    target = out or folder / "report.html"
    for path in [target.with_suffix(".pdf")] * pdf or [target] * (not png):
        refuse_existing_file(path, force, folder)
    report = report_of(folder)
    writers: dict[Path, Callable[[Path], object]] = {}
    if png:
        from edl6dof.report.matplotlib_figure import write_figure

        pictures = target.with_suffix("")
        writers |= {pictures / f"{one.key}.png": partial(write_figure, one) for one in report.figures()}
    for path, write in writers.items():
        with atomic_file(path, force, folder) as unfinished:
            write(unfinished)
    pages = [target.with_suffix(".pdf")] if pdf else [] if png else [target]
    for path in pages:
        write_page(report, path, force, folder)
    return [*writers, *pages]


def report_of(folder: Path) -> Report:
    """Return the report of a folder: that of a flight or that of a campaign.

    Raises:
        ConfigError: the folder contains no results to report.
    """
    if (folder / "telemetry.parquet").is_file():
        from edl6dof.report.flight.flight_report import flight_report
        from edl6dof.runs.run import Run

        return flight_report(Run(folder))
    if (folder / "campaign.json").is_file():
        from edl6dof.report.campaign.campaign_report import campaign_report

        return campaign_report(folder)
    if not folder.is_dir():
        raise refusal(folder, "no such folder; name that of a run or a campaign")
    raise refusal(folder, "holds nothing to report on (no telemetry.parquet); name the folder of a run")


def write_page(report: Report, path: Path, force: bool, made_from: Path) -> None:
    """Write a report made from the result in a folder: as PDF if the path ends so, else as one HTML file."""
    with atomic_file(path, force, made_from) as unfinished:
        if path.suffix == ".pdf":
            from edl6dof.report.pdf import write_pdf

            write_pdf(report, unfinished)
        else:
            from edl6dof.report.page import page

            unfinished.write_text(page(report), encoding="utf-8")
