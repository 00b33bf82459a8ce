"""Telemetry as csv, MATLAB file and netCDF."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

Columns = Mapping[str, np.ndarray]

#: Printed units that UDUNITS, which netCDF readers use, would take for something else or not know.
_UDUNITS = {"": "1", "g": "9.80665 m s-2", "deg": "degree", "deg/s": "degree s-1"}


class Description(NamedTuple):
    """What a file says about its columns and itself: unit and meaning by column, and words by name."""

    units: Mapping[str, str]
    meanings: Mapping[str, str]
    words: Mapping[str, str]


def write_csv(path: Path, columns: Columns) -> None:
    """One row for each time, every number with all its digits; the names of the columns carry the units."""
    import pyarrow as pa
    from pyarrow import csv

    csv.write_csv(pa.table(dict(columns)), path, csv.WriteOptions(quoting_style="none"))


def write_mat(path: Path, columns: Columns, about: Description) -> None:
    """A MATLAB 5 file: ``t_s``, and one struct for each group of channels, ``truth.altitude_m`` as in Python;
    units in ``units``.
    """
    from scipy.io import savemat

    content: dict[str, Any] = {"t_s": np.asarray(columns["t_s"]), "about": dict(about.words), "units": {}}
    for name in (name for name in columns if name != "t_s"):
        group, _, field = map(plain, name.partition("."))
        for struct, value in ((content, np.asarray(columns[name])), (content["units"], about.units[name])):
            struct.setdefault(group, {})[field] = value
    savemat(path, content, long_field_names=True, do_compression=True, oned_as="column")


def write_netcdf(path: Path, columns: Columns, about: Description) -> None:
    """A netCDF-3 file with 64-bit offsets and the dimension ``time``; ``truth.altitude_m`` becomes
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
    """A name of at most 63 letters, digits and underscores that begins with a letter, as MATLAB and netCDF
    want it.
    """
    return re.sub(r"^(?=[^a-zA-Z])", "n", re.sub(r"\W", "_", name, flags=re.ASCII))[:63]
