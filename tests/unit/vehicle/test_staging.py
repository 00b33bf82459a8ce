"""Separations conserve linear and angular momentum, the centre of mass, and part at the commanded speed.

The sums over all bodies are taken before and after in 64-bit numpy, about the common centre of mass; the
part, a point mass from then on, leaves with the spin it had.  The vehicle tumbles at up to 40 deg/s and has
offset parts, so no term is zero.
"""

from itertools import permutations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from edl6dof.config.dtype import dtype_of, fill
from edl6dof.interface.capacities import MAX_PARACHUTES, MAX_PARTS, MAX_TANKS
from edl6dof.vehicle.mass import (
    BODY,
    MassParams,
    Part,
    Tank,
    compose_dry,
    fill_lander,
)
from edl6dof.vehicle.motion.point_mass import SIX_DOF
from edl6dof.vehicle.motion.staging import deploy, jettison, release, separate
from edl6dof.vehicle.parachutes.parachute import (
    EXTRACTING,
    INFLATING,
    PACKED,
    PARACHUTE_PARAMS,
    RELEASED,
    SUSPENSION,
    ParachuteParams,
)
from edl6dof.vehicle.plant import (
    ATTITUDE,
    CANOPY_POSITION,
    CANOPY_VELOCITY,
    POSITION,
    PROPELLANT,
    RATE,
    STATE,
    VELOCITY,
)
from edl6dof.vehicle.propulsion.feed_system import with_propellant

VEHICLE = np.dtype(
    [
        ("tanks", dtype_of(Tank), (MAX_TANKS,)),
        ("n_tanks", "i8"),
        ("parts", dtype_of(Part), (MAX_PARTS,)),
        ("n_parts", "i8"),
        ("parachutes", PARACHUTE_PARAMS, (MAX_PARACHUTES,)),
    ],
    align=True,
)
CASE = np.dtype(
    [
        ("vehicle", VEHICLE),
        ("lander", BODY),
        ("suspension", SUSPENSION, (MAX_PARACHUTES,)),
        ("dynamics", "i8"),
    ],
    align=True,
)
MASS = MassParams(
    entry_kg=1285.0,
    entry_centre_m=(-0.85, 0.004, -0.034),
    entry_inertia_kg_m2=(1150.0, 1020.0, 990.0),
)
TANKS = (
    Tank(name="main", mass_kg=180.0, centre_m=(-1.0, 0.005, 0.0), inertia_kg_m2=(60.0, 35.0, 33.0)),
    Tank(name="side", mass_kg=40.0, centre_m=(-0.7, 0.6, -0.3), inertia_kg_m2=(2.0, 2.5, 3.0)),
)
HEAT_SHIELD, BACKSHELL, MAIN_PACK, BALLAST, DROGUE_PACK = range(5)
PARTS = (
    Part(name="heat_shield", mass_kg=90.0, centre_m=(-0.35, 0.01, -0.02), inertia_kg_m2=(95.0, 52.0, 55.0),
         separation_velocity_m_s=(1.5, 0.0, 0.0), drag_area_m2=3.0),
    Part(name="backshell", mass_kg=170.0, centre_m=(-1.75, -0.02, 0.015), inertia_kg_m2=(160.0, 110.0, 105.0),
         separation_velocity_m_s=(-0.5, 0.0, 0.0), drag_area_m2=9.0),
    Part(name="main", mass_kg=38.0, centre_m=(-2.35, 0.1, 0.05), inertia_kg_m2=(2.0, 1.5, 1.6)),
    Part(name="ballast", mass_kg=25.0, centre_m=(-1.1, 0.9, -0.6), inertia_kg_m2=(0.5, 0.4, 0.3),
         separation_velocity_m_s=(-0.4, 2.0, -1.0), drag_area_m2=0.1),
    Part(name="drogue", mass_kg=6.0, centre_m=(-2.3, -0.2, 0.1), inertia_kg_m2=(0.2, 0.1, 0.1)),
)  # fmt: skip
CANOPY = {
    "drag_coefficient": 0.62,
    "mortar_speed_m_s": 30.0,
    "line_length_m": 31.0,
    "confluence_m": (0.0, 0.0, 0.0),
}
CHUTES = tuple(
    ParachuteParams(name=name, diameter_m=size, **CANOPY) for name, size in (("main", 15.96), ("drogue", 4.0))
)


