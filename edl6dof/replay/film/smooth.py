"""Smooth edges of a picture: FXAA (T. Lottes, NVIDIA 2009), at the pixels of edges only.

A processor that draws without a GPU would compute the filter at every pixel, which takes longer than the
whole scene.
"""

from __future__ import annotations

import numpy as np

#: Least contrast of an edge, in steps of brightness, and as a divisor of the greatest brightness around it.
_CONTRAST, _RELATIVE = 16, 8
#: Pixels that are searched for the ends of an edge, to each side.
_REACH = 12
#: Largest blend of a detail of one pixel, and the least share of the contrast around it that makes it one.
_BLEND, _DETAIL = 0.75, 0.25


def smooth(picture: np.ndarray) -> None:
    """Blend the pixels of edges with their neighbours, in place; shape (height, width, 3), uint8."""
    height, width, _ = picture.shape
    brightness = (picture[..., 0] >> 1) + (picture[..., 1] >> 1)  # of red and green: blue adds little
    at = _edges(brightness)
    bright, colours = brightness.ravel(), picture.reshape(-1, 3)

    def light(place: np.ndarray) -> np.ndarray:
        return bright[np.clip(place, 0, bright.size - 1)].astype(np.float32)

    middle = light(at)
    (nw, n, ne), (w, _, e), (sw, s, se) = (
        [light(at + row * width + column) for column in (-1, 0, 1)] for row in (-1, 0, 1)
    )
    level = np.abs(nw + sw - 2.0 * w) + 2.0 * np.abs(n + s - 2.0 * middle) + np.abs(ne + se - 2.0 * e)
    upright = np.abs(nw + ne - 2.0 * n) + 2.0 * np.abs(w + e - 2.0 * middle) + np.abs(sw + se - 2.0 * s)
    flat = level >= upright
    before, after = np.where(flat, n, w), np.where(flat, s, e)
    across = np.where(np.abs(before - middle) >= np.abs(after - middle), -1, 1) * np.where(flat, width, 1)
    steep = 0.25 * np.maximum(np.abs(before - middle), np.abs(after - middle))
    mean = 0.5 * (middle + np.where(across < 0, before, after))

    def end(step: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Distance to the end of each edge, pixels, and the brightness there relative to the edge."""
        far, there, going = np.full(len(at), _REACH), np.zeros(len(at), np.float32), np.arange(len(at))
        for k in range(1, _REACH + 1):
            place = at[going] + k * step[going]
            there[going] = 0.5 * (light(place) + light(place + across[going])) - mean[going]
            ended = np.abs(there[going]) >= steep[going]
            far[going[ended]] = k
            going = going[~ended]
        return far, there

    along = np.where(flat, 1, width)
    (back, low), (ahead, high) = end(-along), end(along)
    leaves = (np.where(back < ahead, low, high) < 0.0) != (middle < mean)
    shift = np.where(leaves, 0.5 - np.minimum(back, ahead) / (back + ahead), 0.0)
    around = np.abs((2.0 * (n + s + w + e) + nw + ne + sw + se) / 12.0 - middle)
    ring = np.stack([n, s, w, e, middle])
    detail = np.clip((around / np.ptp(ring, axis=0) - _DETAIL) / (1.0 - _DETAIL), 0.0, 1.0)
    shift = np.maximum(shift, _BLEND * (detail**2 * (3.0 - 2.0 * detail)) ** 2)[:, None]
    own, other = colours[at].astype(np.float32), colours[at + across]
    colours[at] = own + shift * (other - own)


def _edges(bright: np.ndarray) -> np.ndarray:
    """Places of pixels in a picture of brightness, uint8, that differ from their neighbours."""
    width = bright.shape[1]
    flat = bright.ravel()  # its parts are contiguous; the columns at the ends of rows are left out
    middle, size = flat[width:-width], flat.size - 2 * width
    high, low = middle.copy(), middle.copy()
    for start in (0, 2 * width, width - 1, width + 1):
        corner = flat[start : start + size]
        np.maximum(high, corner, out=high)
        np.minimum(low, corner, out=low)
    edge = high - low > np.maximum(high // _RELATIVE, _CONTRAST)
    edge = edge.reshape(-1, width)
    edge[:, [0, -1]] = False
    return np.flatnonzero(edge) + width
