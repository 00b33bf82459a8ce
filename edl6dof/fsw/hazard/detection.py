"""Hazard detection in flight: sequence of the image at the start of powered descent and of the scan in hover,
with the choices that follow from them.
"""

from __future__ import annotations

from edl6dof.config.units import G0
from edl6dof.fsw.hazard.coarse_avoidance import COARSE, choose_part, follow_wind, predict_drifts
from edl6dof.fsw.hazard.elevation_map import (
    ELEVATION_MAP,
    FOOTPRINT,
    SAFETY_MAP,
    add_range,
    assess,
    begin_map,
    fill_holes,
)
from edl6dof.fsw.hazard.map_sites import choose_site
from edl6dof.fsw.hazard.site_selection import CHOICE, ENVELOPE, choose_spot, clearances, least_bad
from edl6dof.fsw.mission import G_AVOID, G_HOVER, G_POWERED
from edl6dof.interface.capacities import SCAN_BLOCK, SCAN_COLUMNS, SCAN_ROWS, STEREO_CELLS
from edl6dof.interface.sensed import cell_direction
from edl6dof.kernels import kernel
from edl6dof.records import FLAG, TIME_IF_EVER, record
from edl6dof.spatial.elementary import cos, sin
from edl6dof.spatial.frames import fixed_to_ned, rotate_z
from edl6dof.spatial.quaternion import from_frame
from edl6dof.spatial.vector import add, norm, put3, scale, sub, take3, take4

HAZARD = record(
    ("exposed", FLAG),  # the camera was triggered
    ("scanning", FLAG),  # the lidar was triggered
    ("site_t", TIME_IF_EVER),  # s, flight time: site of the map chosen
    ("image_t", TIME_IF_EVER),  # s, flight time: coarse choice made
    ("scan_t", TIME_IF_EVER),  # s: first block of the scan
    ("spot_t", TIME_IF_EVER),  # s: spot chosen
    ("here_L", "f8", (3,)),  # m: east, north, up of the site, of the vehicle when the scan began
    ("way_L", "f8", (3,)),  # m: way since, by integration of the velocity
    ("carried_N", "f8", (2,)),  # m/s: velocity under the parachute, smoothed
    ("coarse", COARSE),
    ("elevation_map", ELEVATION_MAP),
    ("footprint", FOOTPRINT),
    ("safety_map", SAFETY_MAP),
    ("envelope", ENVELOPE),
    ("choice", CHOICE),
)


@kernel
def to_site(frame, turn, v_I):
    """Rotate a vector from I to east, north, up of the landing site; ``turn``: cosine and sine of the angle
    of planet rotation.
    """
    v_F = rotate_z(turn[0], turn[1], v_I)
    north, east, down = fixed_to_ned(frame.sin_lat, frame.cos_lat, frame.sin_lon, frame.cos_lon, v_F)
    return east, north, -down


@kernel
def body_axes(planet, frame, nav):
    """Axes x, y, z of B, each as east, north, up of the landing site."""
    q = take4(nav.q_I2B)
    angle = planet.rotation_rate * nav.t
    turn = (cos(angle), sin(angle))
    return (
        to_site(frame, turn, from_frame(q, (1.0, 0.0, 0.0))),
        to_site(frame, turn, from_frame(q, (0.0, 1.0, 0.0))),
        to_site(frame, turn, from_frame(q, (0.0, 0.0, 1.0))),
    )


@kernel
def place_of_eye(eye, centre, memory, axes_L):
    """Position of a sensor (m, east, north, up of the landing site); ``centre``: centre of mass (m, B).

    Since the scan began the position follows the integral of the velocity: the navigated altitude jumps by
    metres with the terrain under the radar, and each jump would cause a step in the map.
    """
    arm = sub(take3(eye.place, 0), centre)
    off = add(scale(arm[0], axes_L[0]), add(scale(arm[1], axes_L[1]), scale(arm[2], axes_L[2])))
    return add(add(take3(memory.here_L, 0), take3(memory.way_L, 0)), off)


@kernel
def move(nav, dt, memory):
    """Add the way of a cycle of ``dt`` (s) to the way since the scan began."""
    north, east, down = take3(nav.v_N, 0)
    put3(memory.way_L, 0, add(take3(memory.way_L, 0), scale(dt, (east, north, -down))))


