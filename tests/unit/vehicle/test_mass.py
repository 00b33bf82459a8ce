"""Mass properties against conservation and a brute-force cloud of point masses.

A rigid body is replaced by point masses with the same mass, centre and inertia (six on its principal axes);
the cloud of all attached parts is then summed by the definitions of centre and inertia.  No parallel-axis
theorem is used on this side.
"""

import numpy as np
import pytest
from pydantic import ValidationError

from edl6dof.config.dtype import dtype_of, fill
from edl6dof.interface.capacities import MAX_PARTS, MAX_TANKS
from edl6dof.vehicle.mass import (
    BODY,
    CONFIG_BACKSHELL,
    CONFIG_CAPSULE,
    CONFIG_LANDER,
    MassParams,
    Part,
    Tank,
    compose_dry,
    fill_lander,
    join,
    lander_problem,
    loaded,
    shape_of,
    showing,
)
from edl6dof.vehicle.plant import PROPELLANT, STATES
from edl6dof.vehicle.propulsion.feed_system import with_propellant


def part(name, **numbers):
    return Part(name=name, **numbers)


PARTS = {
    "heat_shield": part(
        "heat_shield", mass_kg=90.0, centre_m=(-0.35, 0.01, -0.02), inertia_kg_m2=(95.0, 52.0, 55.0)
    ),
    "backshell": part(
        "backshell", mass_kg=170.0, centre_m=(-1.75, -0.02, 0.015), inertia_kg_m2=(160.0, 110.0, 105.0)
    ),
    "parachute": part("parachute", mass_kg=38.0, centre_m=(-2.35, 0.0, 0.01), inertia_kg_m2=(2.0, 1.5, 1.6)),
}
TANKS = (
    Tank(name="main", mass_kg=180.0, centre_m=(-1.0, 0.005, 0.0), inertia_kg_m2=(60.0, 35.0, 33.0)),
    Tank(name="side", mass_kg=40.0, centre_m=(-0.7, 0.6, -0.3), inertia_kg_m2=(2.0, 2.5, 3.0)),
)
LOADS = np.array([tank.mass_kg for tank in TANKS])
JETTISONED = tuple(PARTS.values())
VEHICLE = MassParams(
    entry_kg=1285.0,
    entry_centre_m=(-0.85, 0.004, -0.034),
    entry_inertia_kg_m2=(1150.0, 1020.0, 990.0),
)


@pytest.fixture(scope="module")
def records():
    return filled(VEHICLE, JETTISONED)


def filled(mass, parts, tanks=TANKS):
    """Records of tanks, parts and lander."""
    slots = np.zeros(MAX_PARTS, dtype_of(Part)).view(np.recarray)
    loads = np.zeros(MAX_TANKS, dtype_of(Tank)).view(np.recarray)
    for slot, one in (*zip(slots, parts, strict=False), *zip(loads, tanks, strict=False)):
        fill(slot, one)
    lander = np.zeros(1, BODY).view(np.recarray)[0]
    fill_lander(lander, mass, parts, tanks)
    return loads, slots, len(parts), lander


def composed(records, attached, left=LOADS):
    """Mass properties with the ``attached`` parts and what is ``left`` in the tanks, kg."""
    tanks, slots, count, lander = records
    dry = np.zeros(1, BODY).view(np.recarray)[0]
    compose_dry(slots, count, lander, np.array(attached), dry)
    y = np.zeros(STATES)
    y[PROPELLANT : PROPELLANT + len(left)] = left
    total, centre, inertia = with_propellant(dry, tanks, len(left), y)
    return total, np.array(centre), tensor(inertia)


def tensor(elements):
    xx, yy, zz, xy, xz, yz = elements
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def cloud(mass, centre, inertia):
    """Six point masses (rows m, x, y, z) with the same mass, centre and inertia tensor."""
    moments, axes = np.linalg.eigh(inertia)
    reach = np.sqrt(np.maximum(moments.sum() / 2.0 - moments, 0.0) * 3.0 / mass)
    rows = [
        (mass / 6.0, *(np.asarray(centre) + s * reach[k] * axes[:, k])) for k in range(3) for s in (1.0, -1.0)
    ]
    return np.array(rows)


