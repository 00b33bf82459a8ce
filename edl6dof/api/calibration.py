"""Fit uncertain parameters of a scenario to its published figures, and write the results."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import count
from pathlib import Path

from edl6dof.calibration.findings import Findings, find, overlay_text, plain, rounded
from edl6dof.calibration.fit import DESIGNS, TooFew
from edl6dof.calibration.problem import Calibration
from edl6dof.campaign.ensemble import FLIGHTS
from edl6dof.config.dump import json_text
from edl6dof.config.errors import refusal
from edl6dof.report.document import significant


def found_by(
    calibration: Calibration, scenario: str, progress: Callable[[int, int], None] | None = None
) -> Findings:
    """Fit a calibration; ``progress`` is called with the number of flights flown and the total number.

    Raises:
        ConfigError: too few flights reached all figures.
    """
    flown, total = count(1), DESIGNS * calibration.params.flights + 2 * FLIGHTS
    try:
        return find(calibration, lambda done, row: progress(next(flown), total) if progress else None)
    except TooFew as error:
        raise refusal(scenario, str(error)) from error


def write_findings(
    found: Findings, folder: Path, scenario: str, sets: Sequence[str], flights: int | None
) -> str:
    """Write ``summary.json`` and the scenario with the values found into a folder; return the summary."""
    summary = json_text(plain(found))
    (folder / "summary.json").write_text(summary, encoding="utf-8")
    name, sources = found.calibration.loaded.scenario.name, _sources(found, scenario, sets, flights)
    file = Path(scenario)
    extended = str(file.resolve()) if file.is_file() else scenario  # by the name of a shipped one
    text = overlay_text(f"{name}_calibrated", extended, rounded(found), sources)
    (folder / "calibrated.yaml").write_text(text, encoding="utf-8")
    return summary


def _sources(found: Findings, scenario: str, sets: Sequence[str], flights: int | None) -> dict[str, str]:
    """Return the source of each value: the command that found it, its standard deviation and its prior."""
    options = [*(f"--set {text}" for text in sets), *([] if flights is None else [f"-n {flights}"])]
    command = " ".join(["edl6dof calibrate", scenario, *options])
    return {
        path: f"{command}: +- {significant(found.sigmas[path], 2)}; prior {prior.mean:g} +- {prior.sigma:g}"
        for path, prior in found.calibration.params.parameters.items()
    }
