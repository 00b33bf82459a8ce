"""Frequency and growth of a measured oscillation."""

from __future__ import annotations

import numpy as np
from scipy.optimize import least_squares


def fit(t: np.ndarray, y: np.ndarray, guess: complex) -> tuple[complex, float]:
    """The eigenvalue sigma + i omega and the middle of a free oscillation; the guess is good to a tenth of a
    cycle over the record.
    """
    size = float(np.ptp(y))

    def amplitudes(sigma: float, omega: float) -> tuple[np.ndarray, np.ndarray]:
        grow = np.exp(sigma * t)
        columns = np.stack([grow * np.cos(omega * t), grow * np.sin(omega * t), np.ones_like(t)], axis=1)
        return columns, np.linalg.lstsq(columns, y, rcond=None)[0]

    def misfit(x: np.ndarray) -> np.ndarray:
        columns, factors = amplitudes(*x)
        return (columns @ factors - y) / size

    found = least_squares(
        misfit, [guess.real, guess.imag], x_scale=abs(guess), xtol=1e-14, ftol=1e-14, gtol=1e-14
    )
    return complex(*found.x), float(amplitudes(*found.x)[1][2])
