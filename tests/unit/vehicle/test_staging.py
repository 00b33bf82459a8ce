"""Separations conserve linear and angular momentum, the centre of mass, and part at the commanded speed.

The sums over all bodies are taken before and after in 64-bit numpy, about the common centre of mass; the
part, a point mass from then on, leaves with the spin it had.  The vehicle tumbles at up to 40 deg/s and has
offset parts, so no term is zero.
"""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from edl6dof.config.dtype import dtype_of, fill
from edl6dof.interface.parts import BACKSHELL, HEAT_SHIELD, PARACHUTE
from edl6dof.vehicle.mass import (
    BODY,
    MassParams,
    Part,
    compose_dry,
    fill_lander,
    with_propellant,
)
from edl6dof.vehicle.parachute import EXTRACTING, INFLATING, PACKED, RELEASED, ParachuteParams
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
from edl6dof.vehicle.staging import StagingParams, fire_mortar, release_backshell, separate

VEHICLE = np.dtype(
    [
        ("mass", dtype_of(MassParams)),
        ("parachute", dtype_of(ParachuteParams)),
        ("staging", dtype_of(StagingParams)),
    ],
    align=True,
)
CASE = np.dtype([("vehicle", VEHICLE), ("lander", BODY)], align=True)
MASS = MassParams(
    entry_kg=1285.0,
    entry_centre_m=(-0.85, 0.004, -0.034),
    entry_inertia_kg_m2=(1150.0, 1020.0, 990.0),
    heat_shield=Part(mass_kg=90.0, centre_m=(-0.35, 0.01, -0.02), inertia_kg_m2=(95.0, 52.0, 55.0)),
    backshell=Part(mass_kg=170.0, centre_m=(-1.75, -0.02, 0.015), inertia_kg_m2=(160.0, 110.0, 105.0)),
    parachute=Part(mass_kg=38.0, centre_m=(-2.35, 0.1, 0.05), inertia_kg_m2=(2.0, 1.5, 1.6)),
    propellant=Part(mass_kg=220.0, centre_m=(-1.0, 0.005, 0.0), inertia_kg_m2=(60.0, 35.0, 33.0)),
)
NAMES = {HEAT_SHIELD: "heat_shield", BACKSHELL: "backshell", PARACHUTE: "parachute"}


def tumbling(seed, attached=(1, 1, 1)):
    """Case and plant of a vehicle with random place, attitude, rate and propellant."""
    rng = np.random.default_rng(seed)
    case = np.zeros(1, CASE).view(np.recarray)[0]
    fill(case.vehicle.mass, MASS)
    fill(case.vehicle.parachute, ParachuteParams(diameter_m=15.96))
    fill(case.vehicle.staging, StagingParams())
    fill_lander(case.lander, MASS)
    plant = np.zeros(1, STATE).view(np.recarray)[0]
    plant.attached[:] = attached
    compose_dry(case.vehicle.mass, case.lander, plant.attached, plant.dry)
    plant.y[POSITION : POSITION + 3] = rng.normal(size=3) * 100.0  # near the origin: no rounding
    plant.y[VELOCITY : VELOCITY + 3] = rng.normal(size=3) * 200.0
    quaternion = rng.normal(size=4)
    plant.y[ATTITUDE : ATTITUDE + 4] = quaternion / np.linalg.norm(quaternion)
    plant.y[RATE : RATE + 3] = rng.normal(size=3) * 0.4
    plant.y[PROPELLANT] = rng.uniform(0.0, 220.0)
    return case, plant


