"""The entry as it is planned before the flight: the reference trajectory.

A point mass over the rotating ellipsoid in the believed air and the expected wind.  The flight computer's own
sequencer runs its own mission from the first phase as long as it steers, and its own steering makes the
commanded bank angle of the open-loop one: preset bank, limits, sides, reversals at the bank rate, heading
alignment and level wings are those of the flight.  One number, added to the cosine of the open-loop bank
angle, brings the end to the aim point.
Source: Vinh, Busemann & Culp 1980, chapter 2, in planet-fixed Cartesian axes; the classical Runge-Kutta
method.  Left out: the time the vehicle takes to follow the commanded bank angle, about 1 s.
"""

from __future__ import annotations

from collections.abc import Callable
from math import asin, atan2, cos, sin, sqrt

import numpy as np
from scipy.optimize import brentq

from edl6dof.fsw.guidance.command import GUIDE
from edl6dof.fsw.guidance.entry.geometry import to_target
from edl6dof.fsw.guidance.entry.prediction.airframe import believed_aero
from edl6dof.fsw.guidance.entry.prediction.predictor import aim_direction
from edl6dof.fsw.guidance.entry.prediction.reference import PLANNED, reference_bank
from edl6dof.fsw.guidance.entry.steering import STEERING, steer_bank
from edl6dof.fsw.guidance.update import hold_bank
from edl6dof.fsw.mission.phases import G_ENTRY, G_HOLD_BANK
from edl6dof.fsw.mission.sequencer import SEQUENCE, sequence
from edl6dof.fsw.navigation.derived import NAV, expected_wind, model_atmosphere
from edl6dof.fsw.vehicle_state import VEHICLE_STATE, follow_events
from edl6dof.interface.capacities import MAX_EVENTS
from edl6dof.jit import kernel
from edl6dof.scenario.schema import Scenario
from edl6dof.scenario.start import Start, start_of
from edl6dof.spatial.frames import fixed_to_ned, geodetic, ned_to_fixed
from edl6dof.spatial.vector import add, cross, dot, norm, put3, scale, sub, take3, unit

#: Guidance cycles are not followed more often than this, s.
SHORTEST_STEP = 0.1
#: Rows of a plan at most, and how far (m) below the site one is followed.
MAX_ROWS, TOO_LOW = 8000, 4000.0
#: Change of cos(bank) that is not sought any finer: about 1 m of range.
RESOLUTION = 1e-5

#: What is planned with: the state in F, and what the flight computer looks at, remembers and writes.
SCRATCH = np.dtype(
    [
        ("r", "f8", (3,)),
        ("v", "f8", (3,)),
        ("nav", NAV),
        ("vehicle", VEHICLE_STATE),
        ("guide", GUIDE),
        ("sequence", SEQUENCE),
        ("steering", STEERING),
        ("request", "u1", (MAX_EVENTS,)),
    ],
    align=True,
)


def plan_entry(onboard: np.ndarray, scenario: Scenario, about: float | None = None) -> np.ndarray:
    """Fly the reference, to the aim point if that is to be met, and write its shift into
    ``onboard[0]["reference"]``.

    Args:
        onboard: onboard record array of length one, its models, mission and aim point filled.
        scenario: the nominal one.
        about: shift of cos(bank) near which the solution is looked for first.

    Returns:
        the rows of the plan, ``PLANNED``.  Where no bank angle reaches the aim point, those of the nearest.
    """
    record, start = onboard[0], start_of(scenario)
    shift = 0.0
    if record["guidance"]["entry"]["reference_bank"]["fit_range"]:
        shift = _met(lambda value: float(_flown(record, start, value)["beyond"][-1]), about)
    record["reference"]["shift"] = shift
    return _flown(record, start, shift)


def planned_again(onboard: np.ndarray, scenario: Scenario) -> np.ndarray:
    """Rows of the plan, ``PLANNED``, whose shift stands in ``onboard[0]["reference"]``."""
    return _flown(onboard[0], start_of(scenario), float(onboard[0]["reference"]["shift"]))


def _flown(record: np.void, start: Start, shift: float) -> np.ndarray:
    cycle = 1.0 / float(record["rates"]["base"])
    stride = max(int(record["rates"]["entry_guidance_every"]), round(SHORTEST_STEP / cycle))
    history = np.zeros(MAX_ROWS, PLANNED)
    count = fly_plan(record, start, shift, cycle, stride, history, np.zeros(2, SCRATCH))
    return history[:count]


