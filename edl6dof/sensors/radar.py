"""Landing radars: range, and speed by the Doppler effect, of any number of beams, of one radar or more.

A beam measures to the real ground, or to a part that has left the vehicle and lies in the beam; the speed is
that of the antenna, v + w x l relative to the turning planet, along the beam.  It sees nothing through the
heat shield, from too high or too low, when the vehicle tilts too far, or where it meets the ground at too
flat an angle; an echo is lost at random, more often in the dust that the engines raise.  Uneven reflection
shifts the range of each beam.

Source: Chen and Pollard, Radar terminal descent sensor performance during Mars Science Laboratory landing,
Journal of Spacecraft and Rockets 51(4), 2014.
"""

from __future__ import annotations

from math import pi
from typing import Annotated

import numpy as np
from pydantic import field_validator

from edl6dof.config.base import Capacity, Hardware, Params, Vec3, group, param, unique_names
from edl6dof.config.dtype import in_si
from edl6dof.interface.capacities import MAX_BEAMS
from edl6dof.kernels import kernel
from edl6dof.records import COUNT, record
from edl6dof.registry import Member
from edl6dof.sensors.counters import SenseAxis, axes_towards, turned
from edl6dof.sensors.ray_ground import height_over_ground, point_motion, ray_to_ground, ray_to_part
from edl6dof.sensors.vibration import thrust_share
from edl6dof.spatial.elementary import cos
from edl6dof.spatial.frames import rotate_z
from edl6dof.spatial.quaternion import from_frame
from edl6dof.spatial.random_numbers import Stream, normal_pair, uniform
from edl6dof.spatial.vector import dot, take3
from edl6dof.vehicle.mass import CONFIG_CAPSULE
from edl6dof.vehicle.plant import FALSE_LOCK, OUTAGE, STUCK, take_attitude
from edl6dof.vehicle.surroundings import planet_rotation

#: Random numbers that a beam may use in a reading.
_DRAWS = 4


class Beam(SenseAxis):
    """One beam of a radar."""

    radar: int = param(1, "number of its radar; beams of one radar fail together", ge=1, le=MAX_BEAMS)


class LobeParams(Params):
    """Lobes of a beam, in which parts of the vehicle ahead of it are seen."""

    main_lobe_deg: float = param(
        2.5, "half width of the beam, in which a part hides the ground", status="estimate", ge=0.0, le=45.0
    )
    side_lobe_deg: float = param(
        15.0,
        "angle from the beam within which the echo of a near part is stronger than that of the ground",
        status="estimate",
        ge=0.0,
        le=90.0,
    )
    side_lobe_range_m: float = param(
        50.0, "largest distance of such a part", status="estimate", ge=0.0, le=1e4
    )


class DustParams(Params):
    """Dust that the engines raise, at full thrust just above the ground; less at height and less thrust."""

    height_m: float = param(10.0, "height above which there is no dust", status="estimate", ge=0.0, le=1000.0)
    speed_noise_m_s: float = param(0.3, "noise added to the speed", status="estimate", ge=0.0, le=100.0)
    dropout: float = param(0.2, "probability that a beam loses its echo", status="estimate", ge=0.0, le=1.0)


def four_beams() -> list[Beam]:
    """Four beams evenly on a cone of half angle 25 deg about x of B, named b1..b4."""
    axes = axes_towards("b", [(25.0 * pi / 180.0, pi / 4.0 + k * pi / 2.0) for k in range(4)])
    return [Beam(name=one.name, axis=one.axis) for one in axes]


class RadarParams(Hardware):
    """Landing radar; errors as standard deviations."""

    largest = {"m": 1e6}

    beams: Annotated[list[Beam], Capacity(MAX_BEAMS)] = param(
        None, "the beams and their directions", factory=four_beams, min_length=1, max_length=MAX_BEAMS
    )
    position_m: Vec3 = param((-0.5, 0.0, 0.6), "position of the antenna in B", status="estimate")
    every_cycles: int = param(5, "base cycles from one reading to the next", status="estimate", ge=1, le=1000)
    highest_m: float = param(
        7000.0, "height of the antenna above the ground above which it sees nothing", status="published",
        source="SPCT 2021, Hu et al. 2022", gt=0.0,
    )  # fmt: skip
    lowest_m: float = param(
        5.0, "height below which it sees nothing", status="published", source="SPCT 2021, Hu et al. 2022",
        ge=0.0,
    )  # fmt: skip
    incidence_deg: float = param(
        65.0, "largest angle between a beam and the normal of the ground", status="estimate", gt=0.0, le=85.0
    )
    tilt_deg: float = param(
        45.0, "largest angle between x of B and straight down", status="estimate", gt=0.0, le=90.0
    )
    dropout: float = param(0.005, "probability that a beam has no echo", status="estimate", ge=0.0, le=1.0)
    misalignment_deg: float = param(
        0.03, "error of the direction of a beam, drawn for each case", status="estimate", ge=0.0, le=10.0
    )
    range_noise_m: float = param(0.1, "noise of the range", status="estimate", ge=0.0)
    range_noise_relative_pct: float = param(
        0.25, "additional noise, as a share of the range", status="estimate", ge=0.0, le=100.0
    )
    range_scale_pct: float = param(
        0.15,
        "error of the scale of the range, drawn for each beam and case",
        status="estimate",
        ge=0.0,
        le=100.0,
    )
    reflectivity_m: float = param(
        0.1, "shift of the range of each beam, drawn for each case", status="estimate", ge=0.0
    )
    speed_noise_m_s: float = param(0.033, "noise of the speed", status="estimate", ge=0.0)
    speed_noise_relative_pct: float = param(
        0.25, "additional noise, as a share of the speed", status="estimate", ge=0.0, le=100.0
    )
    speed_scale_pct: float = param(
        0.05,
        "error of the scale of the speed, drawn for each beam and case",
        status="estimate",
        ge=0.0,
        le=100.0,
    )
    lobes: LobeParams = group(LobeParams, "parts of the vehicle in the beams")
    dust: DustParams = group(DustParams, "dust that the engines raise")

    _names_differ = field_validator("beams")(unique_names)

    @property
    def radars(self) -> dict[str, list[str]]:
        """Names of the radars, r1, r2 and so on, and of the beams of each."""
        count = max(beam.radar for beam in self.beams)
        return {
            f"r{number}": [beam.name for beam in self.beams if beam.radar == number]
            for number in range(1, count + 1)
        }