def tensor(elements):
    xx, yy, zz, xy, xz, yz = elements
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def vehicle_body(case, plant):
    """Mass, position, velocity and spin angular momentum (all in I) of the vehicle."""
    turn = Rotation.from_quat(plant.y[ATTITUDE : ATTITUDE + 4], scalar_first=True)
    mass, _, inertia = with_propellant(plant.dry, case.vehicle.mass.propellant, plant.y[PROPELLANT])
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
@pytest.mark.parametrize("index, speed", [(HEAT_SHIELD, 1.5), (BACKSHELL, -0.5), (PARACHUTE, -30.0)])
def test_a_separation_conserves_momentum_and_parts_at_the_commanded_speed(index, speed, seed):
    case, plant = tumbling(seed)
    part, params = case.vehicle.mass[NAMES[index]].view(np.recarray), getattr(MASS, NAMES[index])
    turn = Rotation.from_quat(plant.y[ATTITUDE : ATTITUDE + 4], scalar_first=True)
    rate_I = turn.apply(plant.y[RATE : RATE + 3])
    before = vehicle_body(case, plant)
    _, origin, drift, _ = before
    debris = plant.debris[1]
    separate(case, plant, part, index, speed, debris, 3.0)
    part_spin = turn.apply(np.array(params.inertia_kg_m2) * turn.inv().apply(rate_I))
    kept = vehicle_body(case, plant)
    left = (debris["mass"], debris["r_I"], debris["v_I"], part_spin)

    mass0, _, _, spin0 = before
    mass, centre, momentum, angular = totals([kept, left], origin, drift)
    assert mass == pytest.approx(mass0, rel=1e-14)
    assert centre == pytest.approx(np.zeros(3), abs=1e-12)
    assert np.linalg.norm(momentum) < 1e-9 * mass0 * np.linalg.norm(drift)
    assert np.linalg.norm(angular - spin0) < 1e-9 * np.linalg.norm(spin0)

    carried = np.cross(rate_I, left[1] - kept[1])  # what the turning alone makes of the distance
    assert turn.inv().apply(left[2] - kept[2] - carried) == pytest.approx((speed, 0.0, 0.0), abs=1e-8)
    assert (debris["active"], debris["drag_area"], plant.attached[index]) == (1, 3.0, 0)


def test_a_separation_without_push_changes_no_motion():
    """A part let go from a turning body: both keep the velocity their own centres had, and the rate stays."""
    case, plant = tumbling(9)
    rate, attitude = plant.y[RATE : RATE + 3].copy(), plant.y[ATTITUDE : ATTITUDE + 4].copy()
    separate(case, plant, case.vehicle.mass.heat_shield, HEAT_SHIELD, 0.0, plant.debris[0], 1.0)
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
    case.vehicle.mass.heat_shield.centre[:] = plant.dry.centre
    mass = vehicle_body(case, plant)[0]
    separate(case, plant, case.vehicle.mass.heat_shield, HEAT_SHIELD, 2.0, plant.debris[0], 1.0)
    m, _, v, _ = vehicle_body(case, plant)
    part = plant.debris[0]
    energy = 0.5 * m * v @ v + 0.5 * part["mass"] * part["v_I"] @ part["v_I"]
    assert energy == pytest.approx(0.5 * m * 90.0 / mass * 2.0**2, rel=1e-12)


def test_the_mortar_throws_the_pack_aft_and_it_becomes_the_canopy():
    case, plant = tumbling(5)
    turn = Rotation.from_quat(plant.y[ATTITUDE : ATTITUDE + 4], scalar_first=True)
    plant.y[RATE : RATE + 3] = 0.0
    assert plant.canopy == PACKED
    fire_mortar(case, plant)
    relative = plant.y[CANOPY_VELOCITY : CANOPY_VELOCITY + 3] - plant.y[VELOCITY : VELOCITY + 3]
    assert turn.inv().apply(relative) == pytest.approx((-30.0, 0.0, 0.0), abs=1e-9)
    behind = turn.inv().apply(
        plant.y[CANOPY_POSITION : CANOPY_POSITION + 3] - plant.y[POSITION : POSITION + 3]
    )
    assert behind == pytest.approx(np.array(MASS.parachute.centre_m) - centre_of(case, plant), abs=1e-12)
    assert plant.canopy == EXTRACTING and plant.debris[1]["active"] == 0 and plant.attached[PARACHUTE] == 0


def centre_of(case, plant):
    return np.array(with_propellant(plant.dry, case.vehicle.mass.propellant, plant.y[PROPELLANT])[1])


@pytest.mark.parametrize(
    "canopy, mass, area", [(INFLATING, 208.0, 9.0 + 200.05 * 0.62), (PACKED, 170.0, 9.0)]
)
def test_the_backshell_takes_an_open_canopy_with_it(canopy, mass, area):
    case, plant = tumbling(6, attached=(0, 1, int(canopy == PACKED)))
    plant.canopy = canopy
    release_backshell(case, plant)
    shell = plant.debris[1]
    assert (shell["mass"], shell["drag_area"]) == pytest.approx((mass, area), rel=1e-4)
    assert plant.canopy == RELEASED and plant.attached[BACKSHELL] == 0
