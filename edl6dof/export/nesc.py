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

#: Columns in the order of the check cases: name, source (a telemetry channel, or a name of :func:`_derived`),
#: and metric units in one English unit.
_COLUMNS: tuple[tuple[str, str, float], ...] = (
    ("time", "time", 1.0),
    *((f"eiPosition_ft_{a.upper()}", f"truth.r_I_{a}_m", FOOT) for a in "xyz"),
    *((f"eiVelocity_ft_s_{a.upper()}", f"truth.v_I_{a}_m_s", FOOT) for a in "xyz"),
    ("feVelocity_ft_s_X", "truth.v_north_m_s", FOOT),
    ("feVelocity_ft_s_Y", "truth.v_east_m_s", FOOT),
    ("feVelocity_ft_s_Z", "truth.v_down_m_s", FOOT),
    ("altitudeMsl_ft", "truth.height_above_areoid_m", FOOT),
    ("longitude_deg", "truth.longitude_deg", 1.0),
    ("latitude_deg", "truth.latitude_deg", 1.0),
    ("localGravity_ft_s2", "gravity", FOOT),
    *((f"eulerAngle_deg_{angle}", angle, 1.0) for angle in ("Yaw", "Pitch", "Roll")),
    ("bodyAngularRateWrtEi_deg_s_Roll", "truth.rate_p_deg_s", 1.0),
    ("bodyAngularRateWrtEi_deg_s_Pitch", "truth.rate_q_deg_s", 1.0),
    ("bodyAngularRateWrtEi_deg_s_Yaw", "truth.rate_r_deg_s", 1.0),
    ("speedOfSound_ft_s", "speed of sound", FOOT),
    ("airDensity_slug_ft3", "truth.density_kg_m3", SLUG / FOOT**3),
    ("ambientPressure_lbf_ft2", "pressure", POUND / FOOT**2),
    ("ambientTemperature_dgR", "truth.temperature_k", RANKINE),
    *((f"aero_bodyForce_lbf_{a.upper()}", f"truth.aero_force_{a}_n", POUND) for a in "xyz"),
    *(
        (f"aero_bodyMoment_ftlbf_{c}", f"truth.aero_moment_{a}_nm", POUND * FOOT)
        for c, a in zip("LMN", "xyz", strict=True)
    ),
    ("mach", "truth.mach", 1.0),
    ("dynamicPressure_lbf_ft2", "truth.dynamic_pressure_pa", POUND / FOOT**2),
)
COLUMNS = [column for column, _, _ in _COLUMNS]
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
    rows["time"] = np.round(rows["t_s"], 9)  # 0.1, 0.2, ... as the check cases print it
    rows |= _derived(rows, case, atmosphere)
    return {column: rows[source] / unit for column, source, unit in _COLUMNS}


def _derived(rows: Mapping[str, np.ndarray], case: np.void, atmosphere: np.void) -> dict[str, np.ndarray]:
    """Quantities that telemetry lacks, in SI units and degrees."""
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
    angles = {"Yaw": np.degrees(yaw), "Pitch": np.degrees(pitch), "Roll": np.degrees(roll)}
    return {"gravity": gravity, "pressure": pressure, "speed of sound": sound, **angles}


def write_table(table: Mapping[str, np.ndarray], stream: TextIO) -> None:
    """Write columns as csv, every number with all its digits."""
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(table)
    for row in zip(*table.values(), strict=True):
        writer.writerow([repr(float(value)) for value in row])