@kernel
def deviation_at(eye, distance):
    """Standard deviation (m) of a range at ``distance`` (m)."""
    return eye.sigma + eye.sigma_square * distance * distance


@kernel
def take_rows(eye, lidar, eye_L, axes_L, elevation_map):
    """Add the points of a block of the scan to the map."""
    for i in range(SCAN_BLOCK):
        for j in range(SCAN_COLUMNS):
            direction = cell_direction(eye.tangent, SCAN_COLUMNS, lidar.row + i, j)
            add_range(lidar.range[i, j], direction, eye_L, axes_L, weight=1.0, elevation_map=elevation_map)


@kernel
def take_pair(eye, stereo, sharp, eye_L, axes_L, elevation_map):
    """Add the points of a pair of images to the map; ``sharp``: standard deviation of a lidar point, m."""
    for i in range(STEREO_CELLS):
        for j in range(STEREO_CELLS):
            distance = stereo.range[i, j]
            blunt = max(deviation_at(eye, distance) / sharp, 1.001)
            direction = cell_direction(eye.tangent, STEREO_CELLS, i, j)
            weight = 1.0 / (blunt * blunt)
            add_range(distance, direction, eye_L, axes_L, weight, elevation_map=elevation_map)


@kernel
def begins_to_scan(params, nav, elapsed):
    """Return whether the hover has settled, or lasts longer than the latest start of the scan."""
    settled = norm(take3(nav.v_N, 0)) < params.speed and norm(take3(nav.w_B, 0)) < params.rate
    return settled or elapsed > params.latest


@kernel
def work_out(classify, params, terminal, deviation, nav, state, memory):
    """Classify the cells of the map, and choose the spot; ``deviation``: standard deviation of the elevation
    of a point, m; ``terminal``: parameters of the flight to the spot; ``memory``: ``HAZARD`` record, updated.
    """
    elevation_map, footprint, safety_map = memory.elevation_map, memory.footprint, memory.safety_map
    fill_holes(params.filled_weight, elevation_map)
    assess(elevation_map, params.footprint_radius, footprint)
    radius = params.footprint_radius
    classify(params.detection, params, elevation_map, footprint, radius, deviation=deviation, out=safety_map)
    clearances(safety_map.cell_class, elevation_map.cell, memory.envelope, safety_map.clearance)
    here_L = (nav.site_L[0], nav.site_L[1])
    choose_spot(
        params.choice,
        elevation_map,
        safety_map,
        here_L,
        apart=2.0 * params.footprint_radius,
        speed=terminal.lateral_speed,
        time=max(nav.height - terminal.avoidance_height, 0.0) / terminal.avoidance_rate,
        flow=state.mass * nav.gravity / (max(state.engine.specific_impulse, 1.0) * G0),
        out=memory.choice,
    )
    if memory.choice.found == 0:
        least_bad(elevation_map, footprint, safety_map, here_L, memory.choice)


@kernel
def look_ahead(onboard, sensed, nav, memory, point, command):
    """Trigger the camera, and make the coarse choice when the image arrives."""
    if memory.exposed == 0:
        command.camera_trigger = memory.exposed = 1
        drift = memory.coarse.drift
        predict_drifts(onboard.atmosphere, onboard.drifter, memory.carried_N, nav, drift)
    elif sensed.camera.fresh != 0:
        coarse = memory.coarse
        if choose_part(onboard.hazard.coarse, sensed.camera, nav, coarse):
            point.coarse_L[0], point.coarse_L[1] = (
                coarse.target_L[coarse.part, 0],
                coarse.target_L[coarse.part, 1],
            )
            point.coarse_known, memory.image_t = 1, nav.t


