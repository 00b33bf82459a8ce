"""Eyes in a flight: what they change where nobody looks, a scan, and a flight continued within one."""

import numpy as np
import pytest

import edl6dof
from edl6dof.interface.capacities import SCAN_BLOCK, SCAN_COLUMNS, SCAN_ROWS
from edl6dof.interface.sensed import cell_direction
from edl6dof.scenario.records import build_records
from edl6dof.sensors.ray_ground import height_over_ground, point_motion
from edl6dof.sim.checkpoint import State
from edl6dof.sim.flight import continue_from, fly
from edl6dof.spatial.frames import rotate_z
from edl6dof.spatial.quaternion import from_frame
from edl6dof.vehicle.plant import ATTITUDE, OUTPUTS
from edl6dof.vehicle.surroundings import planet_rotation

ROCKY = ["terrain.landing_area.rock_abundance=0.1"]
READINGS = "inertial_unit, star_tracker, ground_tracking, radar, switches"


@pytest.fixture(scope="module")
def flight():
    """One that is saved half a second into its scan."""
    loaded = edl6dof.load("tianwen1_hazards", ROCKY)
    whole = fly(loaded)
    begun = next(event["t_s"] for event in whole.events if event["key"] == "scan")
    return fly(loaded, save_at_s=begun + 0.5)


def test_eyes_that_nobody_uses_change_nothing():
    carried = f"sensors.carried=[{READINGS}, landing_camera, lidar, stereo]"
    without, idle = edl6dof.fly("tianwen1"), edl6dof.fly("tianwen1", [carried])
    assert idle.log.tobytes() == without.log.tobytes()


def test_flight_goes_on_within_a_scan_as_it_would_have(flight, tmp_path):
    state = flight.saved
    assert 0 < state.sensors["lidar"]["left"][0] < SCAN_ROWS
    state.save(tmp_path / "state.npz")
    on = State.load(tmp_path / "state.npz")
    rest = fly(continue_from(on), start=on)
    assert len(rest.log) > 1000
    assert rest.log.tobytes() == flight.log[-len(rest.log) :].tobytes()


def test_rays_of_a_scan_in_flight_end_on_the_ground(flight):
    """A cycle after they were shot: the vehicle hovers, and ranges scatter by centimetres."""
    case, tables, _ = build_records(flight.loaded)
    state, eye = flight.saved, flight.scenario.sensors.lidar
    plant, lidar = state.plant[0], state.sensors["sensed"]["lidar"][0]
    outputs = np.zeros(1, OUTPUTS)[0]
    outputs["centre"] = flight.outputs["centre"][0]
    rotation = planet_rotation(case[0]["planet"], plant["t"])
    origin = np.array(point_motion(case[0], plant, outputs, eye.position_m, rotation)[0])
    q, tangent = tuple(plant["y"][ATTITUDE : ATTITUDE + 4]), np.tan(0.5 * np.radians(eye.field_of_view_deg))
    over = []
    for i in range(SCAN_BLOCK):
        for j in range(0, SCAN_COLUMNS, 7):
            ray = rotate_z(
                *rotation, from_frame(q, cell_direction(tangent, SCAN_COLUMNS, lidar["row"] + i, j))
            )
            if lidar["range"][i, j] > 0.0:
                point = tuple(origin + float(lidar["range"][i, j]) * np.array(ray))
                over.append(height_over_ground(case[0], tables[0], plant["inputs"]["areoid"], point)[0])
    assert len(over) > 100
    assert abs(np.median(over)) < 0.1 and np.mean(np.abs(over) < 0.15) > 0.9