def tumbling(seed, gone=()):
    """Case and plant of a vehicle with random place, attitude, rate and propellant."""
    rng = np.random.default_rng(seed)
    case = np.zeros(1, CASE).view(np.recarray)[0]
    case.dynamics = SIX_DOF
    for slot, tank in zip(case.vehicle.tanks, TANKS, strict=False):
        fill(slot, tank)
    case.vehicle.n_tanks = len(TANKS)
    for slot, part in zip(case.vehicle.parts, PARTS, strict=False):
        fill(slot, part)
    case.vehicle.n_parts = len(PARTS)
    for slot, chute in zip(case.vehicle.parachutes, CHUTES, strict=False):
        fill(slot, chute)
    case.suspension["pack"][:2] = MAIN_PACK, DROGUE_PACK
    case.suspension["carrier"] = BACKSHELL
    fill_lander(case.lander, MASS, PARTS, TANKS)
    plant = np.zeros(1, STATE).view(np.recarray)[0]
    plant.attached[:] = [index not in gone for index in range(MAX_PARTS)]
    compose_dry(case.vehicle.parts, len(PARTS), case.lander, plant.attached, plant.dry)
    plant.y[POSITION : POSITION + 3] = rng.normal(size=3) * 100.0  # near the origin: no rounding
    plant.y[VELOCITY : VELOCITY + 3] = rng.normal(size=3) * 200.0
    quaternion = rng.normal(size=4)
    plant.y[ATTITUDE : ATTITUDE + 4] = quaternion / np.linalg.norm(quaternion)
    plant.y[RATE : RATE + 3] = rng.normal(size=3) * 0.4
    plant.y[PROPELLANT : PROPELLANT + 2] = rng.uniform(0.0, 1.0, 2) * (180.0, 40.0)
    return case, plant


def tensor(elements):
    xx, yy, zz, xy, xz, yz = elements
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def vehicle_body(case, plant):
    """Mass, position, velocity and spin angular momentum (all in I) of the vehicle."""
    turn = Rotation.from_quat(plant.y[ATTITUDE : ATTITUDE + 4], scalar_first=True)
    mass, _, inertia = with_propellant(plant.dry, case.vehicle.tanks, case.vehicle.n_tanks, plant.y)
    spin = turn.apply(tensor(inertia) @ plant.y[RATE : RATE + 3])
    return mass, plant.y[POSITION : POSITION + 3].copy(), plant.y[VELOCITY : VELOCITY + 3].copy(), spin


