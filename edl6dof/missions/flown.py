"""The trajectory of a real flight, read from a csv, and the same channels of simulated flights.

The csv has a column ``t_s``, seconds since the start of the simulation, and any of :data:`COLUMNS`, in the
units of their names.  A remark names origin and source: ``# [P] Spencer et al. 1998``.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from os.path import isfile
from pathlib import Path
from typing import NamedTuple

import numpy as np

from edl6dof.config.base import REQUIRED, STATUS_MARKS, Params, param
from edl6dof.config.document.document import Document
from edl6dof.config.document.locate import shipped_folders, shown
from edl6dof.config.document.regular import read_regular
from edl6dof.config.errors import ConfigError, Problem, did_you_mean
from edl6dof.config.validate import validate
from edl6dof.interchange.number_csv import BadTable, read_number_csv
from edl6dof.scenario.loading import FLOWN
from edl6dof.sim.flight import Flight

TIME = "t_s"
#: Channels of the telemetry by their columns in a csv.
COLUMNS = {
    name: f"truth.{name}"
    for name in (
        *("altitude_m", "height_above_areoid_m", "height_m", "speed_m_s", "flight_path_angle_deg"),
        *("mach", "dynamic_pressure_pa", "load_g0", "alpha_deg", "beta_deg", "total_alpha_deg", "bank_deg"),
        *("rate_p_deg_s", "rate_q_deg_s", "rate_r_deg_s", "tilt_deg"),
    )
}
#: Beginning of the names of channels at the flown times in the table of the flights.
SERIES = "series."
#: Largest number of samples that are compared; of a longer csv, every second, every third, ...
MOST = 500
_SOURCE = re.compile(r"^\s*#\s*\[([PDR])\]\s+\S", re.MULTILINE)


class FlownFile(Params):
    """The ``flown:`` entry of a scenario file."""

    flown: str = param(
        REQUIRED,
        "csv of the trajectory of the real flight, relative to the folder of the scenario; edl6dof validate "
        "draws it over the dispersed flights",
        record=False,
        min_length=1,
    )


class Trajectory(NamedTuple):
    """Channels of a real flight.

    Attributes:
        status: origin, such as ``published``.
        t: times since the start of the simulation, s, shape (samples,), rising.
        channels: values by channel of the telemetry, each shape (samples,), in the unit of its name.
    """

    status: str
    t: np.ndarray
    channels: dict[str, np.ndarray]

    def of(self, flight: Flight) -> dict[str, list[float]]:
        """Columns of a row: the channels of a simulated flight at these times, NaN before and after it."""
        own = flight.telemetry
        t = own["t_s"]
        found = {name: np.interp(self.t, t, own[name], np.nan, np.nan) for name in self.channels}
        return {SERIES + name: values.tolist() for name, values in found.items()}


def trajectory_of(document: Document) -> Trajectory | None:
    """Read the trajectory that a scenario file names, in its folder or in that of the shipped scenarios;
    ``None`` if it names none.

    Raises:
        ConfigError: the entry is no text, or what :func:`read_trajectory` refuses.
    """
    if document.data.get(FLOWN) is None:
        return None
    own = Document({FLOWN: document.data[FLOWN]}, dict(document.marks), files=document.files)
    name, own_folder = validate(FlownFile, own).flown, Path(own.mark((FLOWN,)).file).parent
    places = [folder / name for folder in (own_folder, *shipped_folders("scenarios"))]
    return read_trajectory(next((path for path in places if isfile(path)), places[0]))


def read_trajectory(path: Path) -> Trajectory:
    """Read the trajectory of a real flight.

    Raises:
        ConfigError: every mistake with file, line and column.
    """
    file = shown(path)
    try:
        content = read_regular(path)
    except (OSError, ValueError) as error:  # ValueError: a name that the system cannot look up
        words = f"cannot be read: {getattr(error, 'strerror', None) or error}"
        raise ConfigError([Problem(file, 0, 0, "", words)]) from None
    origin = _SOURCE.search(content.decode("utf-8", "replace"))
    words = "needs a remark with origin and source, such as '# [P] paper' ([P], [D] or [R])"
    problems = [] if origin else [Problem(file, 1, 1, "", words)]
    try:
        table = read_number_csv(file, content, _named, rising=TIME)
    except BadTable as error:
        raise ConfigError([*problems, *error.problems]) from None
    if problems or origin is None:
        raise ConfigError(problems)
    thin = slice(None, None, -(-len(table.lines) // MOST))
    channels = {COLUMNS[name]: x[thin] for name, x in table.columns.items() if name != TIME}
    return Trajectory(STATUS_MARKS[origin.group(1)], table.columns[TIME][thin], channels)


def _named(heading: Sequence[str]) -> tuple[Sequence[str], list[str]]:
    known = (TIME, *COLUMNS)
    wrong = [
        f"no column {name!r}{did_you_mean(name, known)} (allowed: {', '.join(known)})"
        for name in heading
        if name not in known
    ]
    if TIME not in heading:
        wrong.append(f"lacks the column {TIME}, seconds since the start of the simulation")
    if not set(heading) & set(COLUMNS):
        wrong.append(f"has no column but {TIME}: add one such as speed_m_s")
    wrong += [f"the column {name} stands twice" for name in sorted(set(heading)) if heading.count(name) > 1]
    return [name if name in known else "" for name in heading], wrong
