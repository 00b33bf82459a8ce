"""The kernels have the signs of docs/conventions.md, and the controller printed there works unchanged."""

from __future__ import annotations

import re
import sys
from importlib.util import module_from_spec, spec_from_file_location
from math import atan2, cos, pi, radians, sin, sqrt
from pathlib import Path

import numpy as np
import pytest
from onboard_states import ENTRY, X, Y, Z, nav_state
from pyquaternion import Quaternion

from edl6dof.fsw.control.registry import CONTROL_INPUTS
from edl6dof.fsw.guidance.entry.aim_point import to_target
from edl6dof.spatial.frames import ned_attitude, wind_angles
from edl6dof.spatial.quaternion import to_frame

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs" / "conventions.md").read_text(encoding="utf-8")

sys.path.insert(0, str(ROOT / "tools"))
from docs_records import RECORDS, fields  # noqa: E402

#: Attitude in N of a lander with x of B down and y of B to the south.
UPRIGHT = Quaternion(matrix=np.column_stack([Z, -X, -Y]))
DT = 0.04


def flying(onboard, velocity_N, attitude, **more):
    """Navigation above the landing site."""
    site = onboard[0]["site"]
    return nav_state(onboard, site["latitude"], site["longitude"], 20e3, velocity_N, attitude, **more)


@pytest.mark.parametrize(
    ("axis", "turn", "field"),
    [(X, "right wing down", "bank"), (Y, "nose up", "alpha"), (-Z, "nose left", "beta")],
    ids=["bank", "alpha", "beta"],
)
def test_angles_of_the_entry_are_positive_as_printed(shared_onboard, axis, turn, field):
    attitude = Quaternion(axis=axis, degrees=20.0)
    nav = flying(shared_onboard, 3000.0 * X, attitude)
    nose, right = attitude.rotate(X), attitude.rotate(Y)
    seen = {"right wing down": right[2], "nose up": -nose[2], "nose left": -nose[1]}
    assert seen[turn] == pytest.approx(sin(radians(20.0)))
    assert turn in PAGE
    for name in ("bank", "alpha", "beta"):
        assert nav[name] == pytest.approx(radians(20.0) if name == field else 0.0, abs=1e-4)


def test_sideslip_is_reduced_by_a_yaw_to_the_right(shared_onboard):
    nose_left = Quaternion(axis=Z, degrees=-20.0)
    less = nose_left * Quaternion(axis=Z, degrees=5.0)
    betas = [flying(shared_onboard, 3000.0 * X, q)["beta"] for q in (nose_left, less)]
    assert betas == pytest.approx([radians(20.0), radians(15.0)], abs=1e-4)


def test_velocity_north_east_down_and_flight_path(shared_onboard):
    nav = flying(shared_onboard, (60.0, 80.0, 100.0), Quaternion())
    assert list(nav["v_N"]) == pytest.approx([60.0, 80.0, 100.0])
    assert nav["flight_path_angle"] == pytest.approx(-pi / 4)
    assert nav["azimuth"] == pytest.approx(atan2(80.0, 60.0))
    wind = flying(shared_onboard, 3000.0 * X, Quaternion(axis=Y, degrees=-10.0))
    assert wind["total_alpha"] > 0.0 > wind["alpha"]


def test_crossrange_is_positive_where_the_course_passes_right_of_the_aim_point(shared_onboard):
    site = shared_onboard[0]["site"]
    south = site["aim_latitude"] - radians(2.0)
    for heading, sign in ((radians(10.0), 1.0), (radians(-10.0), -1.0)):
        velocity = 3000.0 * np.array([cos(heading), sin(heading), 0.0])
        nav = nav_state(shared_onboard, south, site["aim_longitude"], 40e3, velocity, Quaternion())
        distance, crossrange, ahead = to_target(shared_onboard[0], nav)
        assert sign * crossrange > 0.1 * distance and ahead > 0.0


def test_heights_and_the_local_frame(shared_onboard):
    site = shared_onboard[0]["site"]
    nav = nav_state(
        shared_onboard,
        site["latitude"] + 1e-5,
        site["longitude"] + 2e-5,
        site["altitude"] + 500.0,
        X,
        UPRIGHT,
    )
    radius = shared_onboard[0]["planet"]["equatorial_radius"]
    assert nav["height"] == pytest.approx(500.0) and nav["altitude"] == pytest.approx(
        site["altitude"] + 500.0
    )
    east, north, up = nav["site_L"]
    assert east == pytest.approx(2e-5 * radius * cos(site["latitude"]), rel=0.02)
    assert north == pytest.approx(1e-5 * radius, rel=0.02) and up == pytest.approx(500.0, abs=0.1)
    assert nav["tilt"] == pytest.approx(0.0, abs=1e-6)