def totals(bodies, origin, drift):
    """Mass, centre, momentum and angular momentum, seen from a frame at ``origin`` that drifts at
    ``drift``.
    """
    mass = sum(m for m, *_ in bodies)
    centre = sum(m * (r - origin) for m, r, _, _ in bodies) / mass
    momentum = sum(m * (v - drift) for m, _, v, _ in bodies)
    angular = sum(m * np.cross(r - origin, v - drift) + spin for m, r, v, spin in bodies)
    return mass, centre, momentum, angular


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize(
    "index, velocity",
    [
        (HEAT_SHIELD, (1.5, 0.0, 0.0)),
        (BACKSHELL, (-0.5, 0.0, 0.0)),
        (MAIN_PACK, (-30.0, 0.0, 0.0)),
        (BALLAST, (-0.4, 2.0, -1.0)),
    ],
)
def test_a_separation_conserves_momentum_and_parts_at_the_commanded_velocity(index, velocity, seed):
    case, plant = tumbling(seed)
    turn = Rotation.from_quat(plant.y[ATTITUDE : ATTITUDE + 4], scalar_first=True)
    rate_I = turn.apply(plant.y[RATE : RATE + 3])
    before = vehicle_body(case, plant)
    _, origin, drift, _ = before
    debris = plant.debris[index]
    separate(case, plant, index, velocity)
    kept, left = vehicle_body(case, plant), parted(plant, index, turn, rate_I)

    mass0, _, _, spin0 = before
    mass, centre, momentum, angular = totals([kept, left], origin, drift)
    assert mass == pytest.approx(mass0, rel=1e-14)
    assert centre == pytest.approx(np.zeros(3), abs=1e-12)
    assert np.linalg.norm(momentum) < 1e-9 * mass0 * np.linalg.norm(drift)
    assert np.linalg.norm(angular - spin0) < 1e-9 * np.linalg.norm(spin0)

    carried = np.cross(rate_I, left[1] - kept[1])  # what the turning alone makes of the distance
    assert turn.inv().apply(left[2] - kept[2] - carried) == pytest.approx(velocity, abs=1e-8)
    assert (debris["active"], debris["drag_area"]) == (1, PARTS[index].drag_area_m2)
    assert plant.attached[index] == 0


def parted(plant, index, turn, rate_I):
    """Mass, position, velocity and spin of a part that has just left, which keeps the rate it had."""
    debris = plant.debris[index]
    spin = turn.apply(np.array(PARTS[index].inertia_kg_m2) * turn.inv().apply(rate_I))
    return debris["mass"], debris["r_I"].copy(), debris["v_I"].copy(), spin


@pytest.mark.parametrize("order", list(permutations((HEAT_SHIELD, BACKSHELL, MAIN_PACK, BALLAST))))
def test_parts_leave_in_any_order(order):
    """Common mass, centre, momentum and angular momentum of vehicle and parts, all at the same moment."""
    case, plant = tumbling(7)
    turn = Rotation.from_quat(plant.y[ATTITUDE : ATTITUDE + 4], scalar_first=True)
    mass0, origin, drift, spin0 = vehicle_body(case, plant)
    bodies = []
    for index in order:
        rate_I = turn.apply(plant.y[RATE : RATE + 3])
        jettison(case, plant, index)
        bodies.append(parted(plant, index, turn, rate_I))
    mass, centre, momentum, angular = totals([vehicle_body(case, plant), *bodies], origin, drift)
    assert mass == pytest.approx(mass0, rel=1e-14)
    assert centre == pytest.approx(np.zeros(3), abs=1e-12)
    assert np.linalg.norm(momentum) < 1e-9 * mass0 * np.linalg.norm(drift)
    assert np.linalg.norm(angular - spin0) < 1e-9 * np.linalg.norm(spin0)
    left = [part for part, there in zip(PARTS, plant.attached, strict=False) if there]
    assert [part.name for part in left] == ["drogue"]


def test_what_has_left_does_not_leave_again():
    case, plant = tumbling(2, gone=(HEAT_SHIELD,))
    before = plant.y.copy()
    jettison(case, plant, HEAT_SHIELD)
    assert np.array_equal(plant.y, before)


def test_a_separation_without_push_changes_no_motion():
    """A part let go from a turning body: both keep the velocity their own centres had, and the rate stays."""
    case, plant = tumbling(9)
    rate, attitude = plant.y[RATE : RATE + 3].copy(), plant.y[ATTITUDE : ATTITUDE + 4].copy()
    separate(case, plant, HEAT_SHIELD, (0.0, 0.0, 0.0))
    assert np.array_equal(plant.y[RATE : RATE + 3], rate) and np.array_equal(
        plant.y[ATTITUDE : ATTITUDE + 4], attitude
    )


