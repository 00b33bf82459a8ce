"""Verifies: momentum, angular momentum and common centre of mass over mortar fire, heat-shield jettison and
backshell release.

gravity none | atmosphere none | winds none | vehicle Tianwen-1, tumbling at 25 deg/s | source: conservation,
summed over all bodies in numpy; a part that has left is a point that keeps the spin it left with | tolerance
1e-9 relative to the impulse of the spring: rounding only, on a planet of 1 km, where positions resolve 2e-13
m.  After mortar fire the flight continues through line stretch, where the riser pulls vehicle and canopy
together: 1e-5 there, RK4 turns a riser of 30 rad/s in steps of 10 ms.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from edl6dof.scenario.schema import Scenario
from edl6dof.sim.checkpoint import State
from edl6dof.sim.flight import Flight
from edl6dof.vehicle.plant import CANOPY_POSITION, CANOPY_VELOCITY
from edl6dof.vehicle.propulsion.feed_system import with_propellant
from edl6dof.verify import case
from edl6dof.verify.case import Bench, doing, given, state_of, to_the_end

_SCENE = (
    *(*case.BARE, *case.VACUUM, *case.WEIGHTLESS, *case.ENDLESS),
    "planet.equatorial_radius_m=1000",
    *given("initial", altitude_m=1000, speed_m_s=0, rate_deg_s=[10, -20, 11]),
)
#: Action and component of the event at t = 0, part that leaves (as the canopy, or on its own), seconds flown,
#: tolerance.
_PARTINGS = (
    ("mortar", "deploy", "main", "parachute_pack", 3.0, 1e-5),
    ("heat shield", "jettison", "heat_shield", "heat_shield", 1.0, 1e-9),
    ("backshell", "jettison", "backshell", "backshell", 1.0, 1e-9),
)


def _vehicle(plant: np.void, tanks: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Position, velocity and spin (angular momentum) in I of the vehicle with the propellant left."""
    y = plant["y"]
    i = with_propellant(plant["dry"], tanks, count, y)[2]
    inertia = np.array([[i[0], i[3], i[4]], [i[3], i[1], i[5]], [i[4], i[5], i[2]]])
    turn = Rotation.from_quat(y[6:10], scalar_first=True)
    return y[0:3].copy(), y[3:6].copy(), turn.apply(inertia @ y[10:13])


def _sums(
    bodies: list[tuple[float, np.ndarray, np.ndarray]], spin: np.ndarray, origin: np.ndarray
) -> tuple[np.ndarray, ...]:
    """Mass moment, momentum and angular momentum of all bodies about ``origin``; ``spin``: their own spin."""
    nothing = np.zeros(3)
    return (
        sum((m * (r - origin) for m, r, _ in bodies), nothing),
        sum((m * v for m, _, v in bodies), nothing),
        spin + sum((m * np.cross(r - origin, v) for m, r, v in bodies), nothing),
    )


def _balance(nominal: Scenario, start: State, flight: Flight, part: str, seconds: float) -> float:
    """Largest change of the three sums, divided by the impulse that parts the bodies; angular momentum per
    metre, mass moment per second.
    """
    before, after = start.plant[0], flight.plant[0]
    index = [one.name for one in nominal.vehicle.parts].index(part)
    properties, vehicle = nominal.vehicle.parts[index], flight.case[0]["vehicle"]
    tanks = vehicle["tanks"], vehicle["n_tanks"]
    r, v, spin = _vehicle(before, *tanks)
    origin, mass = r.copy(), nominal.vehicle.mass.entry_kg
    first = _sums([(mass, r, v)], spin, origin)
    turn = Rotation.from_quat(before["y"][6:10], scalar_first=True)
    own = turn.apply(np.array(properties.inertia_kg_m2) * before["y"][10:13])
    gone = after["debris"][index]["r_I"], after["debris"][index]["v_I"]
    if part == nominal.vehicle.main_parachute.pack:
        gone = tuple(after["y"][at : at + 3] for at in (CANOPY_POSITION, CANOPY_VELOCITY))
    r, v, spin = _vehicle(after, *tanks)
    second = _sums([(mass - properties.mass_kg, r, v), (properties.mass_kg, *gone)], spin + own, origin)
    impulse = properties.mass_kg * np.linalg.norm(gone[1] - v)
    change = [second[0] - first[0] - seconds * first[1], second[1] - first[1], second[2] - first[2]]
    return float(max(np.linalg.norm(c) for c in change) / impulse)


def jettison(bench: Bench) -> None:
    """Part each body at t = 0 from a tumbling vehicle, fly on and compare the sums."""
    for name, action, component, part, seconds, tolerance in _PARTINGS:
        scene = [*_SCENE, *doing((action, component, 0.0)), f"simulation.time_limit_s={seconds}"]
        nominal, loaded = bench.scenes(scene)
        flight = to_the_end(loaded)
        error = _balance(nominal, state_of(loaded), flight, part, seconds)
        why = "rounding" if tolerance < 1e-6 else "line stretch, stiff riser"
        about = ("-", "separation and riser", "conservation of momentum", why)
        bench.compare(f"{name}, {seconds:g} s", error, tolerance, *about)
