"""Observations of a stepped flight by name, in the units of the names: the estimates of its flight computer,
and, apart from them, the true state.
"""

from __future__ import annotations

from collections.abc import Callable
from math import degrees
from typing import Any

import numpy as np

#: What navigation and mission logic know: name, field of ``NAV`` and factor.
_DEG = degrees(1.0)
_NAVIGATED: tuple[tuple[str, str, float], ...] = (
    ("altitude_m", "altitude", 1.0),
    ("height_m", "height", 1.0),
    ("latitude_deg", "latitude", _DEG),
    ("longitude_deg", "longitude", _DEG),
    ("speed_m_s", "speed", 1.0),
    ("flight_path_angle_deg", "flight_path_angle", _DEG),
    ("azimuth_deg", "azimuth", _DEG),
    ("mach", "mach", 1.0),
    ("dynamic_pressure_pa", "dynamic_pressure", 1.0),
    ("drag_m_s2", "drag", 1.0),
    ("lift_m_s2", "lift", 1.0),
    ("bank_deg", "bank", _DEG),
    ("alpha_deg", "alpha", _DEG),
    ("beta_deg", "beta", _DEG),
    ("tilt_deg", "tilt", _DEG),
    ("gravity_m_s2", "gravity", 1.0),
)
#: The same of vectors.
_VECTORS: tuple[tuple[str, str], ...] = (
    ("v_N_m_s", "v_N"),  # north, east, down
    ("site_L_m", "site_L"),  # east, north, up of the landing site
    ("q_I2B", "q_I2B"),
    ("w_B_rad_s", "w_B"),
    ("specific_force_B_m_s2", "specific_force_B"),
)
#: What guidance knows, and what it wants.
_GUIDED: tuple[tuple[str, str, float], ...] = (
    ("range_to_go_m", "range_to_go", 1.0),
    ("crossrange_m", "crossrange", 1.0),
    ("time_to_go_s", "time_to_go", 1.0),
)

Reader = Callable[[], Any]


def _number(record: np.ndarray, field: str, factor: float) -> Reader:
    values = record[field]
    return lambda: float(values[0]) * factor


def _vector(record: np.ndarray, field: str) -> Reader:
    values = record[field]
    return lambda: values[0].copy()


def navigated(fsw: np.ndarray) -> dict[str, Reader]:
    """Readers of what the flight computer knows, by name; ``fsw``: its memory, shape (1,)."""
    nav, guide, vehicle = fsw["nav"], fsw["guide"], fsw["vehicle"]
    found = {name: _number(nav, field, factor) for name, field, factor in _NAVIGATED}
    found |= {name: _vector(nav, field) for name, field in _VECTORS}
    found |= {name: _number(guide, field, factor) for name, field, factor in _GUIDED}
    found["mass_kg"] = _number(vehicle, "mass", 1.0)
    phase, engine = fsw["mission"]["phase"], vehicle["ignited"]
    found["phase"] = lambda: int(phase[0])
    found["engine_on"] = lambda: bool(engine[0])
    found["disturbance_torque_nm"] = _vector(fsw["disturbance"], "torque")
    return found


def wanted(fsw: np.ndarray, thrusters: int) -> dict[str, Reader]:
    """Readers of what the flight software itself wants, by the names of the commands that could stand in its
    place.
    """
    own = fsw["own"]
    duty = own["duty"]
    return {
        "bank_deg": _number(own, "bank", _DEG),
        "thrust_n": _vector(own, "thrust_N"),
        "torque_nm": _vector(own, "torque_B"),
        "duties": lambda: duty[0, :thrusters].copy(),
    }


def true_state(plant: np.ndarray, outputs: np.ndarray) -> dict[str, Reader]:
    """Functions that read the true state, by name; ``outputs`` belong to the last evaluated derivative."""
    found = {
        name: _number(outputs, field, 1.0)
        for name, field in (
            ("altitude_m", "altitude"),
            ("height_m", "height"),
            ("mach", "mach"),
            ("dynamic_pressure_pa", "dynamic_pressure"),
            ("mass_kg", "mass"),
        )
    }
    y = plant["y"]
    places = {"r_I_m": slice(0, 3), "v_I_m_s": slice(3, 6), "q_I2B": slice(6, 10), "w_B_rad_s": slice(10, 13)}
    found |= {name: _slice(y, place) for name, place in places.items()}
    return found


def _slice(values: np.ndarray, place: slice) -> Reader:
    return lambda: values[0, place].copy()
