"""The telemetry of a run as csv, MATLAB, netCDF, CCSDS, KML and NESC files."""

from __future__ import annotations

import re
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from edl6dof.config.errors import refusal
from edl6dof.export import ccsds
from edl6dof.export.kml import write_kml
from edl6dof.export.nesc import check_case_table, write_table
from edl6dof.runs.files import atomic_file
from edl6dof.runs.run import Run
from edl6dof.scenario.loading import viewed_scenario
from edl6dof.scenario.records import build_case, build_tables

Columns = Mapping[str, np.ndarray]

#: Printed units that UDUNITS, which netCDF readers use, would take for something else or not know.
_UDUNITS = {"": "1", "g": "9.80665 m s-2", "deg": "degree", "deg/s": "degree s-1"}
#: Forms that can be written, and the file each goes to inside the run folder.
FILES = {
    "csv": "telemetry.csv",
    "mat": "telemetry.mat",
    "nc": "telemetry.nc",
    "oem": "orbit.oem",
    "aem": "attitude.aem",
    "kml": "trajectory.kml",
    "nesc": "nesc.csv",
}


def write_export(folder: Path, form: str, target: Path, force: bool) -> int:
    """Write the telemetry of a run in a form of :data:`FILES`; returns the rows written."""
    run = Run(folder)
    with atomic_file(target, force, folder) as partial_file:
        return _write(run, form, partial_file)


def export_text(folder: Path, form: str) -> str:
    """Return the telemetry of a run in a text format.

    Raises:
        ConfigError: the form is no text format.
    """
    if form in ("mat", "nc"):
        raise refusal("-", f"the form {form} is no text; name a file")
    with tempfile.TemporaryDirectory() as place:
        _write(Run(folder), form, Path(place) / FILES[form])
        return (Path(place) / FILES[form]).read_text(encoding="utf-8")


def _write(run: Run, form: str, path: Path) -> int:
    """Write a run in one form; returns the rows written."""
    if form in ("oem", "aem"):
        return _write_message(run, form, path)
    if form == "kml":
        return write_kml(path, run)
    if form == "nesc":
        truth = viewed_scenario(run.scenario_text, str(run.folder / "scenario.yaml")).truth
        tables = build_tables(truth)
        table = check_case_table(run, build_case(truth, tables)[0], tables[0]["atmosphere"])
        with path.open("w", encoding="utf-8", newline="") as stream:
            write_table(table, stream)
        return len(table["time"])
    if form == "csv":
        write_csv(path, run)
    else:
        {"mat": write_mat, "nc": write_netcdf}[form](path, run, _about(run))
    return len(run.t)


def _write_message(run: Run, form: str, path: Path) -> int:
    """Write a CCSDS message of a run."""
    write = {"oem": ccsds.write_oem, "aem": ccsds.write_aem}[form]
    flown_by = f"edl6dof {run.summary['edl6dof_version']}, scenario {run.name}: {run.summary['outcome']}"
    try:
        epoch = ccsds.parse_epoch(str(run.scenario["initial"].get("epoch_utc") or ""))
        with path.open("w", encoding="ascii", errors="replace", newline="\n") as stream:
            comments = (flown_by, "true state of the centre of mass")
            about = ccsds.About(run.name, run.scenario["planet"], epoch, comments)
            return write(stream, about, run)
    except ValueError as error:
        raise refusal(run.folder, str(error)) from None


def _about(run: Run) -> Description:
    """Units, meanings and attributes of a run."""
    words = {
        "title": run.name,
        "source": f"edl6dof {run.summary['edl6dof_version']}",
        "outcome": str(run.summary["outcome"]),
        "epoch_utc": str(run.scenario["initial"].get("epoch_utc") or ""),
        "scenario_sha256": str(run.summary["scenario_sha256"]),
    }
    units, meanings = ({name: of(name) for name in run} for of in (run.unit, run.meaning))
    return Description(units, meanings, words)


class Description(NamedTuple):
    """Units and meanings by column, and attributes of the file by name."""

    units: Mapping[str, str]
    meanings: Mapping[str, str]
    words: Mapping[str, str]


def write_csv(path: Path, columns: Columns) -> None:
    """Write one row for each time, numbers with all their digits; column names carry the units."""
    import pyarrow as pa
    from pyarrow import csv

    csv.write_csv(pa.table(dict(columns)), path, csv.WriteOptions(quoting_style="none"))


def write_mat(path: Path, columns: Columns, about: Description) -> None:
    """Write a MATLAB 5 file: ``t_s``, one struct for each group of channels, and their units in ``units``."""
    from scipy.io import savemat

    content: dict[str, Any] = {"t_s": np.asarray(columns["t_s"]), "about": dict(about.words), "units": {}}
    for name in (name for name in columns if name != "t_s"):
        group, _, field = map(plain, name.partition("."))
        for struct, value in ((content, np.asarray(columns[name])), (content["units"], about.units[name])):
            struct.setdefault(group, {})[field] = value
    savemat(path, content, long_field_names=True, do_compression=True, oned_as="column")


def write_netcdf(path: Path, columns: Columns, about: Description) -> None:
    """Write a netCDF-3 file with 64-bit offsets and the dimension ``time``; ``truth.altitude_m`` becomes
    ``truth_altitude_m``.
    """
    from scipy.io import netcdf_file

    with netcdf_file(path, "w", version=2) as file:
        file.Conventions = "CF-1.8"
        for word, text in about.words.items():
            setattr(file, word, text)
        file.createDimension("time", len(columns["t_s"]))
        for name in columns:
            variable = file.createVariable("time" if name == "t_s" else plain(name), "f8", ("time",))
            variable[:] = columns[name]
            variable.units = _UDUNITS.get(about.units[name], about.units[name])
            variable.long_name = about.meanings[name]


def plain(name: str) -> str:
    """Return a valid MATLAB and netCDF name: at most 63 letters, digits and ``_``, a letter first."""
    return re.sub(r"^(?=[^a-zA-Z])", "n", re.sub(r"\W", "_", name, flags=re.ASCII))[:63]