def test_quaternions_and_wind_angles_are_as_printed():
    q = ned_attitude(0.0, 1.0, 0.0, 1.0)  # F to N at latitude and longitude zero: north is z, down is -x
    assert to_frame(q, (0.0, 0.0, 1.0)) == pytest.approx((1.0, 0.0, 0.0))
    assert to_frame(q, (-1.0, 0.0, 0.0)) == pytest.approx((0.0, 0.0, 1.0))
    u, v, w = 3.0, 1.0, 2.0
    speed = sqrt(u * u + v * v + w * w)
    assert wind_angles((u, v, w)) == pytest.approx((speed, atan2(w, u), np.arcsin(v / speed)))


# ---- the controller of the page ------------------------------------------------------------------


@pytest.fixture
def printed(tmp_path):
    """The controller that the page prints, and its settings."""

    def module(change=lambda text: text):
        file = tmp_path / "printed.py"
        file.write_text(change(re.search(r"```python\n(.*?)```", PAGE, re.DOTALL)[1]), encoding="utf-8")
        spec = spec_from_file_location("printed", file)
        spec.loader.exec_module(found := module_from_spec(spec))
        return found.MEMBER.kernels["control"].py_func, found.MEMBER.params()

    return module


def roll_left(onboard, controller, start_deg, seconds=30.0):
    """Roll error (deg) that is left after some time, as navigation sees it, and as returned at the start."""
    control, params = controller
    inputs = np.zeros(1, CONTROL_INPUTS).view(np.recarray)[0]
    inputs["inertia"] = onboard[0]["vehicle"]["configuration"][ENTRY]["inertia"]
    roll, rate, returned = radians(start_deg), 0.0, None
    for _ in range(round(seconds / DT)):
        attitude = UPRIGHT * Quaternion(axis=X, radians=roll)
        nav = flying(onboard, 80.0 * Z, attitude, rate=(rate, 0.0, 0.0)).view(np.recarray)
        torque, error = control(params, nav, None, inputs, DT, None)
        returned = error[0] if returned is None else returned
        rate += torque[0] / inputs["inertia"][0] * DT
        roll += rate * DT
    return float(np.degrees(nav["roll_to_south"])), float(np.degrees(returned))


@pytest.mark.parametrize("start_deg", [90.0, -90.0, 171.0, -171.0])
def test_the_printed_controller_removes_a_roll_error(shared_onboard, printed, start_deg):
    """The lander is turned about x of B from its goal: the error, goal minus actual, is the turn back."""
    left, first = roll_left(shared_onboard, printed(), start_deg)
    assert first == pytest.approx(-start_deg, abs=1e-3)
    assert abs(left) < 0.1


def test_the_other_sign_ends_upside_down(shared_onboard, printed):
    """Only the sign that the page gives converges, so the test above can fail."""
    flipped = printed(lambda text: text.replace("params.stiffness * error", "-params.stiffness * error"))
    left, _ = roll_left(shared_onboard, flipped, 9.0, seconds=60.0)
    assert abs(left) == pytest.approx(180.0, abs=0.1)


# ---- the data dictionary -------------------------------------------------------------------------

DECLARED = [(module, name) for members in RECORDS.values() for module, name, _ in members]


@pytest.mark.parametrize(("module", "name"), DECLARED, ids=[name for _, name in DECLARED])
def test_every_field_of_a_record_has_a_meaning(module, name):
    assert fields(module, name)


def test_units_and_frames_of_records_are_read():
    nav = {field.path: field for field in fields("edl6dof.fsw.navigation.derived", "NAV")}
    assert nav["v_rel_I"][1:4] == ((3,), "m/s", "I") and nav["bank"].unit == "rad"
    assert nav["wing_open"].unit == "flag" and nav["up_I"].unit == "1"
    suffixed = [(field.path, field.frame) for field in nav.values() if re.search(r"_[INLB]$", field.path)]
    assert suffixed and all(path.endswith(f"_{frame}") for path, frame in suffixed)
    onboard = {field.path: field.unit for field in fields("edl6dof.fsw.onboard", "ONBOARD")}
    assert onboard["planet.mu"] == "m3/s2" and onboard["site.frame"] == "`LOCAL_FRAME`"
