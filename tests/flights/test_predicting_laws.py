"""Laws that predict and that track influence coefficients, in closed loop: on the rigid body in other airs,
and on the point mass.
"""

import pytest

import edl6dof


@pytest.mark.parametrize("law", ["npc", "etpc"])
@pytest.mark.parametrize(
    "truth",
    [
        pytest.param({}, marks=pytest.mark.long),
        {"atmosphere.density_factor": 1.2},
        pytest.param({"atmosphere.density_factor": 0.85}, marks=pytest.mark.long),
        {"initial.flight_path_angle_deg": -11.8},
    ],
)
def test_law_brings_the_rigid_body_to_the_parachute_target(truth, law):
    """Miss within the drift that no bank angle answers: the last 16 km are flown with level wings in an
    unknown wind.
    """
    sets = [
        "mission.goal=deployment",
        f"flight_software.guidance.entry.law={law}",
        f"truth={truth}".replace("'", '"'),
    ]
    flight = edl6dof.fly("tianwen1", sets)
    assert flight.success
    assert flight.figures["parachute_miss_m"] < 2500.0
    assert abs(flight.figures["parachute_downrange_m"]) < 1500.0


@pytest.mark.parametrize("law", ["npc", "etpc", "bank_profile"])
@pytest.mark.parametrize("response", [pytest.param("ideal", marks=pytest.mark.long), "rate_limited"])
def test_laws_fly_the_point_mass_as_they_fly_the_rigid_body(law, response):
    """Without attitude dynamics the guided laws still end near the target; the open loop ends where its
    profile ends.
    """
    sets = ["mission.goal=deployment", "dynamics=point_mass", f"point_mass.bank_response={response}"]
    flight = edl6dof.fly("tianwen1", [*sets, f"flight_software.guidance.entry.law={law}"])
    assert flight.success
    if law != "bank_profile":
        assert flight.figures["parachute_miss_m"] < 3000.0
