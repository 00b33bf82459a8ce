"""Print how well the drag ahead is foreseen when the wind from behind is a third state of the air data:
``python tools/tail_wind_known.py``.

The ratio of drag is a level, a trend with height and, here, the wind: a thousand histories of waves of
density, gusts and mean wind are filtered along one entry at a constant bank angle, and at three speeds the
mean ratio from there to the parachute is predicted.  The gain of the filter is the same for all histories, so
nothing is flown.  A row is the true standard deviation of the mean wind that was not expected, a column that
which the filter takes for granted; zero is the filter that flies.
"""

from __future__ import annotations

from math import cos, exp, radians, sin, sqrt

import numpy as np

from edl6dof.fsw.guidance.entry.air_data import AirDataParams

N, SEED = 1000, 1
WINDS = (3.0, 10.0, 20.0)
PRIORS = (0.0, 10.0, 20.0, 40.0)
SPEEDS = (2000.0, 1200.0, 900.0)
SCALE_HEIGHT, DENSITY, RADIUS, MU = 11.1e3, 0.0158, 3397e3, 4.2828e13
DT = 0.5
#: Standard deviation (m/s) of gusts at 20 and 60 km, and their length (m).
GUSTS, GUST_LENGTH = (8.0, 20.0), 2000.0
#: Speed (m/s) and angle (deg) at 125 km, bank (deg), lift-to-drag ratio, m/(CA) (kg/m2), speed at the end.
ENTRIES = {
    "msl": (5845.0, -15.5, 60.0, 0.24, 140.0, 500.0),
    "tianwen1": (4800.0, -11.2, 50.0, 0.17, 110.0, 420.0),
}


def main() -> None:
    """Filter and print."""
    p = AirDataParams()
    for name, entry in ENTRIES.items():
        height, speed, drag = trajectory(*entry)
        ratios = drawn(p, height, np.random.default_rng(SEED))
        print(f"\n{name}: error of the ratio of drag ahead, %, at {', '.join(f'{v:g}' for v in SPEEDS)} m/s")
        print("| wind m/s | " + " | ".join(f"filter {prior:g}" for prior in PRIORS) + " |")
        for wind in WINDS:
            seen = ratios[0] * (1.0 - (wind * ratios[1] + ratios[2]) / speed[:, None]) ** 2
            cells = [errors(p, prior, height, speed, drag, seen) for prior in PRIORS]
            print(f"| {wind:g} | " + " | ".join(" ".join(f"{e:.2f}" for e in cell) for cell in cells) + " |")


def trajectory(speed, angle_deg, bank_deg, lift_to_drag, ballistic, end):
    """Heights (m), speeds (m/s) and drag (m/s2) of a point mass in exponential air."""
    v, gamma, h, up = speed, radians(angle_deg), 125e3, lift_to_drag * cos(radians(bank_deg))
    rows, dt = [], 0.1
    for i in range(100_000):
        if v <= end:
            break
        drag, gravity = 0.5 * DENSITY * exp(-h / SCALE_HEIGHT) * v * v / ballistic, MU / (RADIUS + h) ** 2
        if i % round(DT / dt) == 0:
            rows.append((h, v, drag))
        v -= dt * (drag + gravity * sin(gamma))
        gamma += dt * (up * drag / v + (v / (RADIUS + h) - gravity / v) * cos(gamma))
        h += dt * v * sin(gamma)
    return np.array(rows).T


def drawn(p, height, rng):
    """Ratios of density by level, trend and waves; mean wind in standard deviations; gusts (m/s)."""
    low = np.minimum(height - 60e3, 0.0)[:, None] / SCALE_HEIGHT
    density = 1.0 + 0.03 * rng.standard_normal(N) + p.scale_height_error * rng.standard_normal(N) * low
    density = density + p.wave_sigma * wave(height, p.wave_length_m, rng)
    gusts = np.interp(height, (20e3, 60e3), GUSTS)[:, None] * wave(height, GUST_LENGTH, rng)
    return density, rng.standard_normal(N), gusts


def wave(height, length, rng):
    """Gauss-Markov processes of variance one over height, shape (heights, N)."""
    out = rng.standard_normal((len(height), N))
    for i in range(1, len(height)):
        kept = exp(-abs(height[i] - height[i - 1]) / length)
        out[i] = kept * out[i - 1] + sqrt(1.0 - kept * kept) * out[i]
    return out


def errors(p, prior, height, speed, drag, seen):
    """Standard deviation (%) of the mean ratio predicted at each of ``SPEEDS``, less the true one."""
    state = np.zeros((3, N))
    state[0] = 1.0
    covariance = np.diag([p.drag_error**2, (p.scale_height_error / SCALE_HEIGHT) ** 2, prior**2])
    walk = 2.0 * p.wave_sigma**2 / p.wave_length_m
    found: list[float] = []
    for i in range(1, len(height)):
        move = np.eye(3)
        move[0, 1] = height[i] - height[i - 1]
        state, covariance = move @ state, move @ covariance @ move.T
        covariance[0, 0] += walk * abs(move[0, 1])
        if drag[i] < p.least_drag_m_s2:
            continue
        row = np.array([1.0, 0.0, -2.0 / speed[i]])
        gain = covariance @ row / (row @ covariance @ row + p.reading_error**2)
        state = state + np.outer(gain, seen[i] - row @ state)
        covariance = covariance - np.outer(gain, row @ covariance)
        if len(found) < len(SPEEDS) and speed[i] < SPEEDS[len(found)]:
            ahead = state[0] + state[1] * (height[i:, None] - height[i]) - 2.0 * state[2] / speed[i:, None]
            found.append(100.0 * float(np.mean(ahead - seen[i:], axis=0).std()))
    return found


if __name__ == "__main__":
    main()