#: Errors of the radar in this case: true directions (B), errors of scale, shifts of the range (m), key of
#: the noise.
UNIT = record(
    ("axis", "f8", (MAX_BEAMS, 3)),
    ("range_scale", "f8", (MAX_BEAMS,)),
    ("speed_scale", "f8", (MAX_BEAMS,)),
    ("reflectivity", "f8", (MAX_BEAMS,)),
    ("key", "i8"),
)
MEMORY = record(("cycle", COUNT))


@kernel
def measure(params, unit, case, tables, plant, outputs, memory, sensed):
    """Measure with every beam, in cycles in which the radar measures."""
    radar, cycle = sensed.radar, memory.cycle
    memory.cycle += 1
    radar.fresh = 1 if cycle % params.every_cycles == 0 else 0
    if radar.fresh == 0:
        return
    rotation = planet_rotation(case.planet, plant.t)
    c, s = rotation
    y, areoid = plant.y, plant.inputs.areoid
    q = take_attitude(y)
    r, v = point_motion(case, plant, outputs, take3(params.position, 0), rotation)
    height, up, _ = height_over_ground(case, tables, areoid, r)
    tilt = -dot(rotate_z(c, s, from_frame(q, (1.0, 0.0, 0.0))), up)
    sees = (
        plant.shape != CONFIG_CAPSULE
        and params.lowest <= height <= params.highest
        and tilt >= cos(params.tilt)
    )
    dust = 0.0
    if height < params.dust.height:
        dust = thrust_share(case, outputs) * (1.0 - max(height, 0.0) / params.dust.height)
    for i in range(params.n_beams):
        distance = speed = 0.0
        if sees:
            beam = rotate_z(c, s, from_frame(q, (unit.axis[i, 0], unit.axis[i, 1], unit.axis[i, 2])))
            distance, incidence = ray_to_ground(
                case, tables, areoid, r_F=r, beam_F=beam, height=height, up_F=up
            )
            speed = dot(v, beam)
            spin = case.planet.rotation_rate
            near, closing = ray_to_part(
                params.lobes, plant, rotation, r_F=r, v_F=v, beam_F=beam, ground_range=distance, spin=spin
            )
            if near > 0.0:
                distance, speed = near, closing
            elif incidence < cos(params.incidence):
                distance = 0.0
        first = _DRAWS * (MAX_BEAMS * cycle + i)
        if uniform(unit.key, first) < params.dropout + dust * params.dust.dropout:
            distance = 0.0
        read(params, unit, plant.instruments, i, (distance, speed, dust), first=first, radar=radar)


@kernel
def read(params, unit, faults, i, echo, first, radar):
    """Write the reading of beam ``i`` with its errors; ``echo``: distance (m; 0: none), speed (m/s), dust."""
    distance, speed, dust = echo
    range_fault, speed_fault = faults.range[i], faults.speed[i]
    if range_fault.mode == STUCK:
        return
    if range_fault.mode == FALSE_LOCK:
        radar.range[i], radar.speed[i], radar.locked[i] = range_fault.offset, speed_fault.offset, 1
        return
    radar.locked[i] = 1 if distance > 0.0 and range_fault.mode != OUTAGE else 0
    if radar.locked[i] == 0:
        radar.range[i] = radar.speed[i] = 0.0
        return
    a, b = normal_pair(unit.key, first + 1)
    range_noise = params.range_noise + params.range_noise_relative * distance
    speed_noise = params.speed_noise + params.speed_noise_relative * abs(speed)
    reach = (1.0 + unit.range_scale[i]) * distance + unit.reflectivity[i] + range_noise * a
    closing = (1.0 + unit.speed_scale[i]) * speed + speed_noise * b
    if dust > 0.0 or range_fault.noise > 0.0 or speed_fault.noise > 0.0:
        a, b = normal_pair(unit.key, first + 2)
        c, _ = normal_pair(unit.key, first + 3)
        reach += range_fault.noise * a
        closing += speed_fault.noise * b + dust * params.dust.speed_noise * c
    radar.range[i] = max(reach + range_fault.offset, 0.0)
    radar.speed[i] = closing + speed_fault.offset


def plan(params: RadarParams, rng: Stream, unit: np.void) -> None:
    """Draw the errors of the instrument in this case."""
    given, n = in_si(params), len(params.beams)
    unit["axis"][:n] = turned(given["beams"]["axis"][:n], given["misalignment"], rng)
    for name in ("range_scale", "speed_scale"):
        unit[name][:n] = given[name] * rng.standard_normal(n)
    unit["reflectivity"][:n] = given["reflectivity"] * rng.standard_normal(n)
    unit["key"] = rng.keys()


MEMBER = Member(
    "radar",
    RadarParams,
    {"measure": measure},
    "Chen and Pollard, Journal of Spacecraft and Rockets 51(4), 2014",
    memory=MEMORY,
    tables=UNIT,
    plan=plan,
    writes=("radar",),
)