def test_springs_do_the_work_that_the_bodies_gain():
    """Without spin and on one axis: energy gained is half the reduced mass times the square of the separation
    speed.
    """
    case, plant = tumbling(3)
    plant.y[RATE : RATE + 3] = 0.0
    plant.y[VELOCITY : VELOCITY + 3] = 0.0
    case.vehicle.parts[HEAT_SHIELD].centre[:] = plant.dry.centre
    mass = vehicle_body(case, plant)[0]
    separate(case, plant, HEAT_SHIELD, (2.0, 0.0, 0.0))
    m, _, v, _ = vehicle_body(case, plant)
    part = plant.debris[HEAT_SHIELD]
    energy = 0.5 * m * v @ v + 0.5 * part["mass"] * part["v_I"] @ part["v_I"]
    assert energy == pytest.approx(0.5 * m * 90.0 / mass * 2.0**2, rel=1e-12)


def test_the_mortar_throws_the_pack_aft_and_it_becomes_the_canopy():
    case, plant = tumbling(5)
    turn = Rotation.from_quat(plant.y[ATTITUDE : ATTITUDE + 4], scalar_first=True)
    plant.y[RATE : RATE + 3] = 0.0
    assert plant.canopy == PACKED
    deploy(case, plant, 0)
    relative = plant.y[CANOPY_VELOCITY : CANOPY_VELOCITY + 3] - plant.y[VELOCITY : VELOCITY + 3]
    assert turn.inv().apply(relative) == pytest.approx((-30.0, 0.0, 0.0), abs=1e-9)
    behind = turn.inv().apply(
        plant.y[CANOPY_POSITION : CANOPY_POSITION + 3] - plant.y[POSITION : POSITION + 3]
    )
    assert behind == pytest.approx(np.array(PARTS[MAIN_PACK].centre_m) - centre_of(case, plant), abs=1e-12)
    assert plant.canopy == EXTRACTING and plant.debris[MAIN_PACK]["active"] == 0
    assert plant.attached[MAIN_PACK] == 0


def centre_of(case, plant):
    return np.array(with_propellant(plant.dry, case.vehicle.tanks, case.vehicle.n_tanks, plant.y)[1])


@pytest.mark.parametrize(
    "canopy, mass, area", [(INFLATING, 208.0, 9.0 + 200.05 * 0.62), (PACKED, 170.0, 9.0)]
)
def test_the_backshell_takes_an_open_canopy_with_it(canopy, mass, area):
    case, plant = tumbling(6, gone=(HEAT_SHIELD,) if canopy == PACKED else (HEAT_SHIELD, MAIN_PACK))
    plant.canopy = canopy
    jettison(case, plant, BACKSHELL)
    shell = plant.debris[BACKSHELL]
    assert (shell["mass"], shell["drag_area"]) == pytest.approx((mass, area), rel=1e-4)
    assert plant.canopy == RELEASED and plant.attached[BACKSHELL] == 0


def test_parachutes_fly_one_after_the_other():
    """The drogue, cut loose, falls on as it flew; the main one that follows is another body."""
    case, plant = tumbling(4)
    deploy(case, plant, 1)
    assert (plant.parachute, plant.canopy) == (1, EXTRACTING)
    plant.canopy = INFLATING
    canopy = plant.y[CANOPY_POSITION : CANOPY_VELOCITY + 3].copy()
    release(case, plant, 0)  # the other one does not fly
    assert plant.canopy == INFLATING
    release(case, plant, 1)
    drogue = plant.debris[DROGUE_PACK]
    assert plant.canopy == RELEASED
    assert drogue["mass"] == 6.0 and drogue["drag_area"] == pytest.approx(np.pi / 4.0 * 16.0 * 0.62)
    assert np.array_equal(np.concatenate([drogue["r_I"], drogue["v_I"]]), canopy)
    deploy(case, plant, 0)
    assert (plant.parachute, plant.canopy, plant.attached[MAIN_PACK]) == (0, EXTRACTING, 0)


def test_a_parachute_that_still_flies_is_cut_loose_by_the_next():
    case, plant = tumbling(4)
    deploy(case, plant, 1)
    deploy(case, plant, 0)
    assert plant.debris[DROGUE_PACK]["active"] == 1 and (plant.parachute, plant.canopy) == (0, EXTRACTING)
