"""The descent under the parachute as it is expected before the flight: how far it carries the lander.

A point mass in the believed air and the expected wind, over flat ground at rest (Coriolis acceleration,
0.01 m/s2, carries it 30 m), hanging from a canopy whose axis lies along the flow.  The flight computer's own
sequencer runs its own mission from the phase that deploys a parachute, as long as no phase steers; delays of
events, some 10 ms, are left out but for the mortar's.
Source: equations of motion with drag alone, Knacke, Parachute Recovery Systems Design Manual (1991), section
5.2; the classical Runge-Kutta method.
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

import numpy as np

from edl6dof.environment.wind_models import table_wind
from edl6dof.fsw.guidance.entry.air_data import ExpectedWindParams
from edl6dof.fsw.guidance.entry.airframe import believed_aero
from edl6dof.fsw.guidance.guidance_command import GUIDE
from edl6dof.fsw.mission import G_NONE, SEQUENCE, enter, sequence
from edl6dof.fsw.navigation.derived import NAV, model_atmosphere
from edl6dof.fsw.vehicle_state import VEHICLE_STATE
from edl6dof.interface.capacities import MAX_EVENTS
from edl6dof.interface.events import DEPLOY, JETTISON
from edl6dof.kernels import kernel
from edl6dof.vehicle.parachutes.parachute import drag_efficiency, inflation, nominal_area

#: Step, s, and how many of them at most.
STEP, STEPS = 0.1, 36000
#: Rows of the state: place, m, and velocity relative to the ground, m/s.
NORTH, EAST, ALTITUDE, V_NORTH, V_EAST, V_UP = range(6)

#: What the sequencer looks at, remembers and writes.
SCRATCH = np.dtype(
    [
        ("nav", NAV),
        ("vehicle", VEHICLE_STATE),
        ("guide", GUIDE),
        ("sequence", SEQUENCE),
        ("request", "u1", (MAX_EVENTS,)),
    ],
    align=True,
)


class Wind(NamedTuple):
    """The expected wind: factor on that of the table, and what is added to it towards north and east, m/s."""

    table_factor: float
    north: float
    east: float


def wind_of(params: ExpectedWindParams) -> Wind:
    """The expected wind that parameters describe."""
    return Wind(params.table_factor, params.north_m_s, params.east_m_s)


@kernel
def wind_at(wind, table, height):
    """Return the wind expected towards north and east (m/s) at a ``height`` (m) above the areoid, from the
    ``table`` of the believed air.
    """
    east, north = table_wind(wind, table, height)
    return wind.table_factor * north + wind.north, wind.table_factor * east + wind.east


class Hanging(NamedTuple):
    """Falling body: index of the parachute, flight time (s) at which its lines are taut, and mass (kg)."""

    chute: int
    line_stretch: float
    mass: float


@kernel
def expected_drift(onboard, parachutes, winds, wind, areoid, phase, y, scratch):
    """Carry ``y`` from the deployment of the parachute to where it has left the lander to its engines or to
    the ground.

    Args:
        onboard: ``ONBOARD`` record, its air, site, vehicle and mission filled.
        parachutes: records of the nominal parachutes.
        winds: ``ATMOSPHERE_TABLE`` of the believed air.
        wind: :class:`Wind`.
        areoid: height of the areoid at the site above the ellipsoid, m.
        phase: index of the mission phase that deploys.
        y: state, shape (6,), updated.
        scratch: ``SCRATCH`` record, zero.
    """
    mission, configuration = onboard.mission, onboard.vehicle.configuration
    gone, hanging = 0, Hanging(0, np.inf, configuration[0].mass)
    scene = (onboard, parachutes, winds, wind, areoid)
    enter(phase, 0.0, scratch.sequence)
    for k in range(STEPS):
        if mission.phases[scratch.sequence.phase].guidance != G_NONE or y[ALTITUDE] <= onboard.site.altitude:
            return
        _look(onboard, y, k * STEP, scratch.nav)
        scratch.request[:] = 0
        sequence(
            mission,
            scratch.nav,
            scratch.vehicle,
            scratch.guide,
            memory=scratch.sequence,
            request=scratch.request,
        )
        for number in range(mission.n_events):
            event = mission.events[number]
            if scratch.request[number] == 0:
                continue
            if event.action == JETTISON:
                gone |= 1 << event.component
                hanging = Hanging(hanging.chute, hanging.line_stretch, configuration[gone].mass)
            elif event.action == DEPLOY:
                pack = parachutes[event.component]
                taut = k * STEP + event.delay + pack.line_length / pack.mortar_speed
                hanging = Hanging(event.component, taut, hanging.mass)
        _advance(scene, hanging, k * STEP, y)


@kernel
def _look(onboard, y, t, nav):
    """Write what triggers watch."""
    density, sound, _ = model_atmosphere(onboard.atmosphere, y[ALTITUDE])
    nav.t = t
    nav.speed = sqrt(y[V_NORTH] * y[V_NORTH] + y[V_EAST] * y[V_EAST] + y[V_UP] * y[V_UP])
    nav.mach = nav.speed / sound
    nav.dynamic_pressure = 0.5 * density * nav.speed * nav.speed
    nav.altitude = y[ALTITUDE]
    nav.height = y[ALTITUDE] - onboard.site.altitude
    nav.v_N[2] = -y[V_UP]


@kernel
def _advance(scene, hanging, t, y):
    """Carry the state ``y`` over one step from ``t`` (s): Runge-Kutta of fourth order."""
    a = _rates(scene, hanging, t, y)
    b = _rates(scene, hanging, t + 0.5 * STEP, _moved(y, 0.5 * STEP, a))
    c = _rates(scene, hanging, t + 0.5 * STEP, _moved(y, 0.5 * STEP, b))
    d = _rates(scene, hanging, t + STEP, _moved(y, STEP, c))
    for i in range(len(y)):
        y[i] += STEP / 6.0 * (a[i] + 2.0 * (b[i] + c[i]) + d[i])


@kernel
def _moved(y, step, rates):
    """The state after a step (s) at these rates."""
    moved = np.empty(len(y))
    for i in range(len(y)):
        moved[i] = y[i] + step * rates[i]
    return moved


@kernel
def _rates(scene, hanging, t, y):
    """Rates of the state at time ``t`` (s), shape (6,): m/s, then m/s2.

    Args:
        scene: vehicle and air as :func:`expected_drift` is given them, from ``onboard`` to ``areoid``.
        hanging: :class:`Hanging`.
        t: flight time, s.
        y: state, shape (6,).
    """
    onboard, parachutes, winds, wind, areoid = scene
    planet, chute = onboard.planet, parachutes[hanging.chute]
    density, sound, _ = model_atmosphere(onboard.atmosphere, y[ALTITUDE])
    north, east = wind_at(wind, winds, y[ALTITUDE] - areoid)
    v_north, v_east = y[V_NORTH] - north, y[V_EAST] - east
    speed = sqrt(v_north * v_north + v_east * v_east + y[V_UP] * y[V_UP])
    mach = speed / sound
    area, _ = believed_aero(onboard.vehicle, mach, speed)
    canopy = nominal_area(chute) * chute.drag_coefficient * chute.drag_factor * drag_efficiency(chute, mach)
    area += canopy * inflation(chute, t - hanging.line_stretch)
    per_speed = 0.5 * density * speed * area / hanging.mass
    radius = planet.equatorial_radius + y[ALTITUDE]
    rates = np.empty(6)
    for i in range(V_NORTH):
        rates[i] = y[V_NORTH + i]
    rates[V_NORTH] = -per_speed * v_north
    rates[V_EAST] = -per_speed * v_east
    rates[V_UP] = -per_speed * y[V_UP] - planet.mu / (radius * radius)
    return rates
