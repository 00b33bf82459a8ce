"""Landing gear: footpads on springs and dampers with Coulomb friction, each on a plane of the ground under
it, and rest; points of the underside have the same contact forces.

The planes are set once a step.  Each contains the ground vertically below its point, and is stored as its
altitude below the centre of mass and its rise per metre north and east.  A rocking vehicle stands still for
an instant at each end of its swing, so rest needs a time without motion.
"""

from __future__ import annotations

from math import radians, sqrt
from typing import Annotated

from edl6dof.config.base import Capacity, Hardware, Vec3, param
from edl6dof.config.dtype import dtype_of
from edl6dof.environment.landing_area.relief import GENERATED
from edl6dof.environment.terrain import ground
from edl6dof.interface.capacities import MAX_FOOTPADS
from edl6dof.kernels import kernel
from edl6dof.spatial.frames import fixed_to_ned, ned_to_fixed, rotate_z
from edl6dof.spatial.quaternion import from_frame, to_frame
from edl6dof.spatial.vector import add, cross, norm, sub, take3
from edl6dof.vehicle.plant import POSITION, RATE, VELOCITY


class LandingGearParams(Hardware):
    """Legs that end in footpads; each presses along the ground's normal."""

    footpads_m: Annotated[list[Vec3], Capacity(MAX_FOOTPADS)] = param(
        None, "footpad positions in B with the legs out", factory=list, max_length=MAX_FOOTPADS
    )
    underside_m: Annotated[list[Vec3], Capacity(MAX_FOOTPADS)] = param(
        None,
        "points of the underside in B that a rock may reach: its corners, the nozzle",
        factory=list,
        max_length=MAX_FOOTPADS,
    )
    stiffness_n_m: float = param(
        60000.0, "spring constant of a leg, or of a point of the underside", status="estimate", gt=0.0
    )
    damping_n_s_m: float = param(
        6000.0, "damping of one leg in contact with the ground", status="estimate", ge=0.0
    )
    friction: float = param(
        0.6,
        "Coulomb friction coefficient of a footpad on the soil",
        status="estimate",
        ge=0.0,
        le=2.0,
        usual=(0.05, 1.5, "ice to rough rock"),
    )
    slip_speed_m_s: float = param(0.05, "slip speed over which friction builds up smoothly", gt=0.0)


LANDING_GEAR = dtype_of(LandingGearParams)


@kernel
def leg_force(gear, depth, v_normal, v_slip):
    """Force of one leg along the outward normal (N), and friction over slip velocity (N s/m), at a ``depth``
    (m) below the ground; ``v_normal`` (outwards) and ``v_slip`` (along the ground) in m/s.
    """
    if depth <= 0.0:
        return 0.0, 0.0
    # the ground pushes but never pulls
    normal = max(gear.stiffness * depth - gear.damping * v_normal, 0.0)
    return normal, -gear.friction * normal / sqrt(v_slip * v_slip + gear.slip_speed * gear.slip_speed)


@kernel
def contact(gear, point, centre, plane, motion):
    """Ground reaction on a point of the vehicle: force and moment about the origin of B (two tuples), and
    True if the point touches the ground.

    Args:
        gear: landing-gear record.
        point: the point in B, m.
        centre: centre of mass in B, m.
        plane: of the ground under the point: outward normal in B, and height of the centre of mass above the
            plane along the normal, m.
        motion: relative to the ground, in B: velocity of the centre of mass, m/s, and body rate, rad/s.
    """
    (up_B, clearance), (v_B, w_B) = plane, motion
    arm = (point[0] - centre[0], point[1] - centre[1], point[2] - centre[2])
    depth = -(clearance + arm[0] * up_B[0] + arm[1] * up_B[1] + arm[2] * up_B[2])
    if depth <= 0.0:
        return (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), False
    spin = cross(w_B, arm)
    vx, vy, vz = v_B[0] + spin[0], v_B[1] + spin[1], v_B[2] + spin[2]
    vn = vx * up_B[0] + vy * up_B[1] + vz * up_B[2]
    sx, sy, sz = vx - vn * up_B[0], vy - vn * up_B[1], vz - vn * up_B[2]
    normal, drag = leg_force(gear, depth, vn, sqrt(sx * sx + sy * sy + sz * sz))
    force = (normal * up_B[0] + drag * sx, normal * up_B[1] + drag * sy, normal * up_B[2] + drag * sz)
    return force, cross(point, force), True


@kernel
def contacts(gear):
    """Number of points that can meet the ground: the footpads, then those of the underside."""
    return gear.n_footpads + gear.n_underside


@kernel
def contact_point(gear, k):
    """Point ``k`` of those that can meet the ground, in B, m."""
    if k < gear.n_footpads:
        p = gear.footpads[k]
    else:
        p = gear.underside[k - gear.n_footpads]
    return p[0], p[1], p[2]


#: Speed (m/s) over the ground and body rate (rad/s) of a vehicle at rest.  Friction that is smooth in speed
#: lets a vehicle on a slope creep by up to 0.01 m/s.
REST_SPEED, REST_RATE = 0.05, radians(1.0)


