"""``edl6dof export``."""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from edl6dof.config.errors import refusal
from edl6dof.config.wording import counted
from edl6dof.runs.files import atomic_file
from edl6dof.runs.run import Run

if TYPE_CHECKING:
    from edl6dof.export.tables import Description

#: Forms that can be written, and the file each goes to inside the run folder.
FILES = {
    "csv": "telemetry.csv",
    "mat": "telemetry.mat",
    "nc": "telemetry.nc",
    "oem": "orbit.oem",
    "aem": "attitude.aem",
    "nesc": "nesc.csv",
}


def run_export(folder: Path, form: str, target: Path | None, force: bool) -> int:
    """Write the telemetry of a run in a form of :data:`FILES`; ``-`` as target is standard output, for the
    forms that are text.
    """
    run = Run(folder)
    writer = WRITERS[form]
    if target == Path("-"):
        if form in ("mat", "nc"):
            raise refusal("-", f"the form {form} is no text; name a file")
        with tempfile.TemporaryDirectory() as place:
            writer(run, Path(place) / FILES[form])
            sys.stdout.write((Path(place) / FILES[form]).read_text(encoding="utf-8"))
        return 0
    target = target or folder / FILES[form]
    with atomic_file(target, force, folder) as partial_file:
        rows = writer(run, partial_file)
    print(f"{target}: {counted(rows, 'row')}")
    return 0


def _csv(run: Run, path: Path) -> int:
    from edl6dof.export.tables import write_csv

    write_csv(path, run)
    return len(run.t)


def _mat(run: Run, path: Path) -> int:
    from edl6dof.export.tables import write_mat

    write_mat(path, run, _about(run))
    return len(run.t)


def _netcdf(run: Run, path: Path) -> int:
    from edl6dof.export.tables import write_netcdf

    write_netcdf(path, run, _about(run))
    return len(run.t)


def _about(run: Run) -> Description:
    from edl6dof.export.tables import Description

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
    from edl6dof.export import ccsds

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
    from edl6dof.export.nesc import write_table

    table = nesc_table(run)
    with path.open("w", encoding="utf-8", newline="") as stream:
        write_table(table, stream)
    return len(table["time"])


def nesc_table(run: Run) -> dict[str, np.ndarray]:
    """The check-case columns of a run."""
    from edl6dof.export.nesc import check_case_table
    from edl6dof.scenario.records import build_case, build_tables
    from edl6dof.scenario.viewed import viewed_scenario

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
