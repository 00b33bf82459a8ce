"""The open-loop bank profile, and the predictive reversal logic."""

from math import cos, radians, sin

import numpy as np
import pytest

import edl6dof
from edl6dof.config.errors import ConfigError
from edl6dof.fsw.guidance.entry.predictor import predict, shifted
from edl6dof.fsw.guidance.entry.registry import ENTRY_LAWS, wanted_bank
from edl6dof.fsw.guidance.entry.reversal.registry import REVERSALS, bank_side
from edl6dof.fsw.guidance.guidance_command import GUIDE
from edl6dof.fsw.navigation.derived import NAV
from edl6dof.scenario.records import build_onboard

ENTRY = "flight_software.guidance.entry"


@pytest.mark.parametrize("over", ["speed", "time"])
def test_bank_profile_is_linear_between_its_points_and_constant_beyond(over):
    points = [(500.0, -30.0), (1500.0, 50.0), (1600.0, 20.0), (3500.0, 75.0)]
    text = ", ".join(f"{{at: {x}, bank_deg: {bank}}}" for x, bank in points)
    scenario = edl6dof.load("tianwen1", [f"{ENTRY}.bank_profile={{over: {over}, points: [{text}]}}"]).scenario
    record = build_onboard(scenario)[0]
    nav, memory, out = np.zeros(1, NAV)[0], np.zeros(1, ENTRY_LAWS.memory)[0], np.zeros(1, GUIDE)[0]
    for x in (0.0, 499.0, 500.0, 900.0, 1500.0, 1555.5, 2000.0, 3500.0, 4800.0):
        nav["speed"], nav["t"] = (x, 77.0) if over == "speed" else (77.0, x)
        bank = wanted_bank(
            ENTRY_LAWS.names.index("bank_profile"),
            record["guidance"]["entry"],
            record["plan"],
            record,
            nav,
            memory,
            out,
        )
        assert bank == pytest.approx(radians(np.interp(x, *np.transpose(points))), abs=1e-12)


def test_bank_profile_that_does_not_ascend_is_refused_with_its_place():
    with pytest.raises(ConfigError, match="bank_profile.*must ascend"):
        edl6dof.load(
            "tianwen1", [f"{ENTRY}.bank_profile={{points: [{{at: 2, bank_deg: 1}}, {{at: 2, bank_deg: 1}}]}}"]
        )


def test_signed_profile_is_flown_with_its_own_signs():
    """Right above 3 km/s, left below, whatever the crossrange; the body follows the command."""
    points = "[{at: 2900, bank_deg: -60}, {at: 3100, bank_deg: 60}]"
    sets = [
        "mission.goal=deployment",
        f"{ENTRY}.law=bank_profile",
        f"{ENTRY}.bank_profile={{points: {points}}}",
    ]
    flight = edl6dof.fly("tianwen1", [*sets, f"{ENTRY}.reversal.logic=own_sign"])
    t = flight.telemetry
    lift = t["guide.phase"] == 1
    fast, slow = (
        lift & (t["truth.speed_m_s"] > 3200.0),
        lift & (t["truth.speed_m_s"] < 2500.0) & (t["truth.speed_m_s"] > 700.0),
    )
    right, left = t["truth.bank_deg"][fast][200:], t["truth.bank_deg"][slow]
    assert np.mean(right) == pytest.approx(60.0, abs=2.0) and right.min() > 30.0
    assert np.mean(left) == pytest.approx(-60.0, abs=2.0) and left.max() < -30.0


# ---- predictive reversal -----------------------------------------------------------------------------------


def heading(record, off_deg):
    """In mid entry 300 km north of the aim point, flying ``off_deg`` to the right of it."""
    site, nav = record["site"], np.zeros(1, NAV)[0]
    nav["latitude"], nav["longitude"], nav["altitude"] = (
        site["aim_latitude"] + 300e3 / 3.396e6,
        site["aim_longitude"],
        34e3,
    )
    gamma, psi, nav["speed"], nav["drag"] = radians(-7.0), radians(180.0 + off_deg), 3600.0, 50.0
    nav["v_N"] = nav["speed"] * np.array([cos(gamma) * cos(psi), cos(gamma) * sin(psi), -sin(gamma)])
    return nav


@pytest.fixture
def still(onboard):
    """A planet at rest, so that left and right are mirror images."""
    onboard[0]["planet"]["rotation_rate"] = 0.0
    return onboard[0]


def side(record, nav, sign, wanted=1.0):
    out = np.zeros(1, GUIDE)[0]
    out["drag_ratio"] = out["lift_ratio"] = 1.0
    mem = np.zeros(1, REVERSALS.memory)[0]
    params = record["guidance"]["entry"]["reversal"]
    return bank_side(REVERSALS.names.index("predictive"), params, record, nav, mem, out, wanted, sign)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_side_is_kept_heading_for_the_target_and_left_when_far_past_it(still, sign):
    assert side(still, heading(still, 0.0), sign) == sign  # a reversal now would overshoot as far as going on
    assert side(still, heading(still, 8.0 * sign), sign) == -sign
    assert side(still, heading(still, -8.0 * sign), sign) == sign


def test_reversal_comes_where_the_predicted_crossranges_have_the_set_ratio(still):
    ratio = 0.37
    still["guidance"]["entry"]["reversal"]["predictive"]["ratio"] = ratio
    low, high = 0.0, 8.0
    for _ in range(30):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if side(still, heading(still, middle), 1.0) > 0.0 else (low, middle)
    out = np.zeros(1, GUIDE)[0]
    out["drag_ratio"] = out["lift_ratio"] = 1.0
    shift = cos(1.0) - cos(still["guidance"]["entry"]["reference_bank"]["points"]["bank"][0])
    on, back = (predict(still, heading(still, low), out, shifted(shift, s, 0.0, 0.0))[1] for s in (1.0, -1.0))
    assert -back / on == pytest.approx(ratio, abs=1e-3)


def test_predictive_reversals_end_near_the_target_with_few_reversals():
    sets = ["mission.goal=deployment", f"{ENTRY}.law=npc", f"{ENTRY}.reversal.logic=predictive"]
    flight = edl6dof.fly("tianwen1", sets)
    assert flight.success
    assert 2 <= flight.figures["bank_reversals"] <= 6
    assert abs(flight.figures["parachute_crossrange_m"]) < 2500.0
