"""The entry as planned before the flight: the reference trajectory.

A point mass flies over the rotating ellipsoid in the believed air and the expected wind.  The sequencer and
the steering of the flight computer run its mission from the first phase and command the bank angle: preset
bank, limits, sides, reversals at the bank rate, heading alignment and level wings are those of the flight.
One number, added to the cosine of the open-loop bank angle, brings the end, at the final speed or Mach
number, to the aim point.  The delay of the bank angle after its command, about 1 s, is left out.
Source: equations of motion, :mod:`~edl6dof.fsw.guidance.entry.predictor`.
"""

from __future__ import annotations

from collections.abc import Callable
from math import sqrt

import numpy as np

from edl6dof.fsw.functions import PLACES
from edl6dof.fsw.guidance.entry.aim_point import to_target
from edl6dof.fsw.guidance.entry.airframe import believed_aero
from edl6dof.fsw.guidance.entry.predictor import AS_BELIEVED, acceleration, aim_direction, roll, step
from edl6dof.fsw.guidance.entry.reference import PLANNED, reference_bank
from edl6dof.fsw.guidance.entry.reversal.registry import STEERING, steer_bank
from edl6dof.fsw.guidance.guidance_command import GUIDE
from edl6dof.fsw.guidance.phase_guidance import hold_bank
from edl6dof.fsw.mission import G_ENTRY, G_HOLD_BANK, SEQUENCE, sequence
from edl6dof.fsw.navigation.derived import NAV, model_atmosphere
from edl6dof.fsw.vehicle_state import VEHICLE_STATE, follow_events
from edl6dof.interface.capacities import MAX_EVENTS
from edl6dof.kernels import kernel
from edl6dof.records import record
from edl6dof.scenario.schema import Scenario, Start, start_of
from edl6dof.spatial.elementary import asin, atan2, cos, sin
from edl6dof.spatial.frames import fixed_to_ned, geodetic
from edl6dof.spatial.vector import cross, dot, norm, put3, scale, sub, take3, unit

#: Shortest step from one row of the plan to the next, s.
SHORTEST_STEP = 0.1
#: Largest number of rows of a plan, and depth (m) below the site at which it ends.
MAX_ROWS, TOO_LOW = 8000, 4000.0
#: Accepted miss (m), resolution of cos(bank) (about 1 m of range), and most flights of the search.
CLOSE, RESOLUTION, MOST_FLIGHTS = 0.5, 1e-5, 60

#: Fields that the rows of a plan and navigated states have in common.
SHARED = (
    *("t", "latitude", "longitude", "altitude", "speed", "azimuth"),
    *("bank", "energy", "mach", "drag", "dynamic_pressure"),
)
#: State in F, and inputs, memory and outputs of the flight computer.
SCRATCH = record(
    ("r", "f8", (3,)),
    ("v", "f8", (3,)),
    ("bank", "f8"),  # rad, flown
    ("nav", NAV),
    ("vehicle", VEHICLE_STATE),
    ("guide", GUIDE),
    ("sequence", SEQUENCE),
    ("steering", STEERING),
    ("request", "u1", (MAX_EVENTS,)),
)


def plan_entry(onboard: np.ndarray, scenario: Scenario, about: float | None = None) -> np.ndarray:
    """Fly the reference, fitted to the aim point if the profile asks for it, and write its shift into
    ``onboard[0]["reference"]``.

    Args:
        onboard: onboard record array of length one, its models, mission and aim point filled.
        scenario: the nominal scenario.
        about: shift of cos(bank) near which the solution is searched first.

    Returns:
        the rows of the plan, ``PLANNED``; if no bank angle reaches the aim point, those of the nearest end.
    """
    record, start = onboard[0], start_of(scenario)
    shift = 0.0
    if record["guidance"]["entry"]["reference_bank"]["fit_range"]:
        shift = _met(lambda value: float(fly_shifted(record, start, value)["beyond"][-1]), about)
    record["reference"]["shift"] = shift
    return fly_shifted(record, start, shift)


