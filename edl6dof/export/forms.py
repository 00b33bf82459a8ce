"""The telemetry of a run in the forms of other programs."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np

from edl6dof.config.errors import refusal
from edl6dof.export import ccsds
from edl6dof.export.nesc import check_case_table, write_table
from edl6dof.export.tables import Description, write_csv, write_mat, write_netcdf
from edl6dof.runs.files import atomic_file
from edl6dof.runs.run import Run
from edl6dof.scenario.loading import viewed_scenario
from edl6dof.scenario.records import build_case, build_tables

#: Forms that can be written, and the file each goes to inside the run folder.
FILES = {
    "csv": "telemetry.csv",
    "mat": "telemetry.mat",
    "nc": "telemetry.nc",
    "oem": "orbit.oem",
    "aem": "attitude.aem",
    "nesc": "nesc.csv",
}


def write_export(folder: Path, form: str, target: Path, force: bool) -> int:
    """Write the telemetry of a run in a form of :data:`FILES`; returns the rows written."""
    run = Run(folder)
    with atomic_file(target, force, folder) as partial_file:
        return WRITERS[form](run, partial_file)


def export_text(folder: Path, form: str) -> str:
    """Return the telemetry of a run in a form that is text.

    Raises:
        ConfigError: the form is none.
    """
    if form in ("mat", "nc"):
        raise refusal("-", f"the form {form} is no text; name a file")
    with tempfile.TemporaryDirectory() as place:
        WRITERS[form](Run(folder), Path(place) / FILES[form])
        return (Path(place) / FILES[form]).read_text(encoding="utf-8")


def _csv(run: Run, path: Path) -> int:
    write_csv(path, run)
    return len(run.t)


def _mat(run: Run, path: Path) -> int:
    write_mat(path, run, _about(run))
    return len(run.t)


def _netcdf(run: Run, path: Path) -> int:
    write_netcdf(path, run, _about(run))
    return len(run.t)


def _about(run: Run) -> Description:
    summary = run.summary
    words = {
        "title": run.name,
        "source": f"edl6dof {summary['edl6dof_version']}",
        "outcome": str(summary["outcome"]),
        "epoch_utc": str(run.scenario["initial"].get("epoch_utc") or ""),
        "scenario_sha256": str(summary["scenario_sha256"]),
    }
    return Description(
        {name: run.unit(name) for name in run}, {name: run.meaning(name) for name in run}, words
    )


def _ccsds(kind: str, run: Run, path: Path) -> int:
    write = {"oem": ccsds.write_oem, "aem": ccsds.write_aem}[kind]
    summary = run.summary
    comments = [
        f"edl6dof {summary['edl6dof_version']}, scenario {run.name}: {summary['outcome']}",
        "true state of the centre of mass",
    ]
    try:
        epoch = ccsds.parse_epoch(str(run.scenario["initial"].get("epoch_utc") or ""))
        with path.open("w", encoding="ascii", errors="replace", newline="\n") as stream:
            return write(stream, run.name, run.scenario["planet"], epoch, run, comments)
    except ValueError as error:
        raise refusal(run.folder, str(error)) from None


def _nesc(run: Run, path: Path) -> int:
    table = nesc_table(run)
    with path.open("w", encoding="utf-8", newline="") as stream:
        write_table(table, stream)
    return len(table["time"])


def nesc_table(run: Run) -> dict[str, np.ndarray]:
    """The check-case columns of a run."""
    truth = viewed_scenario(run.scenario_text, str(run.folder / "scenario.yaml")).truth
    tables = build_tables(truth)
    return check_case_table(run, build_case(truth, tables)[0], tables[0]["atmosphere"])


#: Writes a form to a path and returns the rows written.
WRITERS: dict[str, Callable[[Run, Path], int]] = {
    "csv": _csv,
    "mat": _mat,
    "nc": _netcdf,
    "oem": partial(_ccsds, "oem"),
    "aem": partial(_ccsds, "aem"),
    "nesc": _nesc,
}