def _met(miss: Callable[[float], float], about: float | None) -> float:
    """Where ``miss`` is zero, within all shifts that change anything; the end nearest to that where it is
    nowhere.
    """
    widest = (-2.0, 2.0)
    spans = [widest] if about is None else [(about - 0.05, about + 0.05), widest]
    for low, high in spans:
        short, far = miss(low), miss(high)
        if short < 0.0 < far:
            return float(brentq(miss, low, high, xtol=RESOLUTION))
    return widest[0] if short >= 0.0 else widest[1]


@kernel
def fly_plan(onboard, start, shift, cycle, stride, history, scratch):
    """Fly from ``start`` to where the mission steers no longer; returns the count of rows written.

    Args:
        onboard: ``ONBOARD`` record.
        start: position (m) and velocity (m/s) in F.
        shift: of the cosine of the open-loop bank angle.
        cycle: base cycle of the flight software, s.
        stride: cycles from one row to the next.
        history: ``PLANNED`` records, written.
        scratch: two ``SCRATCH`` records, zero.
    """
    s = scratch[0]
    put3(s.r, 0, (start[0], start[1], start[2]))
    put3(s.v, 0, (start[3], start[4], start[5]))
    s.guide.drag_ratio = s.guide.lift_ratio = 1.0
    here, target = unit(take3(s.r, 0)), aim_direction(onboard)
    ahead = unit(sub(target, scale(dot(target, here), here)))
    k, count = 0, 0
    while count < history.shape[0]:
        steers = decide(onboard, k * cycle, shift, s)
        if not steers and stride > 1 and k > 0:
            # the end lies within the last stride: once more, cycle by cycle
            scratch[0] = scratch[1]
            k, stride = k - stride + 1, 1
            advance(onboard, s, cycle)
            continue
        note(onboard, s, here, ahead, target, history[count])
        count += 1
        if not steers:
            break
        scratch[1] = scratch[0]
        advance(onboard, s, stride * cycle)
        k += stride
    return count


@kernel
def decide(onboard, t, shift, s):
    """Let the flight computer look at the state, run its mission and steer; whether it still does."""
    mission = onboard.mission
    look(onboard, t, s)
    s.request[:] = 0
    sequence(mission, s.nav, s.vehicle, s.guide, s.sequence, s.request)
    follow_events(onboard.vehicle, mission, t, s.request, s.vehicle)
    s.nav.wing_open = s.vehicle.wing_commanded
    guidance = mission.phases[s.sequence.phase].guidance
    if guidance == G_HOLD_BANK:
        hold_bank(onboard, s.nav, s.guide)
    elif guidance == G_ENTRY:
        s.guide.range_to_go, s.guide.crossrange = to_target(onboard, s.nav)
        steer_bank(onboard, s.nav, s.steering, s.guide, reference_bank(onboard, shift, s.nav.speed))
    else:
        return False
    return s.nav.height > -TOO_LOW


@kernel
def look(onboard, t, s):
    """Write what mission, steering and reversal logics watch."""
    planet, nav = onboard.planet, s.nav
    r, v = take3(s.r, 0), take3(s.v, 0)
    _, nav.drag, _ = motion(onboard, r, v, s.guide.bank)
    sin_lat, cos_lat, sin_lon, cos_lon, altitude = geodetic(planet.equatorial_radius, planet.flattening, r)
    v_N = fixed_to_ned(sin_lat, cos_lat, sin_lon, cos_lon, v)
    put3(nav.v_N, 0, v_N)
    nav.t = t
    nav.latitude, nav.longitude, nav.altitude = atan2(sin_lat, cos_lat), atan2(sin_lon, cos_lon), altitude
    nav.height = altitude - onboard.site.altitude
    nav.radius, nav.speed = norm(r), norm(v)
    nav.flight_path_angle = atan2(-v_N[2], sqrt(v_N[0] * v_N[0] + v_N[1] * v_N[1]))
    nav.azimuth = atan2(v_N[1], v_N[0])
    density, sound, _ = model_atmosphere(onboard.atmosphere, altitude)
    nav.mach = nav.speed / sound
    nav.dynamic_pressure = 0.5 * density * nav.speed * nav.speed
    nav.gravity = planet.mu / (nav.radius * nav.radius)
    radius = planet.equatorial_radius
    nav.energy = 0.5 * nav.speed * nav.speed + planet.mu * (1.0 / radius - 1.0 / (radius + altitude))