@kernel
def ground_speed(spin, y):
    """Speed (m/s) in the state ``y``, relative to a planet that spins at ``spin`` (rad/s)."""
    r, v = take3(y, POSITION), take3(y, VELOCITY)
    return norm((v[0] + spin * r[1], v[1] - spin * r[0], v[2]))


@kernel
def note_motion(case, plant):
    """Set ``plant.moved_time`` to the present time if the vehicle moves relative to the ground."""
    y = plant.y
    if ground_speed(case.planet.rotation_rate, y) > REST_SPEED or norm(take3(y, RATE)) > REST_RATE:
        plant.moved_time = plant.t


#: Height (m) of the centre of mass above the ground below which each point has its own plane.
NEAR = 5.0


@kernel
def lay_ground_planes(case, tables, plant, outputs, q, rotation, areoid):
    """Set the planes of the ground under the points of the landing gear; ``areoid``: rise of the areoid per
    metre towards north and east.
    """
    gear, inputs, out = case.vehicle.landing_gear, plant.inputs, outputs
    own = case.terrain.landing_area.model == GENERATED and plant.legs != 0 and out.height < NEAR
    for k in range(contacts(gear)):
        plane = inputs.footing[k]
        plane[0], plane[1], plane[2] = inputs.ground_altitude, inputs.ground_slope[0], inputs.ground_slope[1]
        if own:
            arm = sub(contact_point(gear, k), take3(out.centre, 0))
            to_north, to_east = north_east_of(out, q, rotation, arm)
            height, rise_north, rise_east = ground_at_offset(case, tables, out, to_north, to_east)
            plane[1], plane[2] = areoid[0] + rise_north, areoid[1] + rise_east
            plane[0] += height - out.elevation - rise_north * to_north - rise_east * to_east


@kernel
def north_east_of(outputs, q, rotation, arm):
    """Metres towards north and east of the end of an ``arm`` (m, B) from the centre of mass."""
    out = outputs
    arm_F = rotate_z(rotation[0], rotation[1], from_frame(q, arm))
    north, east, _ = fixed_to_ned(out.sin_lat, out.cos_lat, out.sin_lon, out.cos_lon, arm_F)
    return north, east


@kernel
def ground_at_offset(case, tables, outputs, north, east):
    """Elevation (m) and rise per metre of the ground at an offset (m) from the place in ``outputs``."""
    terrain = case.terrain
    lat = outputs.latitude + north / terrain.metres_north
    return ground(terrain, tables.terrain, lat, outputs.longitude + east / terrain.metres_east)


@kernel
def normal_of(place, q, rotation, rise_north, rise_east):
    """Upward normal in B of a plane with a given rise per metre, and the cosine of its slope."""
    inverse = 1.0 / sqrt(1.0 + rise_north * rise_north + rise_east * rise_east)
    normal_N = (-rise_north * inverse, -rise_east * inverse, -inverse)
    normal_F = ned_to_fixed(place[0], place[1], place[2], place[3], normal_N)
    return to_frame(q, rotate_z(rotation[0], -rotation[1], normal_F)), inverse


@kernel
def minimum_clearance(case, inputs, centre, q, rotation, place, altitude):
    """Smallest distance (m) of a gear point, or of the centre of mass, from the plane under it."""
    gear = case.vehicle.landing_gear
    _, inverse = normal_of(place, q, rotation, inputs.ground_slope[0], inputs.ground_slope[1])
    least = (altitude - inputs.ground_altitude) * inverse
    for k in range(contacts(gear)):
        plane, arm = inputs.footing[k], sub(contact_point(gear, k), centre)
        up, inverse = normal_of(place, q, rotation, plane[1], plane[2])
        reach = arm[0] * up[0] + arm[1] * up[1] + arm[2] * up[2]
        least = min(least, (altitude - plane[0]) * inverse + reach)
    return least


@kernel
def ground_loads(case, inputs, y, q, w, centre, rotation, place):
    """Force and moment about the centre of mass (B) of the ground, and the number of footpads on it."""
    spin = case.planet.rotation_rate
    gear, altitude = case.vehicle.landing_gear, place[4]
    r_I, v_I = take3(y, POSITION), take3(y, VELOCITY)
    v_ground = to_frame(q, sub(v_I, (-spin * r_I[1], spin * r_I[0], 0.0)))
    w_ground = sub(w, to_frame(q, (0.0, 0.0, spin)))
    force = moment = (0.0, 0.0, 0.0)
    pads = 0
    for k in range(contacts(gear)):
        plane = inputs.footing[k]
        up, inverse = normal_of(place, q, rotation, plane[1], plane[2])
        clearance = (altitude - plane[0]) * inverse
        push, turning, touches = contact(
            gear, contact_point(gear, k), centre, (up, clearance), (v_ground, w_ground)
        )
        force, moment = add(force, push), add(moment, turning)
        if touches and k < gear.n_footpads:
            pads += 1
    return force, sub(moment, cross(centre, force)), pads