def planned_again(onboard: np.ndarray, scenario: Scenario) -> np.ndarray:
    """Fly the plan with the shift in ``onboard[0]["reference"]``; return its rows, ``PLANNED``."""
    return fly_shifted(onboard[0], start_of(scenario), float(onboard[0]["reference"]["shift"]))


def planned_states(onboard: np.ndarray, scenario: Scenario) -> tuple[np.ndarray, np.ndarray]:
    """States of the plan as inputs of an entry law: ``NAV`` and ``GUIDE`` records, one for each row.

    Attitude, specific force and the inertial axes remain zero.
    """
    rows, record = planned_again(onboard, scenario), onboard[0]
    navs, guides = np.zeros(len(rows), NAV), np.zeros(len(rows), GUIDE)
    for name in SHARED:
        navs[name] = rows[name]
    navs["flight_path_angle"] = rows["path_angle"]
    navs["lift"] = np.sqrt(np.square(rows["load"]) - np.square(rows["drag"]))
    navs["height"] = rows["altitude"] - record["site"]["altitude"]
    navs["radius"] = record["planet"]["equatorial_radius"] + rows["altitude"]
    navs["gravity"] = record["planet"]["mu"] / np.square(navs["radius"])
    for nav, guide in zip(navs, guides, strict=True):
        level = nav["speed"] * cos(nav["flight_path_angle"])
        down = -nav["speed"] * sin(nav["flight_path_angle"])
        nav["v_N"] = level * cos(nav["azimuth"]), level * sin(nav["azimuth"]), down
        guide["range_to_go"], guide["crossrange"], guide["downrange_to_go"] = to_target(record, nav)
    guides["drag_ratio"], guides["lift_ratio"], guides["side"] = 1.0, 1.0, rows["side"]
    guides["least_bank"] = record["guidance"]["entry"]["bank_min"]
    return navs, guides


def fly_shifted(record: np.void, start: Start, shift: float) -> np.ndarray:
    """Fly the planned bank profile open loop, and return the trajectory as ``PLANNED`` rows.

    Args:
        record: ``ONBOARD`` record.
        start: state at the entry interface.
        shift: number that is added to the cosine of every planned bank angle.
    """
    cycle = 1.0 / float(record["rates"]["base"])
    stride = max(int(record["rates"]["entry_guidance_every"]), round(SHORTEST_STEP / cycle))
    history = np.zeros(MAX_ROWS, PLANNED)
    logic = int(record["guidance"]["entry"]["reversal"]["logic"])
    bank_side = PLACES["bank_side"].function({logic})
    scratch = np.zeros(2, SCRATCH)
    count = fly_plan(bank_side, record, start, shift, cycle, stride, history=history, scratch=scratch)
    return history[:count]


def _met(miss: Callable[[float], float], about: float | None) -> float:
    """Shift at which ``miss`` is zero, or the end of the effective shifts that is nearer to zero miss."""
    widest = (-2.0, 2.0)
    spans = [widest] if about is None else [(about - 0.05, about + 0.05), widest]
    for low, high in spans:
        short, far = miss(low), miss(high)
        if short < 0.0 < far:
            return _false_position(miss, (low, short), (high, far))
    return widest[0] if short >= 0.0 else widest[1]


def _false_position(
    miss: Callable[[float], float], below: tuple[float, float], above: tuple[float, float]
) -> float:
    """Zero of ``miss`` between two arguments, each with its value: false position, Illinois variant (Dowell &
    Jarratt 1971, BIT 11); where ``miss`` jumps, the place of the jump.
    """
    (low, short), (high, far) = below, above
    for _ in range(MOST_FLIGHTS):
        middle = low - short * (high - low) / (far - short)
        value = miss(middle)
        if abs(value) < CLOSE or high - low < RESOLUTION:
            return middle
        if value < 0.0:
            low, short, far = middle, value, 0.5 * far
        else:
            high, far, short = middle, value, 0.5 * short
    return middle