@kernel
def motion(onboard, r, v, bank):
    """Planet-relative acceleration (m/s2, F), the drag in it (m/s2) and airspeed (m/s), at position and
    velocity in F.
    """
    planet, vehicle = onboard.planet, onboard.vehicle
    sin_lat, cos_lat, sin_lon, cos_lon, altitude = geodetic(planet.equatorial_radius, planet.flattening, r)
    density, sound, _ = model_atmosphere(onboard.atmosphere, altitude)
    north, east = expected_wind(onboard.atmosphere, altitude)
    u = sub(v, ned_to_fixed(sin_lat, cos_lat, sin_lon, cos_lon, (north, east, 0.0)))
    airspeed = norm(u)
    area, lift_to_drag = believed_aero(vehicle, airspeed / sound)
    drag = 0.5 * density * airspeed * airspeed * area / vehicle.entry_mass
    x = scale(1.0 / airspeed, u)
    right = unit(cross(x, r))
    lifted = add(scale(cos(bank), cross(right, x)), scale(sin(bank), right))
    a = add(scale(-drag, x), scale(lift_to_drag * drag, lifted))
    size = norm(r)
    z2 = r[2] * r[2] / (size * size)
    k = 1.5 * planet.j2 * (planet.gravity_radius / size) ** 2
    level, axial = 1.0 + k * (1.0 - 5.0 * z2), 1.0 + k * (3.0 - 5.0 * z2)
    a = sub(a, scale(planet.mu / (size * size * size), (level * r[0], level * r[1], axial * r[2])))
    w = planet.rotation_rate
    return add(a, (2.0 * w * v[1] + w * w * r[0], -2.0 * w * v[0] + w * w * r[1], 0.0)), drag, airspeed


@kernel
def advance(onboard, s, dt):
    """One Runge-Kutta step at the commanded bank angle."""
    r, v, bank = take3(s.r, 0), take3(s.v, 0), s.guide.bank
    a1, _, _ = motion(onboard, r, v, bank)
    v2 = add(v, scale(0.5 * dt, a1))
    a2, _, _ = motion(onboard, add(r, scale(0.5 * dt, v)), v2, bank)
    v3 = add(v, scale(0.5 * dt, a2))
    a3, _, _ = motion(onboard, add(r, scale(0.5 * dt, v2)), v3, bank)
    v4 = add(v, scale(dt, a3))
    a4, _, _ = motion(onboard, add(r, scale(dt, v3)), v4, bank)
    put3(s.r, 0, add(r, scale(dt / 6.0, add(add(v, v4), scale(2.0, add(v2, v3))))))
    put3(s.v, 0, add(v, scale(dt / 6.0, add(add(a1, a4), scale(2.0, add(a2, a3))))))


@kernel
def note(onboard, s, here, ahead, target, row):
    """Write a row of the plan; ``here``, ``ahead`` and ``target`` span the great circle from the start to the
    aim point.
    """
    nav, radius = s.nav, onboard.planet.equatorial_radius
    _, drag, airspeed = motion(onboard, take3(s.r, 0), take3(s.v, 0), s.guide.bank)
    _, sound, _ = model_atmosphere(onboard.atmosphere, nav.altitude)
    area, lift_to_drag = believed_aero(onboard.vehicle, airspeed / sound)
    there = unit(take3(s.r, 0))
    row.t, row.altitude, row.speed, row.path_angle = nav.t, nav.altitude, nav.speed, nav.flight_path_angle
    row.azimuth, row.energy = nav.azimuth, nav.energy
    row.beyond = radius * (
        atan2(dot(there, ahead), dot(there, here)) - atan2(dot(target, ahead), dot(target, here))
    )
    row.aside = radius * asin(dot(there, cross(ahead, here)))
    row.bank, row.side = s.guide.bank, s.steering.sign
    row.mach, row.airspeed, row.drag = airspeed / sound, airspeed, drag
    row.load = drag * sqrt(1.0 + lift_to_drag * lift_to_drag)
    row.dynamic_pressure = drag * onboard.vehicle.entry_mass / area
