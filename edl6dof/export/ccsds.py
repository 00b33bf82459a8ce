"""CCSDS ephemeris messages in keyword = value notation: orbit (OEM, CCSDS 502.0-B-2) and attitude (AEM, CCSDS
504.0-B-1).

The inertial frame of a flight is the planet-fixed frame stopped at the start; messages are written in ICRF,
by the planet's published orientation at the epoch of the scenario (Archinal et al. 2011, Report of the IAU
Working Group on Cartographic Coordinates and Rotational Elements: 2009).
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime, timedelta
from typing import Any, NamedTuple, TextIO

import numpy as np

from edl6dof.environment.climate import utc
from edl6dof.environment.planet import OrientationParams

Columns = Mapping[str, np.ndarray]
ORIGINATOR = "EDL6DOF"
CENTURY_D = 36525.0
J2000 = datetime(2000, 1, 1, 12, tzinfo=UTC)
TT_MINUS_TAI_S = 32.184
#: Months in which TAI - UTC grew by 1 s (IERS Bulletin C): to 10 s in the first.
_STEPS = (
    "1972-01 1972-07 1973-01 1974-01 1975-01 1976-01 1977-01 1978-01 1979-01 1980-01 1981-07 1982-07 1983-07 "
    "1985-07 1988-01 1990-01 1991-01 1992-07 1993-07 1994-07 1996-01 1997-07 1999-01 2006-01 2009-01 2012-07 "
    "2015-07 2017-01"
)
LEAP_SECONDS = [datetime.fromisoformat(f"{month}-01T00:00:00+00:00") for month in _STEPS.split()]

#: Version of each kind of message, and its frames and forms.
_KINDS: dict[str, tuple[str, dict[str, str], dict[str, str]]] = {
    "OEM": ("2.0", {"REF_FRAME": "ICRF"}, {}),
    "AEM": (
        "1.0",
        {"REF_FRAME_A": "ICRF", "REF_FRAME_B": "SC_BODY_1", "ATTITUDE_DIR": "A2B"},
        {"ATTITUDE_TYPE": "QUATERNION", "QUATERNION_TYPE": "LAST"},
    ),
}
#: Characters that fit behind the longest keyword: a line of a message has at most 254.
LONGEST_VALUE = 220


def parse_epoch(text: str) -> datetime:
    """Return the date and time of t = 0.

    Raises:
        ValueError: the text is empty, or is no date.
    """
    if not text:
        raise ValueError("the scenario has no initial.epoch_utc, which a CCSDS message needs")
    return utc(text)


def days_since_j2000(utc: datetime) -> float:
    """Return days of dynamical time since 2000-01-01 12:00 TDB; TDB is taken as TT, 2 ms off at most.

    Raises:
        ValueError: the date lies before leap seconds were introduced (1972).
    """
    steps = sum(first <= utc for first in LEAP_SECONDS)
    if not steps:
        raise ValueError(f"{utc.isoformat()} lies before 1972, when leap seconds begin")
    return ((utc - J2000).total_seconds() + 9 + steps + TT_MINUS_TAI_S) / 86400.0


def icrf_to_fixed(orientation: OrientationParams, utc: datetime) -> np.ndarray:
    """Return the matrix, shape (3, 3), that turns ICRF components into planet-fixed ones at a date.

    Raises:
        ValueError: the date lies before leap seconds were introduced (1972).
    """
    from scipy.spatial.transform import Rotation

    o, days = orientation, days_since_j2000(utc)
    centuries = days / CENTURY_D
    ascension = o.pole_ra_deg + o.pole_ra_rate_deg_century * centuries
    declination = o.pole_dec_deg + o.pole_dec_rate_deg_century * centuries
    spin = o.prime_meridian_deg + o.prime_meridian_rate_deg_day * days
    axes = Rotation.from_euler("ZXZ", [90.0 + ascension, 90.0 - declination, spin], degrees=True)
    return np.asarray(axes.as_matrix().T)


def _orientation(planet: Mapping[str, Any]) -> OrientationParams:
    """Orientation of the planet of a run.

    Raises:
        ValueError: the run's planet states none.
    """
    stated = planet.get("orientation")
    if stated is None:
        raise ValueError(f"the planet {planet['name']} states no orientation in the celestial frame")
    return OrientationParams.model_validate(stated)


class About(NamedTuple):
    """Header of a message: object, planet of the scenario, date of t = 0, and comments."""

    name: str
    planet: Mapping[str, Any]
    epoch: datetime
    comments: Sequence[str] = ()


def write_oem(stream: TextIO, about: About, columns: Columns) -> int:
    """Write position (km) and velocity (km/s) of each row; returns the rows written."""
    turn = icrf_to_fixed(_orientation(about.planet), about.epoch)
    position, velocity = (
        np.stack([columns[f"truth.{s}_I_{a}_{u}"] for a in "xyz"], 1) @ turn / 1e3
        for s, u in (("r", "m"), ("v", "m_s"))
    )
    numbers = [
        " ".join([*(f"{value:.9f}" for value in place), *(f"{value:.12f}" for value in speed)])
        for place, speed in zip(position, velocity, strict=True)
    ]
    return _write(stream, "OEM", about, columns["t_s"], numbers)


def write_aem(stream: TextIO, about: About, columns: Columns) -> int:
    """Write the quaternion from ICRF to body axes of each row, scalar last; returns the rows written."""
    from scipy.spatial.transform import Rotation

    to_inertial = Rotation.from_matrix(icrf_to_fixed(_orientation(about.planet), about.epoch).T)
    body = Rotation.from_quat(np.stack([columns[f"truth.q_I2B_{c}"] for c in "xyzw"], 1))
    quaternion = (to_inertial * body).as_quat()
    turned = np.sum(quaternion[1:] * quaternion[:-1], axis=1) < 0.0
    # keep the sign continuous, so that a reader can interpolate
    quaternion[1:] *= np.where(np.cumsum(turned) % 2, -1.0, 1.0)[:, None]
    numbers = [" ".join(f"{value:.12f}" for value in row) for row in quaternion]
    return _write(stream, "AEM", about, columns["t_s"], numbers)


def _write(stream: TextIO, kind: str, about: About, t: np.ndarray, numbers: Sequence[str]) -> int:
    """Write header, metadata and a line for each row."""
    version, frames, forms = _KINDS[kind]
    stamps, rows = _stamps(about.epoch, t)
    name = _value(about.name).upper()
    pairs = {
        "OBJECT_NAME": name,
        "OBJECT_ID": name,
        "CENTER_NAME": _value(about.planet["name"]).upper(),
        **frames,
        "TIME_SYSTEM": "UTC",
        "START_TIME": stamps[0],
        "STOP_TIME": stamps[-1],
        **forms,
    }
    stream.write(f"CCSDS_{kind}_VERS = {version}\n")
    stream.writelines(f"COMMENT {_value(line)}\n" for line in about.comments)
    stream.write(f"CREATION_DATE = {datetime.now(UTC).strftime('%Y-%m-%dT%H:%M:%S')}\n")
    stream.write(f"ORIGINATOR = {ORIGINATOR}\n\nMETA_START\n")
    stream.writelines(f"{key} = {value}\n" for key, value in pairs.items())
    stream.write("META_STOP\n\n" + "DATA_START\n" * (kind == "AEM"))
    stream.writelines(f"{stamp} {numbers[row]}\n" for stamp, row in zip(stamps, rows, strict=True))
    stream.write("DATA_STOP\n" * (kind == "AEM"))
    return len(stamps)


def _stamps(epoch: datetime, t: np.ndarray) -> tuple[list[str], list[int]]:
    """Times as UTC to the microsecond, and their rows, without times that do not rise."""
    stamps: list[str] = []
    rows: list[int] = []
    for row, seconds in enumerate(t):
        stamp = (epoch + timedelta(seconds=float(seconds))).strftime("%Y-%m-%dT%H:%M:%S.%f")
        if not stamps or stamp > stamps[-1]:
            stamps.append(stamp)
            rows.append(row)
    return stamps, rows


def _value(text: str) -> str:
    """Text as the value of a keyword: one line of printable ASCII without another keyword."""
    return " ".join(re.sub(r"[^ -~]|=", " ", text).split())[:LONGEST_VALUE] or "UNKNOWN"
