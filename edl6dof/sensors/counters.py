"""Instruments that count the integral of a motion along their own axes: the common part of gyros and
accelerometers.

A reading counts (1 + scale factor) times the motion along the true axis, plus bias, its random walk, and
white noise whose integral is a random walk; in a cycle it counts no more than its range allows.

Source: IEEE Std 952 (1997), annex C: N (random walk of the count) and K (random walk of the rate) of the
Allan variance N^2 / tau + K^2 tau / 3.
"""

from __future__ import annotations

from collections.abc import Iterable
from math import copysign, pi, sqrt

import numpy as np
from pydantic import field_validator

from edl6dof.config.base import REQUIRED, Key, Params, Vec3, param, unit_vector
from edl6dof.kernels import kernel
from edl6dof.records import record
from edl6dof.spatial.arrays import lengths
from edl6dof.spatial.elementary import acos, cos, sin
from edl6dof.spatial.random_numbers import Stream, normal_pair
from edl6dof.spatial.table_index import wrapped
from edl6dof.spatial.vector import clamp, dot
from edl6dof.vehicle.plant import HARDOVER, OUTAGE, SATURATED, STUCK, WORKING

#: Normals that the instruments of one kind may use in a cycle.
_NORMALS = 32
#: Offsets among these normals: of the noise of faults, and of the walk of the biases; the white noise of each
#: instrument comes first.
_FAULTY, _WALK = 8, 24
#: Cycles from the walk of one bias to that of the next.
_PAUSE = 8


class SenseAxis(Params):
    """One instrument with a sensitive axis: a gyro or accelerometer, a radar beam, a pressure port."""

    name: Key = param(REQUIRED, "name, unique in the unit", record=False, min_length=1)
    axis: Vec3 = param(REQUIRED, "unit vector of its sensitive axis in B")

    _unit_length = field_validator("axis")(unit_vector)


def axes_towards(letter: str, angles: Iterable[tuple[float, float]]) -> list[SenseAxis]:
    """Axes named ``letter``1, 2, ... by their angles (rad) from x of B, and about x of B from y."""
    return [
        SenseAxis(name=f"{letter}{k}", axis=(cos(lean), sin(lean) * cos(turn), sin(lean) * sin(turn)))
        for k, (lean, turn) in enumerate(angles, 1)
    ]


def cone(letter: str) -> list[SenseAxis]:
    """Six axes evenly on a cone of half angle acos(1/sqrt(3)) = 54.74 deg about x of B: they measure every
    direction equally well (H'H = 2 I).
    """
    return axes_towards(letter, [(acos(1.0 / sqrt(3.0)), k * pi / 3.0) for k in range(6)])


def copy_layout(slots: int) -> np.dtype:
    """Layout of the errors of the instruments of one kind in a case: the true axes, relative errors of scale,
    biases (rad/s or m/s2) at the start, and the key of their noise.
    """
    fields = [("axis", "f8", (slots, 3)), ("scale", "f8", (slots,)), ("bias", "f8", (slots,)), ("key", "i8")]
    return np.dtype(fields, align=True)


def counter_layout(slots: int) -> np.dtype:
    """Layout of the memory of the instruments of one kind."""
    return record(
        ("count", "f8", (slots,)),  # rad or m/s, since the start
        ("walk", "f8", (slots,)),  # rad/s or m/s2: how far each bias has walked
        ("error", "f8", (slots,)),  # rad/s or m/s2: of the last cycle, without the error of scale
        ("last", "f8", (slots,)),  # rad or m/s, counted in the last cycle
        ("flagged_until", "f8", (slots,)),  # s: how long the flag of saturation stays
    )


def draw_copies(given: np.void, rng: Stream, copy: np.void) -> None:
    """Fill a record of :func:`copy_layout` from the standard deviations in ``given``, SI units."""
    n = given["n_axes"]
    nominal = given["axes"]["axis"][:n]
    copy["axis"][:n] = turned(nominal, given["misalignment"], rng)
    copy["scale"][:n] = given["scale"] * rng.standard_normal(n)
    copy["bias"][:n] = given["bias"] * rng.standard_normal(n)
    copy["key"] = rng.keys()


