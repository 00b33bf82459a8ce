"""Instruments of a made-up landing, which err as the flight computer believes.

``draws`` are numbers drawn before and how many of them are used (see :func:`drawn_before`): numba takes 3 s
to compile numpy's generator, and what is done with arrays of three; and long to compile what makes arrays.
"""

import numpy as np
from made_up_course import DT, RADIUS, SPIN, moving

from edl6dof.fsw.navigation.filters.kalman.radar_update import WIDEST
from edl6dof.fsw.navigation.strapdown import level_axes
from edl6dof.kernels import kernel
from edl6dof.spatial.quaternion import from_frame, multiply, normalise
from edl6dof.spatial.vector import add, cross, dot, scale, sub, take3

#: Least cosine between beam and normal of the ground with which there is an echo: 65 deg.
FLATTEST = 0.42
ARM, CENTRE = (0.3, 0.6, -0.2), (-0.9, 0.02, 0.01)


def drawn_before(rng, cycles):
    """Standard normal numbers for so many cycles, and how many of them are used."""
    return rng.standard_normal(100 + 30 * cycles), np.zeros(1, np.int64)


@kernel
def normal(draws):
    """The next number."""
    draws[1][0] += 1
    return draws[0][draws[1][0] - 1]


def normals(draws, size, rows, columns=1):
    """The next numbers times ``size``, row after row."""
    numbers, used = draws
    used[0] += rows * columns
    return size * numbers[used[0] - rows * columns : used[0]].reshape(rows, columns)


@kernel
def true_range(u, up, rise, height):
    """Range along ``u`` to a sphere of the planet's radius, whose ground rises by the vector ``rise``."""
    c = -dot(u, up)
    far = RADIUS + height
    if dot(rise, rise) == 0.0:
        return far * c - np.sqrt(RADIUS**2 - far**2 * (1.0 - c * c))
    reach, fallen = 0.0, 0.0
    for _ in range(5):
        reach = (height + fallen) / (c + dot(u, rise))
        fallen = 0.5 * (1.0 - c * c) * reach**2 / RADIUS
    return reach


def draw_unit(unit, size, draws):
    """Errors of the instruments of one flight: biases (B) and matrices of scale and misalignment of gyros and
    accelerometers, bias of the star tracker, scales of the radar, and its shifts of the range (m) with their
    variance, which change with the relief.  ``size``: factor of all.
    """
    half = size * np.sqrt(0.5)  # six instruments on a cone: H'H = 2
    return (
        normals(draws, half * unit["gyro_bias"], 3),
        normals(draws, half * unit["accelerometer_bias"], 3),
        normals(draws, half * unit["gyro_scale"], 3, 3),
        normals(draws, half * unit["accelerometer_scale"], 3, 3),
        normals(draws, size * unit["star_bias"], 3),
        normals(draws, size * unit["range_scale"], unit["n_beams"]),
        normals(draws, size * unit["speed_scale"], unit["n_beams"]),
        normals(draws, size * unit["range_bias"], unit["n_beams"]),
        np.full((unit["n_beams"], 1), unit["range_bias"] ** 2),
    )


@kernel
def walk(bias, size, draws):
    """A cycle of the random walk of a bias."""
    for i in range(3):
        bias[i, 0] += size * np.sqrt(DT) * normal(draws)


@kernel
def spoilt(i, increment, scales, noise, bias, believed, draws):
    """Component ``i`` of an increment over a cycle, as it is counted and corrected by the believed bias."""
    wrong = scales[i, 0] * increment[0] + scales[i, 1] * increment[1] + scales[i, 2] * increment[2]
    return increment[i] + wrong + noise * np.sqrt(DT) * normal(draws) + DT * (bias[i, 0] - believed[i])


@kernel
def star_fix(unit, q, bias, size, draws):
    """What the star tracker says of the attitude ``q``."""
    noise = (normal(draws), normal(draws), normal(draws))
    turned = from_frame(q, (bias[0, 0], bias[1, 0], bias[2, 0]))
    e = scale(0.5, add(scale(size * unit.star_sigma, noise), turned))
    return normalise(multiply((1.0, e[0], e[1], e[2]), q))


