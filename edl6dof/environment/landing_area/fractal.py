"""Fractal relief: two periodic tiles of noise whose spectrum is a power law, repeated without end.

The fine tile has a value at every node of the lattice, the coarse one at every 16th, linear between; the two
have no wavelength in common.  Amplitudes follow the law exactly and phases are random, so that the mean
square of height differences is that of the law for every pair of tiles.
Source: spectral synthesis: Saupe, in Peitgen and Saupe, The Science of Fractal Images (1988), section 2.5;
RMS slope and Hurst exponent: Shepard et al., J. Geophys. Res. 106(E12), 32777 (2001).
Left out: wavelengths beyond the coarse tile (819 m at a lattice of 0.1 m); its pattern repeats there.
"""

from __future__ import annotations

from functools import lru_cache
from math import sqrt

import numpy as np

from edl6dof.environment.profiles import GROUND_STREAM
from edl6dof.kernels import kernel
from edl6dof.records import record
from edl6dof.spatial import arrays
from edl6dof.spatial.random_numbers import Stream

NODES = 512
#: Nodes of the lattice from one node of the coarse tile to the next.
COARSE_CELLS = 16
#: Wavelength, in cells of the lattice, that separates the two tiles.
SPLIT = 256.0
TILES = record(("coarse", "f4", (NODES, NODES)), ("fine", "f4", (NODES, NODES)))
_LAST, _INNER = NODES - 1, COARSE_CELLS - 1
_SPACINGS = {"coarse": float(COARSE_CELLS), "fine": 1.0}


@kernel
def fractal_at(area, tiles, i, j):
    """Height (m) of the fractal relief at node (``i`` north, ``j`` east) of the lattice."""
    a, b = in_tiles(area, i, j)
    fine = float(tiles.fine[(a + area.offset[0]) & _LAST, (b + area.offset[1]) & _LAST])
    a, b = a + area.offset[2], b + area.offset[3]
    corners = coarse_corners(tiles, a, b)
    return _height(area, fine, corners, float(a & _INNER) / COARSE_CELLS, float(b & _INNER) / COARSE_CELLS)


@kernel
def fractal_row(area, tiles, i, j, heights):
    """Write the heights of :func:`fractal_at` at the nodes from (``i``, ``j``) on towards the east."""
    (a, b), (a_next, b_next) = in_tiles(area, i, j), in_tiles(area, i, j + 1)
    step_a, step_b = a_next - a, b_next - b
    k, count = 0, heights.shape[0]
    while k < count:
        along = a + area.offset[2] if step_a != 0 else b + area.offset[3]
        left = COARSE_CELLS - (along & _INNER) if step_a + step_b > 0 else (along & _INNER) + 1
        run = heights[k : min(k + left, count)]
        _fractal_run(area, tiles, a, b, step_a, step_b=step_b, heights=run)
        k, a, b = k + left, a + left * step_a, b + left * step_b


@kernel
def _fractal_run(area, tiles, a, b, step_a, step_b, heights):
    """Write the heights at nodes of one cell of the coarse tile, from the place (``a``, ``b``) on."""
    fine_a, fine_b = a + area.offset[0], b + area.offset[1]
    a, b = a + area.offset[2], b + area.offset[3]
    corners = coarse_corners(tiles, a, b)
    a, b = a & _INNER, b & _INNER
    for k in range(heights.shape[0]):
        fine = float(tiles.fine[(fine_a + k * step_a) & _LAST, (fine_b + k * step_b) & _LAST])
        u, t = float(a + k * step_a) / COARSE_CELLS, float(b + k * step_b) / COARSE_CELLS
        heights[k] = _height(area, fine, corners, u, t)


@kernel
def in_tiles(area, i, j):
    """Indices of a node in the tiles of this area, turned and mirrored; without ``area.offset``."""
    a, b = (j, i) if area.turn & 1 else (i, j)
    return -a if area.turn & 2 else a, -b if area.turn & 4 else b


@kernel
def coarse_corners(tiles, a, b):
    """Values at the corners of the cell of the coarse tile that holds a place."""
    row, column = (a >> 4) & _LAST, (b >> 4) & _LAST
    below, right = (row + 1) & _LAST, (column + 1) & _LAST
    return (
        float(tiles.coarse[row, column]),
        float(tiles.coarse[row, right]),
        float(tiles.coarse[below, column]),
        float(tiles.coarse[below, right]),
    )


@kernel
def _height(area, fine, corners, u, t):
    """Height (m) where the fine tile has this value, at the shares ``u`` and ``t`` of a coarse cell."""
    first = (1.0 - t) * corners[0] + t * corners[1]
    second = (1.0 - t) * corners[2] + t * corners[3]
    return area.roughness * (fine + (1.0 - u) * first + u * second) - area.level


@lru_cache(maxsize=4)
def fractal_tiles(hurst: float) -> np.void:
    """The two tiles, ``TILES``, in a common unit of height; :func:`unit_slope` gives its size."""
    record = np.zeros(1, TILES)
    for name, spacing in _SPACINGS.items():
        turns = Stream(0, int(spacing), GROUND_STREAM).uniform((NODES, NODES))
        opposite = np.roll(turns[::-1, ::-1], 1, axis=(0, 1))
        amplitude = np.sqrt(_power(name, hurst))
        if name == "coarse":
            # what linear interpolation leaves
            between = (2.0 + arrays.cos(2.0 * np.pi * np.fft.fftfreq(NODES))) / 3.0
            amplitude /= np.sqrt(np.multiply.outer(between, between))
        # a wave and its opposite have opposite phases: together they are real, with all of their amplitude
        record[name] = arrays.real_waves(amplitude, 2.0 * np.pi * (turns - opposite))
    record.flags.writeable = False
    return record[0]


@lru_cache(maxsize=64)
def unit_slope(hurst: float, baseline: float) -> float:
    """RMS height difference of the tiles over ``baseline`` cells of the lattice, divided by ``baseline``."""
    square = 0.0
    for name, spacing in _SPACINGS.items():
        differ = 2.0 - 2.0 * arrays.cos(2.0 * np.pi * np.fft.fftfreq(NODES, spacing) * baseline)
        square += float(np.sum(_power(name, hurst) * differ[:, None]))
    return sqrt(square) / baseline


def _power(name: str, hurst: float) -> np.ndarray:
    """Mean square of height in each wave of a tile, shape (512, 512)."""
    spacing = _SPACINGS[name]
    axis = np.fft.fftfreq(NODES, spacing)
    frequency = arrays.hypot(axis[:, None], axis)
    inside = frequency * SPLIT >= 1.0 if name == "fine" else (frequency * SPLIT < 1.0) & (frequency > 0.0)
    power = np.zeros((NODES, NODES))
    power[inside] = arrays.pow(frequency[inside], -2.0 * hurst - 2.0) / np.square(NODES * spacing)
    return power