def turned(axes: np.ndarray, sigma: float, rng: Stream) -> np.ndarray:
    """Unit vectors (n, 3), each turned by a small random angle of standard deviation ``sigma`` (rad) about
    any axis.
    """
    off = sigma * rng.standard_normal(axes.shape)
    off -= np.sum(off * axes, axis=1, keepdims=True) * axes
    true = axes + off
    return np.asarray(true / lengths(true)[:, None])


@kernel
def count(params, copy, faults, moved, t, dt, cycle, memory, readings, flags):
    """Add the last cycle to the counts.

    Args:
        params: parameters of the kind: ``n_axes``, ``range``, ``noise``, ``bias_walk``, ``quantum``,
            ``persistence``.
        copy: record of :func:`copy_layout`.
        faults: ``READING_FAULT`` records.
        moved: integral of the motion over the cycle (B), rad or m/s.
        t, dt: end and length of the cycle, s.
        cycle: number of the cycle.
        memory: record of :func:`counter_layout`.
        readings: written: the count of each instrument.
        flags: written: 1 for each instrument that met the end of its range in the last ``persistence`` s.
    """
    most, first = params.range * dt, _NORMALS * cycle
    density = params.noise / sqrt(dt) if dt > 0.0 else 0.0
    second = 0.0
    walk(params, copy, dt, cycle, memory)
    for i in range(params.n_axes):
        if i % 2 == 0:
            white, second = normal_pair(copy.key, first + i)
        else:
            white = second
        fault = faults[i]
        error = copy.bias[i] + memory.walk[i] + fault.offset + density * white
        if fault.noise > 0.0:
            error += fault.noise * normal_pair(copy.key, first + _FAULTY + i)[0]
        memory.error[i] = error
        axis = (copy.axis[i, 0], copy.axis[i, 1], copy.axis[i, 2])
        wanted = (1.0 + copy.scale[i]) * dot(axis, moved) + error * dt
        counted = clamp(wanted, -most, most)
        met = counted != wanted and dt > 0.0
        if fault.mode != WORKING:
            counted = faulty_count(fault.mode, memory.last[i], wanted, most)
            met = fault.mode == SATURATED
        if met:
            memory.flagged_until[i] = t + params.persistence
        memory.last[i] = counted
        memory.count[i] += counted
        total = memory.count[i]
        readings[i] = total - wrapped(total, params.quantum) if params.quantum > 0.0 else total
        flags[i] = 1 if met or t < memory.flagged_until[i] else 0


@kernel
def faulty_count(mode, last, wanted, most):
    """Count of a failed instrument in a cycle; ``last``: its previous count, ``wanted``: that of a healthy
    instrument, ``most``: largest count.
    """
    if mode == STUCK:
        return last
    if mode == HARDOVER:
        return most
    if mode == OUTAGE:
        return 0.0
    return copysign(most, wanted)


@kernel
def walk(params, copy, dt, cycle, memory):
    """Advance the random walk of one bias, each in turn, by the time since its last turn."""
    if cycle % _PAUSE == 0 and params.bias_walk > 0.0:
        i, n = (cycle // _PAUSE) % params.n_axes, params.n_axes
        far, _ = normal_pair(copy.key, _NORMALS * cycle + _WALK)
        memory.walk[i] += params.bias_walk * sqrt(_PAUSE * n * dt) * far


@kernel
def rates(params, copy, faults, rate, dt, memory, readings):
    """Rate that each instrument reads at the end of the cycle just counted by :func:`count`; ``rate``: true
    rate (B).
    """
    for i in range(params.n_axes):
        axis = (copy.axis[i, 0], copy.axis[i, 1], copy.axis[i, 2])
        read = (1.0 + copy.scale[i]) * dot(axis, rate) + memory.error[i]
        if faults[i].mode != WORKING:
            read = memory.last[i] / dt if dt > 0.0 else 0.0
        readings[i] = clamp(read, -params.range, params.range)