@kernel
def fly_plan(bank_side, onboard, start, shift, cycle, stride, history, scratch):
    """Fly from ``start`` to the final speed or Mach number; return the count of rows written.

    Args:
        bank_side: kernel of the reversal logic.
        onboard: ``ONBOARD`` record.
        start: position (m) and velocity (m/s) in F.
        shift: shift of the cosine of the open-loop bank angle.
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
        going = decide(bank_side, onboard, k * cycle, shift, s)
        if not going and stride > 1 and k > 0:
            # the end lies within the last stride: once more, cycle by cycle
            scratch[0] = scratch[1]
            k, stride = k - stride + 1, 1
            advance(onboard, s, cycle)
            continue
        note(onboard, s, here, ahead, target, row=history[count])
        count += 1
        if not going:
            break
        scratch[1] = scratch[0]
        advance(onboard, s, stride * cycle)
        k += stride
    return count


@kernel
def decide(bank_side, onboard, t, shift, s):
    """Let the flight computer read the state, run its mission and steer; return False at the end."""
    mission, entry = onboard.mission, onboard.guidance.entry
    look(onboard, t, s)
    s.request[:] = 0
    sequence(mission, s.nav, s.vehicle, s.guide, memory=s.sequence, request=s.request)
    follow_events(onboard.vehicle, mission, t, s.request, s.vehicle)
    s.nav.wing_open = s.vehicle.wing_commanded
    guidance = mission.phases[s.sequence.phase].guidance
    if guidance == G_HOLD_BANK:
        hold_bank(onboard, s.nav, s.guide)
    elif guidance == G_ENTRY:
        s.guide.range_to_go, s.guide.crossrange, s.guide.downrange_to_go = to_target(onboard, s.nav)
        wanted = reference_bank(onboard, shift, s.nav.speed)
        steer_bank(bank_side, onboard, s.nav, s.steering, s.guide, wanted=wanted)
    fast = s.nav.mach > entry.final_mach if entry.final_mach > 0.0 else s.nav.speed > entry.final_speed
    return fast and s.nav.height > -TOO_LOW


@kernel
def look(onboard, t, s):
    """Write the inputs of mission, steering and reversal logics."""
    planet, nav = onboard.planet, s.nav
    r, v = take3(s.r, 0), take3(s.v, 0)
    _, nav.drag, _ = acceleration(onboard, AS_BELIEVED, r, v, (1.0, 0.0))
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
def advance(onboard, s, dt):
    """Propagate the state by ``dt`` (s) while the vehicle rolls to the commanded bank angle."""
    r, v, rate = take3(s.r, 0), take3(s.v, 0), onboard.guidance.entry.bank_rate
    s.bank, up, right = roll(s.bank, s.guide.bank, rate, dt)
    shares = up, right
    a, _, _ = acceleration(onboard, AS_BELIEVED, r, v, shares)
    r, v = step(onboard, AS_BELIEVED, r, v, a, lift_shares=shares, dt=dt)
    put3(s.r, 0, r)
    put3(s.v, 0, v)


@kernel
def note(onboard, s, here, ahead, target, row):
    """Write a row of the plan; ``here``, ``ahead`` and ``target`` span the great circle from the start to the
    aim point.
    """
    nav, radius = s.nav, onboard.planet.equatorial_radius
    area, lift_to_drag = believed_aero(onboard.vehicle, nav.mach, nav.speed)
    row.t, row.altitude, row.speed, row.path_angle = nav.t, nav.altitude, nav.speed, nav.flight_path_angle
    row.azimuth, row.energy, row.mach = nav.azimuth, nav.energy, nav.mach
    there, end = unit(take3(s.r, 0)), atan2(dot(target, ahead), dot(target, here))
    row.beyond = radius * (atan2(dot(there, ahead), dot(there, here)) - end)
    row.aside = radius * asin(dot(there, cross(ahead, here)))
    row.latitude, row.longitude = nav.latitude, nav.longitude
    row.bank, row.side = s.guide.bank, s.steering.sign
    row.drag, row.load = nav.drag, nav.drag * sqrt(1.0 + lift_to_drag * lift_to_drag)
    row.dynamic_pressure = nav.drag * onboard.vehicle.entry_mass / area
    row.density, _, _ = model_atmosphere(onboard.atmosphere, nav.altitude)