def summed(points):
    """Mass, centre and inertia about the centre, by definition."""
    m, p = points[:, 0], points[:, 1:]
    centre = m @ p / m.sum()
    arms = p - centre
    return (
        m.sum(),
        centre,
        sum(mi * (a @ a * np.eye(3) - np.outer(a, a)) for mi, a in zip(m, arms, strict=True)),
    )


def part_cloud(part, share=1.0):
    return cloud(part.mass_kg * share, part.centre_m, np.diag(part.inertia_kg_m2) * share)


def test_parts_and_lander_add_up_to_the_entry_vehicle(records):
    total, centre, inertia = composed(records, (1, 1, 1))
    assert total == pytest.approx(1285.0, rel=1e-15)
    assert centre == pytest.approx(VEHICLE.entry_centre_m, abs=1e-15)
    assert inertia == pytest.approx(np.diag(VEHICLE.entry_inertia_kg_m2), abs=1e-11)


@pytest.mark.parametrize("share", [(1.0, 1.0), (0.37, 0.37), (0.2, 0.9), (0.0, 0.4), (0.0, 0.0)])
@pytest.mark.parametrize("attached", [(1, 1, 1), (1, 1, 0), (0, 1, 0), (0, 0, 0), (1, 0, 1)])
def test_what_is_left_after_a_jettison_is_the_cloud_of_what_was_not_thrown_off(records, attached, share):
    lander = records[3]
    points = [cloud(lander.mass, lander.centre, tensor(lander.inertia))]
    for index, name in enumerate(PARTS):
        if attached[index]:
            points.append(part_cloud(PARTS[name]))
    points += [part_cloud(tank, left) for tank, left in zip(TANKS, share, strict=True) if left > 0.0]
    mass, centre, inertia = summed(np.vstack(points))
    got = composed(records, attached, np.array(share) * LOADS)
    assert got[0] == pytest.approx(mass, rel=1e-14)
    assert got[1] == pytest.approx(centre, abs=1e-14)
    assert got[2] == pytest.approx(inertia, abs=1e-10)


def test_two_bodies_joined_have_the_inertia_of_their_point_masses_in_either_order():
    rng = np.random.default_rng(4)
    clouds = [
        np.column_stack([rng.uniform(1, 9, 5), rng.normal(size=(5, 3)) + offset])
        for offset in (0.0, (2.0, -1.0, 0.5))
    ]
    bodies = []
    for points in clouds:
        mass, centre, inertia = summed(points)
        bodies.append((mass, tuple(centre), tuple(inertia[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]])))
    mass, centre, inertia = summed(np.vstack(clouds))
    for a, b in (bodies, bodies[::-1]):
        got = join(a, b)
        assert got[0] == pytest.approx(mass, rel=1e-15) and got[1] == pytest.approx(centre, abs=1e-14)
        assert tensor(got[2]) == pytest.approx(inertia, abs=1e-11)


def test_the_last_drop_of_propellant_leaves_without_a_jump(records):
    dry, drop, overdrawn = (composed(records, (0, 0, 0), (left, left)) for left in (0.0, 1e-9, -1e-3))
    for part, last, none in zip(dry, drop, overdrawn, strict=True):
        assert np.asarray(last) == pytest.approx(np.asarray(part), abs=1e-8)
        assert np.array_equal(none, part)
    levels = [composed(records, (1, 1, 1), (p, 40.0))[0] for p in np.linspace(0.0, 180.0, 19)]
    assert np.diff(levels) == pytest.approx(10.0, rel=1e-12)


def test_a_vehicle_without_propellant_or_parts_is_its_own_lander():
    bare = MassParams(
        entry_kg=500.0, entry_centre_m=(-0.8, 0.0, 0.0), entry_inertia_kg_m2=(300.0, 200.0, 210.0)
    )
    total, centre, inertia = composed(filled(bare, (), ()), (1, 1, 1), ())
    assert (
        total == 500.0
        and tuple(centre) == (-0.8, 0.0, 0.0)
        and np.array_equal(inertia, np.diag([300.0, 200.0, 210.0]))
    )


