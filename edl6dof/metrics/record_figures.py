"""Figures from the last records of a flight: first ground contact, ground under the vehicle, choice of hazard
detection, and balance of energy, momentum and mass.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import isfinite, pi, sqrt

import numpy as np

from edl6dof.config.units import DEG
from edl6dof.environment.gravity import potential_F
from edl6dof.environment.landing_area.population import HEIGHT, within
from edl6dof.environment.landing_area.relief import GENERATED
from edl6dof.environment.terrain import place_of
from edl6dof.fsw.control.attitude_error import decoupled_error, goal_attitude
from edl6dof.fsw.hazard.elevation_map import SAFE
from edl6dof.interface.roles import HOVER_IMAGING, begun
from edl6dof.kernels import kernel
from edl6dof.metrics.figures import from_si
from edl6dof.spatial.arrays import lengths
from edl6dof.spatial.elementary import acos, atan, atan2, cos, hypot, sin
from edl6dof.spatial.frames import fixed_to_ned, geodetic, ned_to_fixed, rotate_z, to_local
from edl6dof.spatial.quaternion import axes, from_frame
from edl6dof.spatial.table_index import endless_cell
from edl6dof.spatial.vector import add, clamp, dot, norm, sub, take3
from edl6dof.telemetry.columns import Telemetry
from edl6dof.vehicle.landing_gear import contact_point, ground_at_offset, north_east_of
from edl6dof.vehicle.motion.balance import vehicle_mass
from edl6dof.vehicle.plant import POSITION, RATE, VELOCITY, take_attitude
from edl6dof.vehicle.surroundings import planet_rotation

#: Radius of the footprint of the lander, and smallest diameter of rocks that are counted (half as high), m.
FOOTPRINT, COUNTED = sqrt(12.6 / pi), 0.5
#: Seconds after ignition from which backshell and lander count as parted.
PARTED_S = 5.0


def touchdown_state(cases: np.ndarray, plants: np.ndarray) -> dict[str, float]:
    """Velocity, attitude errors, rates and place at the located first contact; empty without one.

    Attitude errors are those of S1: roll to the local geographic frame (y of B south), pitch and yaw of the
    thrust axis from the vertical, as a rotation vector in B.

    Args:
        cases: true parameters of the flight (``CASE``), shape (1,).
        plants: state of its plant, shape (1,).
    """
    if not isfinite(plants["touchdown_time"][0]):
        return {}
    return from_si("contact", _contact(cases, plants))


@kernel
def _contact(cases, plants):
    """The figures of contact in their order, SI."""
    case, plant = cases[0], plants[0]
    t, y, planet = plant.touchdown_time, plant.touchdown, case.planet
    spin = planet.rotation_rate
    c, s = cos(spin * t), sin(spin * t)
    r, v, w = take3(y, POSITION), take3(y, VELOCITY), take3(y, RATE)
    q = take_attitude(y)
    r_F = rotate_z(c, s, r)
    sl, cl, so, co, _ = geodetic(planet.equatorial_radius, planet.flattening, r_F)
    north, east, down = fixed_to_ned(
        sl, cl, so, co, rotate_z(c, s, (v[0] + spin * r[1], v[1] - spin * r[0], v[2]))
    )
    north_I = rotate_z(c, -s, ned_to_fixed(sl, cl, so, co, (1.0, 0.0, 0.0)))
    east_I = rotate_z(c, -s, ned_to_fixed(sl, cl, so, co, (0.0, 1.0, 0.0)))
    up_I = rotate_z(c, -s, ned_to_fixed(sl, cl, so, co, (0.0, 0.0, -1.0)))
    error = decoupled_error(q, goal_attitude(north_I, east_I, up_I, up_I))
    forward, _, _ = axes(q)
    site = to_local(case.site, r_F)
    return (
        t, down, hypot(north, east),
        error[0], error[1], error[2], acos(clamp(-dot(forward, up_I), -1.0, 1.0)),
        w[0], w[1], w[2], norm(w),
        atan2(hypot(plant.inputs.ground_slope[0], plant.inputs.ground_slope[1]), 1.0),
        atan2(sl, cl), atan2(so, co),
        site[0], site[1], hypot(site[0], site[1]),
    )  # fmt: skip


def touchdown_terrain_figures(
    cases: np.ndarray, tables: np.ndarray, plants: np.ndarray, outputs: np.ndarray
) -> dict[str, float]:
    """Figures of the ground under a landed vehicle; empty without a generated landing area or extended legs.
    All arguments have shape (1,).
    """
    case, plant = cases[0], plants[0]
    generated = case["terrain"]["landing_area"]["model"] == GENERATED
    gear = case["vehicle"]["landing_gear"]
    if not (generated and isfinite(plant["touchdown_time"]) and plant["legs"] and gear["n_footpads"] >= 3):
        return {}
    slope, values = _footing(cases, tables, plants, outputs)
    figures = {"touchdown_slope_deg": slope * (1.0 / DEG), **from_si("footing", values)}
    if gear["n_underside"] == 0:
        del figures["ground_under_belly_m"], figures["belly_clearance_m"]
    return figures


@kernel
def _footing(cases, tables, plants, outputs):
    case, plant, out = cases[0], plants[0], outputs[0]
    terrain, rotation = case.terrain, planet_rotation(case.planet, plant.t)
    q = take_attitude(plant.y)
    north, east = place_of(terrain, out.latitude, out.longitude)
    rocks, _ = within(terrain.landing_area.rocks, north, east, FOOTPRINT, COUNTED)
    _, largest = within(terrain.landing_area.rocks, north, east, FOOTPRINT, 0.0)
    plane = plane_of_footpads(case, tables[0], out, q, rotation)
    reach, clearance = under_belly(case, tables=tables[0], outputs=out, q=q, rotation=rotation, plane=plane)
    return atan(hypot(plane[1], plane[2])), (float(rocks), largest, HEIGHT * largest, reach, clearance)


@kernel
def plane_of_footpads(case, tables, outputs, q, rotation):
    """Plane through the ground under the footpads by least squares: elevation (m) below the centre of mass,
    and rise per metre towards north and east.
    """
    gear, n = case.vehicle.landing_gear, float(case.vehicle.landing_gear.n_footpads)
    sy = sx = sz = syy = syx = sxx = syz = sxz = 0.0
    for k in range(gear.n_footpads):
        arm = sub(contact_point(gear, k), take3(outputs.centre, 0))
        y, x = north_east_of(outputs, q, rotation, arm)
        z = ground_at_offset(case, tables, outputs, y, x)[0]
        sy, sx, sz = sy + y, sx + x, sz + z
        syy, syx, sxx = syy + y * y, syx + y * x, sxx + x * x
        syz, sxz = syz + y * z, sxz + x * z
    yy, yx, xx = syy - sy * sy / n, syx - sy * sx / n, sxx - sx * sx / n
    yz, xz = syz - sy * sz / n, sxz - sx * sz / n
    inverse = 1.0 / (yy * xx - yx * yx)
    north, east = (xx * yz - yx * xz) * inverse, (yy * xz - yx * yz) * inverse
    return (sz - north * sy - east * sx) / n, north, east


@kernel
def under_belly(case, tables, outputs, q, rotation, plane):
    """Largest rise of the ground above the ``plane`` of the footpads and least distance from the underside
    (m), below the underside at the nodes of the lattice and along its edge.
    """
    gear, out, step = case.vehicle.landing_gear, outputs, case.terrain.landing_area.cell
    lowest, radius = -1e9, 0.0
    for k in range(gear.n_underside):
        point = gear.underside[k]
        lowest, radius = max(lowest, point[0]), max(radius, hypot(point[1], point[2]))
    centre = take3(out.centre, 0)
    middle = _in_N(out, q, rotation, (lowest - centre[0], -centre[1], -centre[2]))
    along = _in_N(out, q, rotation, (1.0, 0.0, 0.0))
    reach, clearance = -1e9, 1e9
    north, east = place_of(case.terrain, out.latitude, out.longitude)
    first, left = (
        endless_cell((north + middle[0] - radius) / step),
        endless_cell((east + middle[1] - radius) / step),
    )
    count = endless_cell(2.0 * radius / step) + 2
    for i in range(first, first + count):
        for j in range(left, left + count):
            y, x = i * step - north, j * step - east
            if (y - middle[0]) ** 2 + (x - middle[1]) ** 2 <= radius * radius:
                rise, left_over = _below(case, tables, out, plane, middle, along=along, y=y, x=x)
                reach, clearance = max(reach, rise), min(clearance, left_over)
    around = endless_cell(2.0 * pi * radius / step) + 1
    for k in range(around):
        angle = 2.0 * pi * k / around
        y, x = middle[0] + radius * cos(angle), middle[1] + radius * sin(angle)
        rise, left_over = _below(case, tables, out, plane, middle, along=along, y=y, x=x)
        reach, clearance = max(reach, rise), min(clearance, left_over)
    return reach, clearance


@kernel
def _below(case, tables, out, plane, middle, along, y, x):
    """Rise of the ground above the ``plane`` of the footpads and its distance from the underside (m), at a
    place (m north and east of the centre of mass).
    """
    elevation = ground_at_offset(case, tables, out, y, x)[0]
    down = middle[2] - dot(along, (y - middle[0], x - middle[1], 0.0)) / along[2]
    rise = elevation - plane[0] - plane[1] * y - plane[2] * x
    return rise, out.height - down - (elevation - out.elevation)


@kernel
def _in_N(outputs, q, rotation, v_B):
    """A vector of B in north, east, down."""
    out, v_F = outputs, rotate_z(rotation[0], rotation[1], from_frame(q, v_B))
    return fixed_to_ned(out.sin_lat, out.cos_lat, out.sin_lon, out.cos_lon, v_F)


def hazard_figures(
    case: np.ndarray, fsw: np.void, telemetry: Telemetry, landing: dict[str, float]
) -> dict[str, float]:
    """Return figures of the coarse and of the fine choice of a landing spot, as far as these were made.

    Args:
        case: true parameters of the flight (``CASE``), shape (1,).
        fsw: final memory of the flight software.
        telemetry: its rows.
        landing: figures of the touchdown.
    """
    figures: dict[str, float] = {}
    hazard, chosen = fsw["hazard"], fsw["landing_point"]["fine_L"]
    if np.isfinite(hazard["image_t"]):
        coarse = hazard["coarse"]
        figures["coarse_parts"] = float(coarse["parts"])
        figures["coarse_obstacles"] = float(coarse["obstacles"][coarse["part"]])
        figures["coarse_clear_m"] = float(coarse["clear"][coarse["part"]])
    if np.isfinite(hazard["site_t"]):
        site, displaced = fsw["landing_point"]["coarse_L"], _map_displacement(case)
        east, north = (float(telemetry[f"truth.site_{axis}_m"][-1]) for axis in ("east", "north"))
        # the map shows the site at its true place plus the displacement
        off = east - float(site[0] - displaced[1]), north - float(site[1] - displaced[0])
        figures["site_miss_m"] = hypot(*off)
    # a flight continued from a saved state has no telemetry of the time before
    if not (np.isfinite(hazard["spot_t"]) and hazard["scan_t"] >= telemetry["t_s"][0]):
        return figures
    error = telemetry.at(float(hazard["scan_t"]), "nav.error_east_m", "nav.error_north_m")
    east, north = float(chosen[0]) - error[0], float(chosen[1]) - error[1]  # true place, m from the site
    choice, cell_class = hazard["choice"], hazard["safety_map"]["cell_class"]
    figures["spot_found"] = float(choice["found"])
    figures["spot_clearance_m"] = float(choice["clearance"])
    figures["spots_rejected"] = float(choice["n_rejected"])
    figures["map_safe_share"] = float(np.mean(cell_class == SAFE))
    if case["terrain"]["landing_area"]["model"][0] == GENERATED:
        up = float(telemetry["truth.site_up_m"][-1])
        largest = _largest_rock(case, east, north, up)
        figures["spot_largest_rock_m"] = largest
        figures["spot_false_safe"] = float(bool(choice["found"]) and largest >= COUNTED)
    if "landing_east_m" in landing:
        figures["spot_miss_m"] = hypot(landing["landing_east_m"] - east, landing["landing_north_m"] - north)
    return figures


def _map_displacement(case: np.ndarray) -> np.ndarray:
    """Displacement of the map of landmarks (m north, east, down), shape (3,); zero without such a map."""
    return np.asarray(case["sensors"]["unit"]["landmark_camera"]["offset"][0])


@kernel
def _largest_rock(cases, east, north, up):
    """Diameter (m) of the largest rock centred under the footprint about a place (m); 0 for none."""
    site, planet, terrain = cases[0].site, cases[0].planet, cases[0].terrain
    off = ned_to_fixed(site.sin_lat, site.cos_lat, site.sin_lon, site.cos_lon, (north, east, -up))
    r_F = add(take3(site.origin_F, 0), off)
    sl, cl, so, co, _ = geodetic(planet.equatorial_radius, planet.flattening, r_F)
    y, x = place_of(terrain, atan2(sl, cl), atan2(so, co))
    _, largest = within(terrain.landing_area.rocks, y, x, FOOTPRINT, 0.0)
    return largest


def drift_figures(
    telemetry: Mapping[str, np.ndarray], when: Mapping[str, float], line_m: float
) -> dict[str, float]:
    """Least distance (m) of the lander from backshell and canopy after the separation; and, from hover on,
    least horizontal distance (m) from those of them that are above the lander.

    The canopy is the point ``line_m`` above the backshell.  Both move on straight lines between two rows.

    Args:
        telemetry: channels of a flight.
        when: time (s) of its events by key.
        line_m: from the backshell to the canopy, m.
    """
    if "ignition" not in when or "backshell" not in when:
        return {}
    t = telemetry["t_s"]
    last = t <= when.get("touchdown", np.inf)
    off = np.column_stack(
        [
            telemetry[f"truth.backshell_{axis}_m"] - telemetry[f"truth.site_{axis}_m"]
            for axis in ("east", "north", "up")
        ]
    )
    parted = last & (t >= when["ignition"] + PARTED_S)
    figures = {}
    if np.count_nonzero(parted) > 1:
        figures["min_drift_distance_m"] = min(
            least_length(off[parted] + (0.0, 0.0, h)) for h in (0.0, line_m)
        )
    hovering = last & (t >= when.get(begun(HOVER_IMAGING), np.inf)) & (off[:, 2] + line_m > 0.0)
    if np.count_nonzero(hovering) > 1:
        figures["min_overhead_m"] = least_length(off[hovering, :2])
    return figures


def least_length(way: np.ndarray) -> float:
    """Least length of a vector that moves on straight lines between the rows of ``way``."""
    start, step = way[:-1], np.diff(way, axis=0)
    share = -np.sum(start * step, axis=1) / np.maximum(np.sum(step * step, axis=1), 1e-30)
    return float(np.min(lengths(start + np.clip(share, 0.0, 1.0)[:, None] * step)))


def balance_figures(cases: np.ndarray, plants: np.ndarray) -> dict[str, float]:
    """Errors of the balance of energy, of momentum, also at separations alone, and of mass.

    Args:
        cases: true parameters of the flight (``CASE``), shape (1,).
        plants: state of its plant, shape (1,).
    """
    return from_si("balance", _balance_errors(cases, plants))


@kernel
def _potential(planet, t, r_I):
    """Potential of gravitation (J/kg) at ``r_I`` (m) and time ``t`` (s)."""
    c, s = planet_rotation(planet, t)
    return potential_F(planet.gravity, rotate_z(c, s, r_I))


@kernel
def _balance_errors(cases, plants):
    """Errors of energy, momentum, separations and mass.  Energy counts from rest in I at the equator of the
    ellipsoid; its error is a share of the energy at the start or of the work since, whichever is larger.  The
    error of mass is a share of the mass at the start.
    """
    case, plant, kept, planet = cases[0], plants[0], plants[0].balance, cases[0].planet
    v, v_start = take3(plant.y, VELOCITY), take3(kept.v_I, 0)
    momentum = norm(sub(sub(v, v_start), take3(kept.velocity, 0)))
    start = _potential(planet, 0.0, take3(kept.r_I, 0))
    end = _potential(planet, plant.t, take3(plant.y, POSITION))
    ground = _potential(planet, 0.0, (planet.equatorial_radius, 0.0, 0.0))
    kinetic, kinetic_start = 0.5 * dot(v, v), 0.5 * dot(v_start, v_start)
    energy = (kinetic - end) - (kinetic_start - start) - kept.work
    whole = max(kinetic_start + abs(ground - start), abs(kept.work))
    share = abs(energy) / whole if whole > 0.0 else 0.0
    mass = vehicle_mass(case, plant) + kept.lost - kept.mass
    return share, momentum, kept.separations, abs(mass) / kept.mass
