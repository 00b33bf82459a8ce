"""Inertial units made up for tests: six axes on a cone, and their believed errors."""

from math import pi, radians

import numpy as np
from as_flown import as_flown

from edl6dof.fsw.navigation.instruments import INSTRUMENTS
from edl6dof.fsw.navigation.redundancy import REDUNDANT, prepare

G0 = 9.80665
_prepare = as_flown(prepare, "unit, number, in_use, memory", "unit.gyro_axis, number, in_use, memory")
DT = 0.02


def cone(number: int = 6, half_angle: float = radians(54.7356103172)) -> np.ndarray:
    """Unit axes spread evenly on a cone about x; H'H = number / 3 for this half angle."""
    around = 2.0 * pi * np.arange(number) / number
    return np.column_stack(
        [
            np.full(number, np.cos(half_angle)),
            np.sin(half_angle) * np.cos(around),
            np.sin(half_angle) * np.sin(around),
        ]
    )


def believed_unit(number: int = 6) -> np.ndarray:
    """``INSTRUMENTS`` record, shape (1,), of a navigation-grade unit."""
    known = np.zeros(1, INSTRUMENTS)
    unit = known[0]
    unit["n_gyros"] = unit["n_accelerometers"] = number
    unit["gyro_axis"][:number] = unit["accelerometer_axis"][:number] = cone(number)
    unit["gyro_noise"] = radians(0.01) / 60.0
    unit["gyro_bias"] = radians(0.03) / 3600.0
    unit["gyro_scale"] = 5e-5
    unit["gyro_range"] = radians(300.0)
    unit["accelerometer_noise"] = 20e-6 * G0
    unit["accelerometer_bias"] = 30e-6 * G0
    unit["accelerometer_scale"] = 7e-5
    unit["n_trackers"] = 1
    unit["star_sigma"] = radians(0.02) / 3.0
    unit["tracking_position"], unit["tracking_velocity"] = 500.0**2 * np.eye(3), 0.5**2 * np.eye(3)
    return known


def redundant(axes: np.ndarray, in_use: int) -> np.ndarray:
    """``REDUNDANT`` record, shape (1,), with the matrices of a set."""
    memory, unit = np.zeros(1, REDUNDANT), np.zeros(1, INSTRUMENTS)[0]
    unit["gyro_axis"][: len(axes)] = axes
    _prepare(unit, len(axes), in_use, memory[0])
    return memory
