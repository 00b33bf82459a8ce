"""A mesh in Newtonian and free-molecular flow, against closed forms and the integrals of a body of
revolution; its table in flight; meshes that cannot be flown.
"""

from math import cos, pi, radians, sin

import numpy as np
import pytest
from aero_capsule import DENSE, RARE, gas_record
from mesh_files import box, revolved, sphere, write_glb, write_stl, write_text_stl

from edl6dof.config.dtype import fill
from edl6dof.interchange.meshes import read_triangles
from edl6dof.vehicle.aerodynamics.body import BodyAeroParams, body_aero
from edl6dof.vehicle.aerodynamics.body_table import (
    body_inputs,
    build_body_table,
    continuum,
    directions_of,
    placed_corners,
)
from edl6dof.vehicle.aerodynamics.capsule import CapsuleParams
from edl6dof.vehicle.aerodynamics.newtonian import (
    References,
    capsule_rings,
    hull_share,
    integrals,
    panels_of,
    stagnation_pressure_coefficient,
    surface_integrals,
    windward_integrals,
)
from edl6dof.vehicle.aerodynamics.wrench import AERO, AeroParams

UNIT = References(pi, np.array([2.0, 2.0, 2.0]), np.zeros(3))


def test_sphere_has_unit_drag_from_everywhere():
    """Newtonian, Cp_max 2: CD = 1; free-molecular and hyperthermal: CD = 2; no side force, no moment."""
    panels = panels_of(sphere(60, 120))
    way = directions_of(np.radians([0.0, 35.0, -140.0]), np.radians([0.0, 50.0, -20.0]))
    newton, wet, rare = integrals(panels, way, UNIT)
    for values, drag in ((2.0 * newton, 1.0), (wet, 1.0), (rare, 2.0)):
        assert -np.einsum("ij,ij->i", values[:, :3], way) == pytest.approx(np.full(3, drag), rel=2e-3)
        assert np.linalg.norm(np.cross(values[:, :3], way), axis=1) == pytest.approx(np.zeros(3), abs=4e-3)
        assert values[:, 3:] == pytest.approx(np.zeros((3, 3)), abs=2e-3)


def test_error_falls_with_the_square_of_the_panels():
    errors = []
    for parts in (15, 30, 60):
        newton = integrals(panels_of(sphere(parts, 2 * parts)), np.array([[1.0, 0.0, 0.0]]), UNIT)[0]
        errors.append(abs(-2.0 * newton[0, 0] - 1.0))
    assert 3.5 < errors[0] / errors[1] < 4.5 and 3.5 < errors[1] / errors[2] < 4.5


def test_mesh_of_a_capsule_is_the_integral_over_its_rings():
    capsule = CapsuleParams(shoulder_radius_m=0.0)
    nose, cone = 0.85, radians(70.0)
    arc = [(-nose * (1.0 - sin(e)), nose * cos(e)) for e in np.linspace(0.5 * pi, cone, 40)]
    x_s = arc[-1][0] - (1.7 - arc[-1][1]) / np.tan(cone)
    x_b = x_s - (1.7 - 1.0) / np.tan(radians(30.0))
    profile = [*arc, (x_s, 1.7), (x_b, 1.0), (x_b - 0.55 / np.tan(radians(40.0)), 0.45)]
    x_ref = -0.253 * 3.4
    to = References(pi * 1.7**2, np.full(3, 3.4), np.array([x_ref, 0.0, 0.0]))
    rings, panels = capsule_rings(capsule), panels_of(revolved(profile, 240))
    for degree in (0.0, 8.0, 40.0, 120.0):
        way = directions_of(radians(degree), 0.0)[None]
        newton, wet, rare = (row[0] for row in integrals(panels, way, to))
        own, thin = (row[0] for row in surface_integrals(rings, np.radians([degree]), 3.4, x_ref))
        seen = windward_integrals(rings, np.radians([degree]), 3.4, x_ref)[0]
        for mesh, ring in ((newton, own), (wet, seen), (rare, thin)):
            assert (-mesh[0], -mesh[2], mesh[4]) == pytest.approx(tuple(ring), abs=4e-3)


def test_box_broadside_and_on_edge():
    """Cp_max 1 on a face: its area; on an edge at 45 deg: half of each of two faces."""
    panels = panels_of(box(2.0, 1.0, 1.0))
    to = References(1.0, np.ones(3), np.array([0.5, 0.0, 0.0]))
    face, edge = integrals(panels, np.array([[1.0, 0.0, 0.0], [0.0, sin(pi / 4), cos(pi / 4)]]), to)[0]
    assert face == pytest.approx([-1.0, 0.0, 0.0, 0.0, 0.0, 0.0], abs=1e-12)
    # the force acts through the middle of the box, half a metre behind the reference point
    assert edge == pytest.approx([0.0, -1.0, -1.0, 0.0, -0.5, 0.5], abs=1e-12)


def test_slopes_of_a_mesh_are_those_of_the_closed_form():
    """Sharp cone: CN_alpha = Cp_max cos^2 d at zero angle, by differences of the mesh's coefficients."""
    panels, d, h = panels_of(revolved([(0.0, 0.0), (-1.0, 1.0)], 360)), radians(45.0), radians(0.5)
    to = References(pi, np.full(3, 2.0), np.zeros(3))
    low, high = integrals(panels, directions_of(np.array([-h, h]), 0.0), to)[0]
    assert -(high[2] - low[2]) / (2 * h) == pytest.approx(cos(d) ** 2, rel=1e-3)


