"""Tables in the form of the NASA NESC 6-DOF check cases: their columns, English units, one row each 0.1 s.

Source: NASA/TM-2015-218675 and the header of its simulations' files.  Everything is formed from the
telemetry; what telemetry does not hold (Euler angles, gravitation, pressure, speed of sound) is worked out
here, so that ordinary flights need not log it.
"""

from __future__ import annotations

import csv
from collections.abc import Mapping
from math import cos, radians, sin, sqrt
from typing import TextIO

import numpy as np

from edl6dof.environment.atmosphere import air
from edl6dof.environment.gravity import gravity_F
from edl6dof.spatial.frames import ned_attitude, rotate_z
from edl6dof.spatial.quaternion import conjugate, euler_321, multiply

FOOT = 0.3048  # m
POUND = 0.45359237 * 9.80665  # N
SLUG = POUND / FOOT  # kg
RANKINE = 5.0 / 9.0  # K

#: Column, telemetry channel, metric units in one English unit.
_DIRECT: tuple[tuple[str, str, float], ...] = (
    *((f"eiPosition_ft_{a.upper()}", f"truth.r_I_{a}_m", FOOT) for a in "xyz"),
    *((f"eiVelocity_ft_s_{a.upper()}", f"truth.v_I_{a}_m_s", FOOT) for a in "xyz"),
    *(
        (f"feVelocity_ft_s_{a}", f"truth.v_{way}_m_s", FOOT)
        for a, way in zip("XYZ", ("north", "east", "down"), strict=True)
    ),
    ("altitudeMsl_ft", "truth.height_above_areoid_m", FOOT),
    ("longitude_deg", "truth.longitude_deg", 1.0),
    ("latitude_deg", "truth.latitude_deg", 1.0),
    *(
        (f"bodyAngularRateWrtEi_deg_s_{a}", f"truth.rate_{c}_deg_s", 1.0)
        for a, c in zip(("Roll", "Pitch", "Yaw"), "pqr", strict=True)
    ),
    ("airDensity_slug_ft3", "truth.density_kg_m3", SLUG / FOOT**3),
    ("ambientTemperature_dgR", "truth.temperature_k", RANKINE),
    *((f"aero_bodyForce_lbf_{a.upper()}", f"truth.aero_force_{a}_n", POUND) for a in "xyz"),
    *(
        (f"aero_bodyMoment_ftlbf_{c}", f"truth.aero_moment_{a}_nm", POUND * FOOT)
        for c, a in zip("LMN", "xyz", strict=True)
    ),
    ("mach", "truth.mach", 1.0),
    ("dynamicPressure_lbf_ft2", "truth.dynamic_pressure_pa", POUND / FOOT**2),
)

#: Columns in the order of the check cases.
COLUMNS = [
    "time", "eiPosition_ft_X", "eiPosition_ft_Y", "eiPosition_ft_Z", "eiVelocity_ft_s_X", "eiVelocity_ft_s_Y",
    "eiVelocity_ft_s_Z", "feVelocity_ft_s_X", "feVelocity_ft_s_Y", "feVelocity_ft_s_Z", "altitudeMsl_ft",
    "longitude_deg",
    "latitude_deg", "localGravity_ft_s2", "eulerAngle_deg_Yaw", "eulerAngle_deg_Pitch", "eulerAngle_deg_Roll",
    "bodyAngularRateWrtEi_deg_s_Roll", "bodyAngularRateWrtEi_deg_s_Pitch", "bodyAngularRateWrtEi_deg_s_Yaw",
    "speedOfSound_ft_s", "airDensity_slug_ft3", "ambientPressure_lbf_ft2", "ambientTemperature_dgR",
    "aero_bodyForce_lbf_X",
    "aero_bodyForce_lbf_Y", "aero_bodyForce_lbf_Z", "aero_bodyMoment_ftlbf_L", "aero_bodyMoment_ftlbf_M",
    "aero_bodyMoment_ftlbf_N", "mach", "dynamicPressure_lbf_ft2",
]  # fmt: skip

INTERVAL_S = 0.1


def check_case_table(
    telemetry: Mapping[str, np.ndarray], case: np.void, atmosphere: np.void, interval_s: float = INTERVAL_S
) -> dict[str, np.ndarray]:
    """Return the columns of a check-case file.

    Args:
        telemetry: columns of a flight.
        case: its true parameters (a ``CASE`` record).
        atmosphere: the shared table of its atmosphere.
        interval_s: time between rows; rows at other times are left out.
    """
    t = np.asarray(telemetry["t_s"])
    kept = np.abs(t / interval_s - np.round(t / interval_s)) * interval_s < 1e-6
    rows = {
        name: np.asarray(values)[kept]
        for name, values in telemetry.items()
        if name == "t_s" or name.startswith("truth.")
    }
    table = {column: rows[channel] / unit for column, channel, unit in _DIRECT}
    table["time"] = np.round(rows["t_s"], 9)  # 0.1, 0.2, ... as the check cases print it
    table.update(_derived(rows, case, atmosphere))
    return {column: table[column] for column in COLUMNS}


def _derived(rows: Mapping[str, np.ndarray], case: np.void, atmosphere: np.void) -> dict[str, np.ndarray]:
    spin = float(case["planet"]["rotation_rate"])
    found = np.empty((len(rows["t_s"]), 6))
    position = np.column_stack([rows[f"truth.r_I_{a}_m"] for a in "xyz"])
    attitude = np.column_stack([rows[f"truth.q_I2B_{a}"] for a in "wxyz"])
    for i, t in enumerate(rows["t_s"]):
        c, s = cos(spin * t), sin(spin * t)
        x, y, z = rotate_z(c, s, tuple(position[i]))
        gx, gy, gz = gravity_F(case["planet"]["gravity"], (x, y, z))
        latitude, longitude = radians(rows["truth.latitude_deg"][i]), radians(rows["truth.longitude_deg"][i])
        inertial = longitude + spin * t
        q_I2N = ned_attitude(sin(latitude), cos(latitude), sin(inertial), cos(inertial))
        yaw, pitch, roll = euler_321(multiply(conjugate(q_I2N), tuple(attitude[i])))
        _, pressure, _, sound = air(
            case["atmosphere"], case["planet"]["gas"], atmosphere, rows["truth.height_above_areoid_m"][i]
        )
        found[i] = sqrt(gx * gx + gy * gy + gz * gz), yaw, pitch, roll, pressure, sound
    gravity, yaw, pitch, roll, pressure, sound = found.T
    return {
        "localGravity_ft_s2": gravity / FOOT,
        "eulerAngle_deg_Yaw": np.degrees(yaw),
        "eulerAngle_deg_Pitch": np.degrees(pitch),
        "eulerAngle_deg_Roll": np.degrees(roll),
        "ambientPressure_lbf_ft2": pressure / (POUND / FOOT**2),
        "speedOfSound_ft_s": sound / FOOT,
    }


def write_table(table: Mapping[str, np.ndarray], stream: TextIO) -> None:
    """Write columns as csv, every number with all its digits."""
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(table)
    for row in zip(*table.values(), strict=True):
        writer.writerow([repr(float(value)) for value in row])