@kernel
def look_down(classify, onboard, elapsed, sensed, nav, state, memory, point, command):
    """Trigger the scan, add its blocks to the map, and choose the spot when the scan is complete."""
    params, eyes = onboard.hazard, onboard.instruments.imagers
    if memory.scanning == 0:
        if begins_to_scan(params.scan, nav, elapsed):
            command.scan = memory.scanning = 1
            memory.scan_t = nav.t
            put3(memory.here_L, 0, take3(nav.site_L, 0))
            put3(memory.way_L, 0, (0.0, 0.0, 0.0))
            ground = (nav.site_L[0], nav.site_L[1], nav.site_L[2] - nav.height)
            begin_map(params.cell, ground, memory.elevation_map)
        return
    move(nav, 1.0 / onboard.rates.base, memory)
    centre = take3(onboard.vehicle.configuration[state.configuration].centre, 0)
    axes_L = body_axes(onboard.planet, onboard.site.frame, nav)
    sharp = max(deviation_at(eyes.lidar, nav.height), 1e-3)
    if sensed.stereo.fresh != 0:
        eye_L = place_of_eye(eyes.stereo, centre, memory, axes_L)
        take_pair(eyes.stereo, sensed.stereo, sharp, eye_L, axes_L, elevation_map=memory.elevation_map)
    if sensed.lidar.fresh != 0:
        eye_L = place_of_eye(eyes.lidar, centre, memory, axes_L)
        take_rows(eyes.lidar, sensed.lidar, eye_L, axes_L, memory.elevation_map)
        if sensed.lidar.row + SCAN_BLOCK >= SCAN_ROWS:
            terminal = onboard.guidance.powered.terminal
            work_out(classify, params, terminal, sharp, nav, state=state, memory=memory)
            point.fine_L[0], point.fine_L[1] = memory.choice.spot_L[0], memory.choice.spot_L[1]
            point.fine_known, memory.spot_t = 1, nav.t


@kernel
def divert_to_map(onboard, nav, memory, point):
    """Choose a site of the map, where powered descent ends and, without a lidar, the vehicle lands."""
    predict_drifts(onboard.atmosphere, onboard.drifter, memory.carried_N, nav, memory.coarse.drift)
    site = choose_site(onboard.hazard.sites, onboard.hazard.coarse, nav, memory.coarse.drift)
    point.coarse_L[0], point.coarse_L[1] = site
    point.coarse_known, memory.site_t = 1, nav.t
    if onboard.instruments.imagers.lidar.tangent == 0.0:
        point.fine_L[0], point.fine_L[1] = site
        point.fine_known = 1


@kernel
def detect_nothing(classify, onboard, kind, elapsed, sensed, nav, state, memory, point, command):
    """Do nothing: the step of a vehicle without hazard detection, see :func:`detect_hazards`."""


@kernel
def detect_hazards(classify, onboard, kind, elapsed, sensed, nav, state, memory, point, command):
    """Run one base cycle of hazard detection.

    Args:
        classify: kernel of the chosen detector.
        onboard: ``ONBOARD`` record.
        kind, elapsed: guidance of the phase, an index of ``GUIDANCE`` in :mod:`edl6dof.fsw.mission`; time
            since the phase began, s.
        sensed, nav, state: ``SENSED``, ``NAV`` and ``VEHICLE_STATE`` records.
        memory: ``HAZARD`` record, updated.
        point: ``LANDING_POINT`` record, written when a choice is made.
        command: ``COMMAND`` record: requests to camera and lidar, written.
    """
    command.camera_trigger = command.scan = 0
    eyes = onboard.instruments.imagers
    if memory.exposed == 0:
        follow_wind(onboard.hazard.coarse.wind_time, nav, 1.0 / onboard.rates.base, memory.carried_N)
    if kind == G_POWERED and onboard.hazard.sites.spacing > 0.0:
        if point.coarse_known == 0:
            divert_to_map(onboard, nav, memory, point)
    elif kind == G_POWERED and eyes.camera.tangent > 0.0 and point.coarse_known == 0:
        look_ahead(onboard, sensed, nav, memory, point, command=command)
    elif kind == G_HOVER and eyes.lidar.tangent > 0.0 and point.fine_known == 0:
        look_down(
            classify, onboard, elapsed, sensed, nav, state=state, memory=memory, point=point, command=command
        )
    elif kind == G_AVOID and point.fine_known == 0:
        # nothing was seen: land at the point below
        point.fine_L[0], point.fine_L[1] = nav.site_L[0], nav.site_L[1]
        point.fine_known = 1
