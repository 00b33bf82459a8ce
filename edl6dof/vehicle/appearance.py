"""How the vehicle looks in pictures; no flight depends on it."""

from __future__ import annotations

from typing import Literal

from edl6dof.config.base import REQUIRED, Hardware, Key, Vec3, param

#: The body of the entry vehicle, and what is inside it; ``derived`` follows from the rest of the file.
BodyShape = Literal["derived", "sphere_cone", "sphere", "box", "none"]
LanderKind = Literal["derived", "legs", "platform", "rover", "none"]


class MeshFileParams(Hardware):
    """A mesh of the user's own, drawn in place of a shape."""

    file: str = param(
        REQUIRED,
        "glTF 2.0 (.glb, or .gltf with all inside) or STL (.stl), relative to the file that names it",
        record=False,
        min_length=1,
    )
    part: Key | None = param(
        None, "part that it shows and leaves with; none: all that is not a part", record=False
    )
    scale: float = param(1.0, "metres per unit of the file", record=False, gt=0.0, le=1e4)
    origin_m: Vec3 = param((0.0, 0.0, 0.0), "where the origin of the file lies in B", record=False)
    yaw_pitch_roll_deg: Vec3 = param(
        (0.0, 0.0, 0.0), "turns about z, y, x that carry B into the axes of the file", record=False
    )


class VehicleAppearanceParams(Hardware):
    """Shapes as pictures show them; what is left out follows from mass, aerodynamics and landing gear."""

    body: BodyShape = param(
        "derived",
        "what flies at entry; derived: of aero.model capsule its sphere-cone; else none of a lander that "
        "nothing covers, a sphere where the moments of inertia are equal, a sphere-cone where two are, a box",
        record=False,
    )
    nose_x_m: float = param(0.0, "station of the nose of a sphere-cone in B", record=False)
    diameter_m: float | None = param(
        None, "largest diameter; none: of the aerodynamics' capsule or area", record=False, gt=0.0
    )
    nose_radius_m: float | None = param(
        None, "radius of the nose; none: of the capsule, or vehicle.nose_radius_m", record=False, gt=0.0
    )
    shoulder_radius_m: float | None = param(
        None, "radius of the shoulder; none: of the capsule, or D/40", record=False, ge=0.0
    )
    cone_half_angle_deg: float | None = param(
        None, "half angle of the forebody; none: of the capsule, or 70", record=False, gt=10.0, lt=90.0
    )
    backshell_m: list[tuple[float, float]] = param(
        None,
        "corners of the afterbody: distance behind the shoulder, and radius; none: the capsule's two cones, "
        "or flat",
        record=False,
        factory=list,
        max_length=20,
    )
    size_m: Vec3 | None = param(
        None, "sides of a box along x, y, z; none: of one solid of the vehicle's inertia", record=False
    )
    lander: LanderKind = param(
        "derived",
        "what comes out of the aeroshell; derived: legs where there are footpads, else a platform where "
        "there are engines, else none",
        record=False,
    )
    meshes: list[MeshFileParams] = param(
        None, "meshes drawn in place of these shapes", record=False, factory=list, max_length=8
    )