@pytest.mark.parametrize(
    "change, words",
    [
        ({"entry_kg": 400.0}, "more than entry_kg"),
        ({"entry_kg": 518.0}, "more than entry_kg"),
        ({"entry_inertia_kg_m2": (1150.0, 1020.0, 150.0)}, "impossible principal inertias"),
        ({"entry_inertia_kg_m2": (3500.0, 1020.0, 990.0)}, "impossible principal inertias"),
        (
            {"backshell": PARTS["backshell"].model_copy(update={"centre_m": (-4.5, 0.0, 0.0)})},
            "impossible principal inertias",
        ),
        ({"lander_inertia_kg_m2": (3500.0, 1020.0, 990.0)}, "impossible principal inertias"),
    ],
    ids=[
        "parts too heavy",
        "nothing left",
        "negative inertia",
        "flatter than a disk",
        "backshell too far aft",
        "impossible inertia given",
    ],
)
def test_a_lander_that_cannot_exist_is_refused(change, words):
    if "lander_inertia_kg_m2" in change:
        change = {"entry_inertia_kg_m2": None, **change}
    parts = tuple({**PARTS, **{name: one for name, one in change.items() if name in PARTS}}.values())
    mass = MassParams(**{**dict(VEHICLE), **{name: one for name, one in change.items() if name not in PARTS}})
    assert words in lander_problem(mass, parts, TANKS)


def test_the_landers_inertia_may_be_given_itself():
    direct = MassParams(
        entry_kg=1285.0,
        entry_centre_m=(-0.85, 0.004, -0.034),
        lander_inertia_kg_m2=(500.0, 420.0, 410.0),
    )
    derived = composed(filled(VEHICLE, JETTISONED), (0, 0, 0), (0.0, 0.0))
    mass, centre, inertia = composed(filled(direct, JETTISONED), (0, 0, 0), (0.0, 0.0))
    assert (mass, tuple(centre)) == (derived[0], tuple(derived[1]))
    assert np.array_equal(inertia, np.diag([500.0, 420.0, 410.0]))
    for both in ({}, {"entry_inertia_kg_m2": (1.0, 1.0, 1.0), "lander_inertia_kg_m2": (1.0, 1.0, 1.0)}):
        with pytest.raises(ValidationError, match="either entry_inertia_kg_m2 or lander_inertia_kg_m2"):
            MassParams(entry_kg=1.0, entry_centre_m=(0.0, 0.0, 0.0), **both)


@pytest.mark.parametrize("attached", [(1, 1, 1), (1, 0, 1), (0, 1, 0), (0, 0, 0)])
def test_the_flight_computers_masses_are_those_of_the_truth(records, attached):
    kept = tuple(one for one, there in zip(JETTISONED, attached, strict=True) if there)
    mass, centre, inertia = loaded(VEHICLE, JETTISONED, TANKS, kept)
    truth = composed(records, attached)
    assert mass == pytest.approx(truth[0], rel=1e-14) and centre == pytest.approx(truth[1], abs=1e-14)
    assert inertia == pytest.approx(truth[2], abs=1e-10)


def test_a_ballast_mass_is_one_part_more():
    """With it the vehicle is the same at entry; without it the centre moves by its share of the arm."""
    ballast = Part(name="ballast", mass_kg=60.0, centre_m=(-0.9, 0.0, 1.2))
    records = filled(VEHICLE, (*JETTISONED, ballast))
    total, centre, inertia = composed(records, (1, 1, 1, 1))
    assert total == pytest.approx(1285.0, rel=1e-15)
    assert inertia == pytest.approx(np.diag(VEHICLE.entry_inertia_kg_m2), abs=1e-11)
    lighter, moved, _ = composed(records, (1, 1, 1, 0))
    assert lighter == pytest.approx(1225.0, rel=1e-15)
    assert moved - centre == pytest.approx(60.0 / 1225.0 * (centre - np.array(ballast.centre_m)), abs=1e-14)


def test_air_meets_the_first_attached_part_that_shows_a_shape_and_then_the_lander():
    slots = np.zeros(3, dtype_of(Part)).view(np.recarray)
    slots["shape"] = (CONFIG_LANDER, CONFIG_CAPSULE, CONFIG_BACKSHELL)
    assert [showing(slots, 3, shape) for shape in (CONFIG_CAPSULE, CONFIG_BACKSHELL)] == [1, 2]
    assert showing(slots, 2, CONFIG_BACKSHELL) == -1
    for attached, shape in (
        ((1, 1, 1), CONFIG_CAPSULE),
        ((1, 0, 1), CONFIG_BACKSHELL),
        ((1, 0, 0), CONFIG_LANDER),
    ):
        assert shape_of(slots, 3, np.array(attached)) == shape
