"""Vibration of an instrument's mount while the engines run: a tone, and a random part.

The random part of each axis is a resonance driven by white noise: y, the rate about or the acceleration along
the axis, is the velocity of an oscillator, x its place, y' = -(2 pi f)^2 x - 2 pi b y + white noise. So y has
its standard deviation, a spectrum that falls to half its peak over the bandwidth b about f, and an integral x
that stays small: a vibration causes no net rotation. The solution is exact for any length of a cycle: in
their own units, 2 pi f x and y are uncorrelated with variance 1, and the random increment has the covariance
I - P P' with P the transition of the oscillator.

Sources: Thomson and Dahleh, Theory of Vibration with Applications (1998), chapter 13, random response of one
degree of freedom; exact discretisation: Gelb, Applied Optimal Estimation (1974), section 3.6.
"""

from __future__ import annotations

from math import pi, sqrt
from typing import Self

import numpy as np
from pydantic import model_validator

from edl6dof.config.base import Params, group, param
from edl6dof.kernels import kernel
from edl6dof.records import record
from edl6dof.spatial.elementary import exp, sincos
from edl6dof.spatial.random_numbers import Stream, normal_pair
from edl6dof.spatial.vector import add, put3, scale, sub, take3

#: Number of oscillators: about three axes, and along three.
WAYS = 6


class RandomParams(Params):
    """Random part, with the engines at full thrust, the same about and along each axis of B."""

    frequency_hz: float = param(
        200.0, "frequency of the peak of the spectrum", status="estimate", gt=0.0, le=1e4
    )
    bandwidth_hz: float = param(
        200.0, "width of the spectrum at half its peak", status="estimate", gt=0.0, le=2e4
    )
    rate_deg_s: float = param(0.0, "standard deviation of the rate", status="estimate", ge=0.0, le=100.0)
    acceleration_g0: float = param(
        0.0, "standard deviation of the acceleration", status="estimate", ge=0.0, le=100.0
    )

    @model_validator(mode="after")
    def _oscillates(self) -> Self:
        if self.bandwidth_hz >= 2.0 * self.frequency_hz:
            raise ValueError("bandwidth_hz has to be below two times frequency_hz")
        return self


class VibrationParams(Params):
    """Vibration of the unit with the engines at full thrust, the same about and along each axis of B."""

    frequency_hz: float = param(63.0, "frequency of the tone", status="estimate", gt=0.0, le=1e4)
    rate_deg_s: float = param(0.02, "amplitude of the rate", status="estimate", ge=0.0, le=100.0)
    acceleration_m_s2: float = param(
        0.3, "amplitude of the acceleration", status="estimate", ge=0.0, le=1000.0
    )
    random: RandomParams = group(RandomParams, "random vibration in addition to the tone")


#: Phases of the tone and key of the random part in this case.
MOUNT = record(("phase", "f8", (3,)), ("key", "i8"))

#: Memory: motion of the unit by the vibration.
VIBRATION = record(
    ("turn_B", "f8", (3,)),  # rad, B
    ("swing_B", "f8", (3,)),  # m/s, B
    ("place", "f8", (WAYS,)),  # of the oscillators, in standard deviations: about the axes, then along
    ("speed", "f8", (WAYS,)),  # of the oscillators, in standard deviations
)


@kernel
def shake(params, mount, case, plant, outputs, dt, cycle, memory):
    """Vibration added to the motion: rate now (rad/s), and rotation (rad) and velocity (m/s) since the last
    reading ``dt`` s ago, number ``cycle``, all in B; ``mount`` and ``memory``: ``MOUNT`` and ``VIBRATION``
    records.
    """
    turn = swing = rate = (0.0, 0.0, 0.0)
    share = thrust_share(case, outputs)
    if share > 0.0:
        rate, turn, swing = tone(params, mount, share, plant.t)
        if params.random.rate > 0.0 or params.random.acceleration > 0.0:
            oscillate(params.random, mount.key, dt, cycle, memory)
            pulsation = 2.0 * pi * params.random.frequency
            about, along = share * params.random.rate, share * params.random.acceleration
            rate = add(rate, scale(about, take3(memory.speed, 0)))
            turn = add(turn, scale(about / pulsation, take3(memory.place, 0)))
            swing = add(swing, scale(along / pulsation, take3(memory.place, 3)))
    turned, swung = sub(turn, take3(memory.turn_B, 0)), sub(swing, take3(memory.swing_B, 0))
    put3(memory.turn_B, 0, turn)
    put3(memory.swing_B, 0, swing)
    return rate, turned, swung


@kernel
def tone(params, mount, share, t):
    """Rate (rad/s), turn (rad) and velocity (m/s) of the tone at ``share`` of full thrust, B."""
    pulsation = 2.0 * pi * params.frequency
    angle = pulsation * t
    sin_x, cos_x = sincos(angle + mount.phase[0])
    sin_y, cos_y = sincos(angle + mount.phase[1])
    sin_z, cos_z = sincos(angle + mount.phase[2])
    wave = (-cos_x, -cos_y, -cos_z)
    rate = scale(share * params.rate, (sin_x, sin_y, sin_z))
    turn = scale(share * params.rate / pulsation, wave)
    swing = scale(share * params.acceleration / pulsation, wave)
    return rate, turn, swing


@kernel
def oscillate(params, key, dt, cycle, memory):
    """Advance the oscillators of ``memory`` by ``dt`` s."""
    pulsation, decay = 2.0 * pi * params.frequency, pi * params.bandwidth
    turning = sqrt(pulsation * pulsation - decay * decay)
    fading, (sine, cosine) = exp(-decay * dt), sincos(turning * dt)
    across, lean = fading * pulsation / turning * sine, fading * decay / turning * sine
    kept = fading * cosine
    # the lower triangular root of I - P P', P = ((kept + lean, across), (-across, kept - lean))
    first = sqrt(max(1.0 - (kept + lean) ** 2 - across * across, 0.0))
    both = 2.0 * across * lean / first if first > 0.0 else 0.0
    second = sqrt(max(1.0 - (kept - lean) ** 2 - across * across - both * both, 0.0))
    for i in range(WAYS):
        one, other = normal_pair(key, WAYS * cycle + i)
        place, speed = memory.place[i], memory.speed[i]
        memory.place[i] = (kept + lean) * place + across * speed + first * one
        memory.speed[i] = (kept - lean) * speed - across * place + both * one + second * other


def draw_mount(rng: Stream, mount: np.void) -> None:
    """Draw the phases of the tone and the key of the random part."""
    mount["phase"] = 2.0 * np.pi * rng.uniform(3)
    mount["key"] = rng.keys()


@kernel
def thrust_share(case, outputs):
    """Thrust of all engines over their full thrust, 0 without engines; vibration and dust scale with it."""
    full = 0.0
    for i in range(case.vehicle.n_engines):
        full += case.vehicle.engines[i].full_thrust
    return outputs.engine_thrust / full if full > 0.0 else 0.0