def flown(path, vel, mach=5.0, rho=DENSE, rates=(0.0, 0.0, 0.0), **more):
    params = AeroParams(model="body", body=BodyAeroParams(file=str(path), **more))
    aero = np.zeros(1, AERO)
    fill(aero[0], params)
    table = build_body_table(body_inputs(params.body, 1.33, sheds=False))
    return np.array(
        body_aero(
            aero.view(np.recarray)[0],
            table.view(np.recarray)[0],
            (gas_record(), 1.0, mach, rho),
            tuple(vel),
            rates,
        )
    )


def test_table_in_flight_is_the_integral_bridged_to_thin_air(tmp_path):
    path = write_stl(tmp_path / "box.stl", box(2.0, 1.0, 0.6))
    more = {"reference_area_m2": 0.6, "chord_m": 2.0, "span_m": 1.0, "moment_reference_m": (0.2, 0.1, -0.1)}
    panels = panels_of(read_triangles(path))
    to = References(0.6, np.array([1.0, 2.0, 1.0]), np.array([0.2, 0.1, -0.1]))
    alpha, beta = radians(4.5), radians(-9.0)  # nodes of the table
    way = directions_of(alpha, beta)
    newton, wet, rare = (row[0] for row in integrals(panels, way[None], to))
    dense = continuum(newton, wet, np.array([5.0]), 1.33)[0]
    for rho, expected in ((DENSE, dense), (RARE, rare)):
        force = expected[:3] * 0.6
        moment = expected[3:] * to.lengths * 0.6
        # in flight about (0.2, 0, 0): shifted by (0, 0.1, -0.1)
        moment = moment + np.cross([0.0, 0.1, -0.1], force)
        got = flown(path, way, rho=rho, **more)
        assert got == pytest.approx(np.concatenate((force, moment)), abs=1e-9)


def test_rates_damp_and_factors_multiply(tmp_path):
    path = write_stl(tmp_path / "ball.stl", sphere(12, 24))
    still = flown(path, (300.0, 0.0, 0.0))
    turning = flown(
        path, (300.0, 0.0, 0.0), rates=(1.0, 2.0, 3.0), roll_damping=-0.1, pitch_damping=-0.2,
        yaw_damping=-0.3, chord_m=2.0, span_m=4.0, damping_factor=2.0, axial_factor=1.1,
    )  # fmt: skip
    assert turning[0] == pytest.approx(1.1 * still[0] * 1.0)
    damping = np.array([4.0 * -0.1 * 4.0 * 1.0, 2.0 * -0.2 * 2.0 * 2.0, 4.0 * -0.3 * 4.0 * 3.0]) / 300.0
    assert turning[3:] - still[3:] == pytest.approx(damping, rel=1e-6)


def test_place_of_a_mesh_and_its_kinds(tmp_path):
    corners = box(2.0, 1.0, 0.6)
    files = (
        write_stl(tmp_path / "a.stl", corners),
        write_text_stl(tmp_path / "b.stl", corners),
        write_glb(tmp_path / "c.glb", corners),
    )
    for path in files:
        assert read_triangles(path) == pytest.approx(corners, abs=1e-6)
        placed = placed_corners(
            BodyAeroParams(
                file=str(path),
                mesh_scale=2.0,
                mesh_origin_m=(1.0, 0.0, 0.0),
                mesh_yaw_pitch_roll_deg=(90.0, 0.0, 0.0),
            )
        )
        # x of the file lies along y of B
        assert placed == pytest.approx(2.0 * corners[..., [1, 0, 2]] * [-1, 1, 1] + [1.0, 0.0, 0.0], abs=1e-6)


def test_convexity_is_told():
    capped = revolved([(0.0, 0.5), (-0.5, 1.0), (-1.0, 0.5)], 90)
    assert hull_share(panels_of(capped), capped) == pytest.approx(1.0, abs=1e-9)
    waist = revolved([(0.0, 1.0), (-0.5, 0.5), (-1.0, 1.0)], 90)
    assert hull_share(panels_of(waist), waist) < 0.7


@pytest.mark.parametrize(
    "corners, words",
    [
        (box(1.0, 1.0, 1.0)[:-1], "not closed"),
        (np.concatenate((box(1.0, 1.0, 1.0)[:6], box(1.0, 1.0, 1.0)[6:, ::-1])), "do not all turn one way"),
        (np.zeros((4, 3, 3)), "not closed"),
        (box(1.0, 1.0, 1.0)[:3], "has 3 triangles"),
        (np.full((6, 3, 3), np.nan), "not finite"),
    ],
)
def test_meshes_that_cannot_be_flown_are_refused(tmp_path, corners, words):
    path = write_stl(tmp_path / "bad.stl", corners)
    with pytest.raises(ValueError, match=words):
        panels_of(read_triangles(path))


def test_inside_out_is_turned(tmp_path):
    panels = panels_of(box(1.0, 1.0, 1.0)[:, ::-1])
    assert np.einsum("ij,ij->i", panels.centre, panels.normal).min() > 0.0


def test_no_file_is_asked_for():
    with pytest.raises(ValueError, match="required key is missing"):
        body_inputs(BodyAeroParams(), 1.4, sheds=False)


def test_stagnation_pressure_of_a_mesh_is_that_of_a_capsule():
    one = np.array([[-1.0, 0.0, 0.0, 0.0, 0.0, 0.0]])
    assert -continuum(one, 0.0 * one, np.array([8.0]), 1.3)[0, 0, 0] == pytest.approx(
        float(stagnation_pressure_coefficient(np.array([8.0]), 1.3)[0])
    )
