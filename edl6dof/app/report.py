"""``edl6dof report``: one page for whatever the folder holds."""

from __future__ import annotations

from pathlib import Path

from edl6dof.post.files import atomic_file, refuse_existing_file
from edl6dof.post.report.document import Report
from edl6dof.post.run import TELEMETRY, Run, refusal


def run_report(folder: Path, out: Path | None, pdf: bool, png: bool, force: bool) -> int:
    """Write ``report.html`` into the folder or to ``out``; with ``pdf`` and ``png`` the figures for papers beside it instead."""
    target = out or folder / "report.html"
    targets = [target.with_suffix(".pdf")] * pdf + [target.with_suffix("")] * png or [target]
    for path in targets:
        if path.suffix:
            refuse_existing_file(path, force)
    report = report_of(folder)
    for path in targets:
        _write(report, path, force)
        print(path)
    return 0


def report_of(folder: Path) -> Report:
    """The report of a folder, by what lies in it.

    Raises:
        ConfigError: nothing in it can be reported on.
    """
    if (folder / TELEMETRY).is_file():
        from edl6dof.post.review.build import flight_report

        return flight_report(Run(folder))
    raise refusal(folder, f"holds nothing to report on (no {TELEMETRY}); name the folder of a run")


def _write(report: Report, path: Path, force: bool) -> None:
    from edl6dof.post.report import page, paper

    if path.suffix == ".pdf":
        with atomic_file(path, force) as partial:
            paper.write_pdf(report, partial)
    elif not path.suffix:
        for figure in report.figures():
            with atomic_file(path / f"{figure.key}.png", force) as partial:
                paper.write_figure(figure, partial)
    else:
        with atomic_file(path, force) as partial:
            partial.write_text(page.page(report), encoding="utf-8")
