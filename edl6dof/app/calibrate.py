"""``edl6dof calibrate``."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table

from edl6dof.app.counting import count_runs
from edl6dof.app.exit_status import refuse
from edl6dof.calibration.findings import plain, remarks, rounded, unexplained
from edl6dof.calibration.fit import Fit, fit
from edl6dof.calibration.overlay import overlay_text
from edl6dof.calibration.problem import Calibration, load_calibration
from edl6dof.config.document.jsontext import json_text
from edl6dof.manifest import listed
from edl6dof.report.numbers import significant
from edl6dof.report.terminal import open_table
from edl6dof.runs.folder import atomic_folder


@dataclass(frozen=True)
class CalibrateOptions:
    """Options of ``edl6dof calibrate``."""

    scenario: str
    sets: tuple[str, ...]
    flights: int | None
    out: Path | None
    force: bool
    as_json: bool


def run_calibrate(options: CalibrateOptions) -> int:
    """Fit the uncertain parameters of a scenario; show and write what was found; returns the exit status."""
    if options.flights is not None and not 2 <= options.flights <= 1000:
        return refuse(f"-n {options.flights}: must be 2 to 1000")
    calibration = load_calibration(options.scenario, options.sets, options.flights)
    name = calibration.loaded.scenario.name
    target = options.out or Path("runs") / f"calibration-{name}"
    with atomic_folder(target, "calibration", options.force) as folder:
        with count_runs(name, quiet=options.as_json) as progress:
            calibration.progress = lambda done: progress(done, _evaluations(calibration))
            found = fit(calibration.misfit, *calibration.bounds)
        summary = json_text(plain(calibration, found))
        (folder / "summary.json").write_text(summary, encoding="utf-8")
        text = overlay_text(
            f"{name}_calibrated",
            _extended(options.scenario),
            rounded(calibration, found),
            claims(options, calibration, found),
        )
        (folder / "calibrated.yaml").write_text(text, encoding="utf-8")
    if options.as_json:
        print(summary, end="")
    else:
        _show(calibration, found, target)
    return 0 if not unexplained(calibration, found) else 1


def _extended(scenario: str) -> str:
    """How the overlay names the scenario it extends: by the name of a shipped one, or by its full path."""
    file = Path(scenario)
    return str(file.resolve()) if file.is_file() else scenario


def _evaluations(calibration: Calibration) -> int:
    """About how many means have to be flown: five steps, each with its slopes."""
    return 5 * (2 * len(calibration.paths) + 1)


def claims(options: CalibrateOptions, calibration: Calibration, found: Fit) -> dict[str, str]:
    """Mark of each value: the command that made it, its standard deviation and its prior."""
    sets = (f"--set {text}" for text in options.sets)
    command = " ".join(["edl6dof calibrate", options.scenario, *sets, f"-n {calibration.params.flights}"])
    return {
        path: f"[C] {command}: +- {significant(prior.sigma * float(share), 2)}; "
        f"prior {prior.mean:g} +- {prior.sigma:g}"
        for (path, prior), share in zip(calibration.params.parameters.items(), found.deviation, strict=True)
    }


def _show(calibration: Calibration, found: Fit, target: Path) -> None:
    console = Console(highlight=False, soft_wrap=True)
    letters = [chr(ord("a") + k) for k in range(len(calibration.paths))]
    console.print(_parameters(calibration, found, letters))
    console.print(_figures(calibration, found))
    console.print(_slopes(calibration, found, letters))
    console.print(_correlations(found, letters))
    for remark in remarks(calibration, found):
        console.print(remark, markup=False)
    console.print(f"{target}: {listed(target)}", markup=False)


def _parameters(calibration: Calibration, found: Fit, letters: Sequence[str]) -> Table:
    table = open_table(
        "Parameters", "", "parameter", "prior>", "posterior>", "shift (sigma)>", "told by figures>"
    )
    values = calibration.values(found.x)
    for k, (path, prior) in enumerate(calibration.params.parameters.items()):
        posterior = (
            f"{significant(values[path])} +- {significant(prior.sigma * float(found.deviation[k]), 2)}"
        )
        cells = (
            f"{prior.mean:g} +- {prior.sigma:g}",
            posterior,
            f"{found.x[k]:+.2f}",
            f"{100 * found.resolution[k]:.0f} %",
        )
        table.add_row(letters[k], path, *cells)
    return table


def _figures(calibration: Calibration, found: Fit) -> Table:
    table = open_table("Figures", "figure", "unit", "published>", "before>", "after>", "sigma>", "in sigma>")
    first, last = calibration.figures(np.zeros(len(found.x))), calibration.figures(found.x)
    for k, (figure, published) in enumerate(calibration.beside):
        before, after = (
            published.of(spread[figure.name].mean) if figure.name in spread else np.nan
            for spread in (first, last)
        )
        cells = (significant(value, 5) for value in (published.number, before, after))
        table.add_row(
            figure.meaning,
            figure.unit.label,
            *cells,
            significant(calibration.weights[k], 2),
            f"{found.after[k]:+.1f}",
        )
    return table


def _slopes(calibration: Calibration, found: Fit, letters: Sequence[str]) -> Table:
    """What each figure says about each parameter."""
    table = open_table(
        "Change of each figure, in its sigma, with one prior sigma of", "figure", *(f"{x}>" for x in letters)
    )
    for b, row in zip(calibration.beside, found.slopes, strict=True):
        table.add_row(b.figure.meaning, *(f"{value:+.1f}" for value in row))
    return table


def _correlations(found: Fit, letters: Sequence[str]) -> Table:
    table = open_table("Correlations of the posterior", "", *(f"{letter}>" for letter in letters))
    for letter, row in zip(letters, found.correlation, strict=True):
        table.add_row(letter, *(f"{value:+.2f}" for value in row))
    return table