@kernel
def shift(drawn, b, variance, size, draws):
    """Shift (m) of the range of a beam over relief, of which a part is that of the look before."""
    shifts, variances = drawn[7], drawn[8]
    share = min(variance / max(variances[b, 0], 1e-12), 1.0)
    kept = share * np.sqrt(share)
    new = np.sqrt(max(variance - kept**2 * variances[b, 0], 0.0))
    shifts[b, 0] = kept * shifts[b, 0] + size * new * normal(draws)
    variances[b, 0] = variance
    return shifts[b, 0]


@kernel
def read_radar(onboard, relief, t, r, v, q, rate, ground, drawn, looks, size, radar, draws):
    """Fill ``radar``; ``ground``: height, and rise towards north and east; ``looks``: state of each beam (0
    sound, 1 lost, 2 locked on something 60 m away).
    """
    unit = onboard.instruments
    arm = sub(ARM, CENTRE)
    place = add(r, from_frame(q, arm))
    north, east, up, altitude = level_axes(onboard.planet, place, t)
    rise = add(scale(ground[1], north), scale(ground[2], east))
    height = altitude - onboard.site.altitude - ground[0] - dot(rise, from_frame(q, arm))
    velocity = add(moving(place, v), from_frame(q, cross(rate, arm)))
    radar.fresh = 5.0 < height < 7500.0
    for b in range(unit.n_beams):
        u = from_frame(q, take3(unit.beam_axis[b], 0))
        slope = -dot(u, up)
        seen = height > 0.0 and slope + dot(u, rise) > FLATTEST
        reach, speed = true_range(u, up, rise, height) if seen else 0.0, dot(u, velocity)
        off = min(reach * np.sqrt(1.0 - slope**2), WIDEST) / 1000.0
        variance = unit.range_bias**2 + relief**2 * off**1.5 / (slope + dot(u, rise)) ** 2
        noise = size * (unit.range_sigma + unit.range_sigma_relative * reach) * normal(draws)
        noise += shift(drawn, b, variance, size, draws)
        radar.range[b] = reach * (1.0 + drawn[5][b, 0]) + noise
        noise = unit.speed_sigma + unit.speed_sigma_relative * abs(speed)
        radar.speed[b] = speed * (1.0 + drawn[6][b, 0]) + size * noise * normal(draws)
        radar.locked[b] = seen and looks[b] != 1
        if looks[b] == 2:
            radar.range[b], radar.speed[b] = 60.0, 12.0


def lay_ground(params, rs, vs, heights, size, draws):
    """Height of the ground below each cycle above what is believed of the site, and its rise towards north
    and east, as the filter believes ground to be; shape (cycles, 3).  Where the radar sees it, it rises.
    """
    moved = vs + SPIN * np.column_stack([rs[:, 1], -rs[:, 0], 0.0 * rs[:, 0]])
    up = rs / np.linalg.norm(rs, axis=1)[:, None]
    level = moved - np.sum(moved * up, axis=1)[:, None] * up
    east = np.column_stack([-up[:, 1], up[:, 0], 0.0 * up[:, 0]])
    east /= np.linalg.norm(east, axis=1)[:, None]
    way = np.column_stack([np.sum(level * axis, axis=1) for axis in (np.cross(up, east), east)]) * DT
    change = params["terrain_change"] * np.sqrt(np.linalg.norm(level, axis=1) * DT / 1000.0)
    change[0] = params["terrain_sigma"]
    chance, (most, some) = (
        normals(draws, size, 3, len(rs)),
        np.tan(params[["slope_sigma", "slope_change"]].item()),
    )
    share = np.minimum(some**2 / most**2 * np.linalg.norm(moved, axis=1) * DT / np.maximum(heights, 5.0), 1.0)
    ground = np.zeros((len(rs), 3))
    ground[0] = chance[:, 0] * (change[0], most, most)
    for k in range(1, len(rs)):
        ground[k, 1:] = np.sqrt(1.0 - share[k]) * ground[k - 1, 1:] + np.sqrt(share[k]) * most * chance[1:, k]
        rise = ground[k, 1:] @ way[k] if heights[k] < 7500.0 else 0.0
        ground[k, 0] = ground[k - 1, 0] + rise + change[k] * chance[0, k]
    return ground
