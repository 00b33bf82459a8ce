"""A Kalman filter written as textbooks write it, with full matrices, to hold the compiled one against.

66 errors: 18 that are estimated, in the order of the compiled filter, and 48 that are considered, whose gain
is zero; P' = (1 - K H) P (1 - K H)' + K R K' with dense matrices.  Nothing of the package is used.
"""

import numpy as np

from edl6dof.fsw.navigation.filters.kalman.radar_update import WIDEST

ESTIMATED, ALL = 18, 66


def skew(v):
    return np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])


def matrix(q):
    """From B to I, of a unit quaternion, scalar first."""
    s, v = q[0], np.asarray(q[1:])
    return (s * s - v @ v) * np.eye(3) + 2.0 * np.outer(v, v) + 2.0 * s * skew(v)


class TextbookFilter:
    """Errors and their covariance; the solution itself is kept by whoever asks."""

    def __init__(self, unit, planet, site_altitude, terrain, slope, gravity, q):
        self.unit, self.planet, self.site = unit, planet, site_altitude
        (terrain_sigma, self.change, self.relief), (self.slope_sigma, self.slope_change) = (
            terrain,
            np.tan(slope),
        )
        star = unit["star_bias"] ** 2
        spread = np.linalg.inv(unit["gyro_axis"][:6].T @ unit["gyro_axis"][:6])
        self.spread = spread
        P = np.zeros((ALL, ALL))
        P[0:3, 0:3], P[3:6, 3:6] = unit["tracking_position"], unit["tracking_velocity"]
        P[6:9, 6:9] = (unit["star_sigma"] ** 2 + star) * np.eye(3)
        P[9:12, 9:12] = unit["gyro_bias"] ** 2 * spread
        P[12:15, 12:15] = unit["accelerometer_bias"] ** 2 * spread + gravity**2 * np.eye(3)
        P[15, 15], P[16, 16], P[17, 17] = terrain_sigma**2, self.slope_sigma**2, self.slope_sigma**2
        considered = np.concatenate(
            [
                np.tile(unit["gyro_scale"] ** 2 * np.diag(spread), 3),
                np.tile(unit["accelerometer_scale"] ** 2 * np.diag(spread), 3),
                np.full(3, star),
                *([size**2] * 4 + [0.0] * 4 for size in unit[["range_scale", "speed_scale", "range_bias"]]),
                np.full(3, unit["landmarks"]["map_offset"] ** 2),
            ]
        )
        P[18:, 18:] = np.diag(considered)
        P[6:9, 36:39] = -matrix(q) * star
        P[36:39, 6:9] = P[6:9, 36:39].T
        self.P = P
        self.begin()

    def begin(self):
        self.dx = np.zeros(ALL)
        self.cycles = []

    def move(self, dt, angle, gain, q):
        self.cycles.append((dt, np.array(angle), np.array(gain), matrix(q)))

    def carry_forward(self, r, v_rel, level, height, q):
        T = sum(dt for dt, _, _, _ in self.cycles)
        V, S = np.zeros(3), np.zeros(3)
        for dt, _, gain, C in self.cycles:
            S += V * dt + 0.5 * dt * (C @ gain)
            V += C @ gain
        frame = sum(dt * C for dt, _, _, C in self.cycles)
        turned = np.hstack([sum(angle[k] * C for _, angle, _, C in self.cycles) for k in range(3)])
        pushed = np.hstack([sum(gain[k] * C for _, _, gain, C in self.cycles) for k in range(3)])
        size = np.linalg.norm(r)
        G = self.planet["mu"] / size**3 * (3.0 * np.outer(r, r) / size**2 - np.eye(3))
        F = np.eye(ALL)
        F[0:3, 0:3] += 0.5 * T**2 * G
        F[0:3, 3:6] = T * np.eye(3)
        F[3:6, 0:3] = T * G
        F[3:6, 3:6] += 0.5 * T**2 * G
        F[0:3, 6:9], F[3:6, 6:9] = -skew(S), -skew(V)
        for at, block in ((9, frame), (18, turned)):
            width = slice(at, at + block.shape[1])
            F[6:9, width] = -block
            F[3:6, width] = 0.5 * skew(V) @ block
            F[0:3, width] = skew(S) @ block / 3.0
        for at, block in ((12, frame), (27, pushed)):
            width = slice(at, at + block.shape[1])
            F[3:6, width] = -block
            F[0:3, width] = -0.5 * T * block
        north, east, up = level
        F[15, 16], F[15, 17] = T * (north @ v_rel), T * (east @ v_rel)
        unit, C = self.unit, matrix(q)
        Q = np.zeros((ALL, ALL))
        Q[3:6, 3:6] = unit["accelerometer_noise"] ** 2 * T * C @ self.spread @ C.T
        Q[6:9, 6:9] = unit["gyro_noise"] ** 2 * T * C @ self.spread @ C.T
        Q[9:12, 9:12] = unit["gyro_bias_walk"] ** 2 * T * self.spread
        Q[12:15, 12:15] = unit["accelerometer_bias_walk"] ** 2 * T * self.spread
        along = np.linalg.norm(v_rel - (v_rel @ up) * up)
        Q[15, 15] = self.change**2 * along * T / 1000.0
        moved = self.slope_change**2 * np.linalg.norm(v_rel) * T / max(height, 5.0)
        for i in (16, 17):
            Q[i, i] = min(moved, max(self.slope_sigma**2 - self.P[i, i], 0.0))
        self.P = F @ self.P @ F.T + Q
        self.cycles = []

    def take(self, H, R, innovation, up):
        K = self.P @ H / (H @ self.P @ H + R)
        K[0:3] = (K[0:3] @ up) * up  # the place over the planet is considered too
        K[ESTIMATED:] = 0.0
        self.dx = self.dx + K * (innovation - H @ self.dx)
        rest = np.eye(ALL) - np.outer(K, H)
        self.P = rest @ self.P @ rest.T + R * np.outer(K, K)

    def take_range(self, beam, measured, C, arm, level, slope, height):
        """``level``: north, east and up; ``slope``: rise of the ground towards the first two."""
        u, lever, radius = C @ self.unit["beam_axis"][beam], C @ arm, self.planet["equatorial_radius"]
        north, east, up = level
        normal = up - slope[0] * north - slope[1] * east
        height = height - slope[0] * (north @ lever) - slope[1] * (east @ lever)
        c = -u @ normal
        off = abs(height) / c * np.sqrt(1.0 - (u @ up) ** 2)
        reach = (height + off**2 / (2.0 * radius)) / c
        H = np.zeros(ALL)
        vertical = (np.eye(3) - np.outer(up, up)) / radius  # how the vertical turns with the place
        H[0:3] = up / c + reach / c * (vertical @ u)
        H[6:9] = normal @ -skew(lever + reach * u) / c
        H[15], H[39 + beam], H[55 + beam] = -1.0 / c, reach, 1.0
        H[16], H[17] = -north @ (lever + reach * u) / c, -east @ (lever + reach * u) / c
        unit = self.unit
        # relief under the beam: what is left of it is a share, the rest is new
        variance = unit["range_bias"] ** 2 + self.relief**2 * (min(off, WIDEST) / 1000.0) ** 1.5 / c**2
        share = min(variance / self.P[55 + beam, 55 + beam], 1.0) ** 1.5
        self.P[55 + beam] *= share
        self.P[:, 55 + beam] *= share
        self.P[55 + beam, 55 + beam] = variance
        self.take(H, (unit["range_sigma"] + unit["range_sigma_relative"] * reach) ** 2, measured - reach, up)

    def take_speed(self, beam, measured, C, up, velocity, swing):
        u, spin = C @ self.unit["beam_axis"][beam], np.array([0.0, 0.0, self.planet["rotation_rate"]])
        speed = u @ (velocity + swing)
        H = np.zeros(ALL)
        H[0:3], H[3:6], H[6:9], H[47 + beam] = -u @ skew(spin), u, -velocity @ skew(u), speed
        own = self.unit["speed_sigma"] + self.unit["speed_sigma_relative"] * abs(speed)
        self.take(H, own**2, measured - speed, up)
