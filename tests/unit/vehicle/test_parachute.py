"""Parachute against the published nodes, the closed-form fall with square-law drag, and what a canopy and a
rope can do at all.

Nodes: Cruz et al. 2013 as printed in the reference data (parachute_models.json), numbers typed here once
more.  Fall: v = v_t tanh(g t / v_t).  Ropes pull, air takes energy away, and inside the trim angle the canopy
is pushed outward.
"""

from math import cos, pi, radians, sin, sqrt, tanh

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from edl6dof.config.dtype import fill
from edl6dof.vehicle.parachutes import parachute as kernels
from edl6dof.vehicle.parachutes.canopy_models import efficiency_of_model
from edl6dof.vehicle.parachutes.parachute import PARACHUTE_PARAMS, ParachuteParams

CANOPY = {
    "name": "main",
    "diameter_m": 15.96,
    "drag_coefficient": 0.62,
    "mortar_speed_m_s": 30.0,
    "line_length_m": 31.0,
    "confluence_m": (0.0, 0.0, 0.0),
}


def chute(**changes):
    record = np.zeros(1, PARACHUTE_PARAMS).view(np.recarray)[0]
    fill(record, ParachuteParams(**CANOPY | changes))
    return record


USUAL = chute()


def model_efficiency(mach):
    return efficiency_of_model(0, USUAL, USUAL, mach)


def force(record, angle_deg, fraction=1.0, density=0.01, mach=0.5, t=0.0, speed=120.0, roll=0.7):
    """Canopy force in axes (along the canopy's axis towards the vehicle, two across), flying at an angle to
    that axis.
    """
    a = radians(angle_deg)
    v = (speed * cos(a), speed * sin(a) * cos(roll), speed * sin(a) * sin(roll))
    return np.array(kernels.canopy_force(record, fraction, density, mach, t, v, (1.0, 0.0, 0.0))), np.array(v)


@pytest.mark.parametrize(
    "mach, efficiency",
    [(0.0, 1.0), (0.7, 1.0), (0.82, 0.835), (0.94, 0.67), (1.17, 0.9175), (1.4, 1.0), (1.625, 0.96), (1.85,
    0.84), (2.225, 0.725),
     (2.6, 0.61), (3.5, 0.61)],
)  # fmt: skip
def test_mach_efficiency_passes_through_the_published_nodes(mach, efficiency):
    assert model_efficiency(mach) == pytest.approx(efficiency, abs=1e-12)


def test_mach_efficiency_has_no_jumps():
    machs = np.linspace(0.0, 4.0, 8001)
    values = np.array([model_efficiency(m) for m in machs])
    assert np.abs(np.diff(values)).max() < 1.5 * np.diff(machs).max()  # steepest: 0.33 * 2 / 0.46 per Mach


@pytest.mark.parametrize("diameter, area", [(19.7, 304.8), (15.96, 200.0)], ids=["MSL", "Tianwen-1"])
def test_nominal_area_is_the_published_one(diameter, area):
    assert kernels.nominal_area(chute(diameter_m=diameter)) == pytest.approx(area, abs=0.1)


def test_inflation_fills_in_the_published_time_and_overshoots_by_the_opening_load_factor():
    record = chute(diameter_m=19.7, disk_gap_band={"overshoot_decay_s": 0.25})
    times = np.linspace(-0.1, 2.0, 21001)
    fraction = np.array([kernels.inflation(record, t) for t in times])
    full = times[fraction.argmax()]
    assert full == pytest.approx(19.7 / 27.2, abs=1e-3)  # 0.724 s for MSL
    assert fraction.max() == pytest.approx(1.344, abs=1e-3)
    assert fraction[times <= 0.0].max() == 0.0 and fraction[times > full + 0.25].tolist() == pytest.approx(
        [1.0] * sum(times > full + 0.25)
    )
    assert np.all(np.diff(fraction[times <= full]) >= 0.0) and np.all(np.diff(fraction[times >= full]) <= 0.0)
    assert np.abs(np.diff(fraction)).max() < 1e-3  # continuous: 4 * 1.344 / 0.724 s * 0.1 ms = 7e-4
    half = kernels.inflation(record, 0.5 * 19.7 / 27.2)
    assert half == pytest.approx(1.344 / 16.0)  # fourth power of time


def test_apparent_mass_is_a_share_of_the_air_in_a_sphere_of_the_projected_diameter():
    """MSL: 0.75 x air in a sphere of diameter 0.7 D; with half the drag area the radius is 1/sqrt 2."""
    record = chute(diameter_m=19.7)
    sphere = 0.012 * pi / 6.0 * (0.7 * 19.7) ** 3
    assert kernels.apparent_mass(record, 0.012, 1.0) == pytest.approx(0.75 * sphere)
    assert kernels.apparent_mass(record, 0.012, 0.5) == pytest.approx(0.75 * sphere / sqrt(8.0))
    assert kernels.apparent_mass(record, 0.012, 0.0) == 0.0
    assert kernels.apparent_mass(record, 0.012, 1.344) == kernels.apparent_mass(record, 0.012, 1.0)


def tension(record, mass, distance, rate):
    return kernels.riser_tension(record, mass, distance, rate, kernels.BY_STRETCH)[0]


def test_a_riser_pulls_and_never_pushes():
    record = chute()
    for distance in (0.1, 30.999, 31.0):
        assert tension(record, 40.0, distance, 50.0) == 0.0
    assert tension(record, 40.0, 31.1, 0.0) == pytest.approx(40000.0 * 0.1)
    assert tension(record, 40.0, 31.1, -100.0) == 0.0  # closing faster than the lines recoil


def test_a_stretched_riser_swings_at_its_frequency_and_loses_energy_by_its_damping_ratio():
    """Mass held by a damped spring about a steady pull: peak ratio over a period exp(-2 pi z / sqrt(1 -
    z^2)).
    """
    record, mass, pull = chute(damping_ratio=0.1), 40.0, 8000.0
    omega = sqrt(40000.0 / mass)
    period = 2.0 * pi / (omega * sqrt(1.0 - 0.01))
    rest = 31.0 + pull / 40000.0

    def motion(t, y):
        return [y[1], (pull - tension(record, mass, y[0], y[1])) / mass]

    end = solve_ivp(motion, (0.0, period), [rest + 0.1, 0.0], rtol=1e-10, atol=1e-12).y[0, -1]
    assert (end - rest) / 0.1 == pytest.approx(np.exp(-2.0 * pi * 0.1 / sqrt(1.0 - 0.01)), rel=1e-6)


def test_straight_behind_the_canopy_drags_with_its_coefficient():
    record = chute(pack_drag_area_m2=0.0)
    got, _ = force(record, 0.0, mach=0.94, fraction=0.8)
    assert got == pytest.approx(
        (-0.5 * 0.01 * 120.0**2 * 0.8 * pi / 4 * 15.96**2 * 0.62 * 0.67, 0.0, 0.0), rel=1e-12
    )
    assert kernels.canopy_force(record, 1.0, 0.01, 0.0, 0.0, (0.0, 0.0, 0.0), (1.0, 0.0, 0.0)) == (
        0.0,
        0.0,
        0.0,
    )


@pytest.mark.parametrize("angle_deg", [0.0, 3.0, 8.0, 20.0, 60.0, 89.0, 91.0, 130.0, 177.0, 180.0])
def test_air_takes_energy_from_the_canopy_at_every_angle(angle_deg):
    for roll in (0.0, 2.1, -1.3):
        got, v = force(chute(), angle_deg, roll=roll)
        assert got @ v < 0.0


@pytest.mark.parametrize("angle_deg, sign", [(0.0, 0), (2.0, 1), (7.9, 1), (8.0, 0), (8.1, -1), (25.0, -1)])
def test_normal_force_drives_the_canopy_to_its_trim_angle(angle_deg, sign):
    """Across the axis: with the motion (angle grows) inside the trim angle, against it outside, none at
    it.
    """
    got, v = force(chute(trim_angle_deg=8.0, pack_drag_area_m2=0.0), angle_deg)
    across = got[1:] @ v[1:]
    assert across == pytest.approx(0.0, abs=1e-6) if sign == 0 else np.sign(across) == sign
    assert got[1] * v[2] == pytest.approx(got[2] * v[1], abs=1e-6)  # in the plane of axis and velocity


def test_normal_force_changes_without_jumps_up_to_a_right_angle():
    curve = np.array([force(chute(), a)[0] for a in np.linspace(0.0, 89.9, 2000)])
    assert np.abs(np.diff(curve, axis=0)).max() < 2e-3 * np.abs(curve).max()


def test_a_packed_canopy_is_a_lump_that_drags_the_same_from_any_side():
    for angle_deg in (0.0, 45.0, 89.9, 90.1, 150.0):
        got, v = force(chute(pack_drag_area_m2=0.3), angle_deg, fraction=0.0)
        assert got == pytest.approx(-0.5 * 0.01 * 120.0 * 0.3 * v, rel=1e-9)


def test_the_area_breathes_above_mach_1_4_only():
    record = chute(area_oscillation=0.1, area_oscillation_frequency_hz=3.0, pack_drag_area_m2=0.0)
    drag = {
        mach: np.array([force(record, 0.0, mach=mach, t=t)[0][0] for t in np.arange(1200) / 1200])
        for mach in (1.3, 1.6)
    }
    assert np.ptp(drag[1.3]) == 0.0
    ratio = drag[1.6] / drag[1.6].mean()
    assert (ratio.min(), ratio.max()) == pytest.approx((0.9, 1.1), abs=1e-3)
    assert np.abs(np.fft.rfft(ratio - 1.0)).argmax() == 3  # periods in a second


def test_the_descent_reaches_terminal_velocity_as_the_closed_form_says():
    """1200 kg under 200 m2 in Mars air at the ground, drag factor 0.9: from rest v = vt tanh(g t / vt)."""
    record, mass, g, density = chute(drag_factor=0.9, pack_drag_area_m2=0.4), 1200.0, 3.72, 0.016
    terminal = sqrt(2.0 * mass * g / (density * (0.25 * pi * 15.96**2 * 0.62 * 0.9 + 0.4)))
    assert 60.0 < terminal < 75.0

    def fall(t, y):
        return [
            kernels.canopy_force(record, 1.0, density, 0.3, t, (0.0, 0.0, y[0]), (0.0, 0.0, 1.0))[2] / mass
            + g
        ]

    times = np.linspace(0.0, 60.0, 13)
    got = solve_ivp(fall, (0.0, 60.0), [0.0], t_eval=times, rtol=1e-9, atol=1e-9).y[0]
    assert got == pytest.approx([terminal * tanh(g * t / terminal) for t in times], rel=1e-6, abs=1e-9)


def reefed(delay_s, **changes):
    stages = [
        {"drag_area_ratio": 0.12, "filling_time_s": 0.5},
        {"drag_area_ratio": 1.0, "delay_s": delay_s, "filling_time_s": 1.5},
    ]
    return {"stages": stages, **changes}


def test_a_reefed_canopy_fills_twice_each_time_by_its_power_of_time():
    times = [0.0, 0.25, 0.5, 11.9, 12.0, 12.75, 13.5, 60.0]
    for exponent in (1.0, 2.0):
        record = chute(model="reefed", reefed=reefed(12.0, filling_exponent=exponent))
        half = 0.5**exponent
        expected = [0.0, 0.12 * half, 0.12, 0.12, 0.12, 0.12 + 0.88 * half, 1.0, 1.0]
        assert [kernels.inflation(record, t) for t in times] == pytest.approx(expected)


def test_a_canopy_disreefs_in_as_many_stages_as_are_given():
    ratios, delays = (0.08, 0.3, 1.0), (0.0, 4.0, 9.0)
    stages = [
        {"drag_area_ratio": ratio, "delay_s": delay, "filling_time_s": 1.0}
        for ratio, delay in zip(ratios, delays, strict=True)
    ]
    record = chute(model="reefed", reefed={"stages": stages})
    times = [0.5, 3.9, 4.5, 8.9, 9.5, 20.0]
    expected = [0.04, 0.08, 0.19, 0.3, 0.65, 1.0]
    assert [kernels.inflation(record, t) for t in times] == pytest.approx(expected)


@pytest.mark.parametrize(
    "stages, words",
    [
        ([(0.1, 0.0, 1.0), (1.0, 0.5, 1.0)], "after the one before has filled"),
        ([(0.4, 0.0, 1.0), (0.3, 2.0, 1.0), (1.0, 5.0, 1.0)], "end larger"),
        ([(0.1, 0.0, 1.0), (0.9, 2.0, 1.0)], "drag_area_ratio 1"),
        ([(1.0, 2.0, 1.0)], "line stretch"),
    ],
)
def test_stages_that_do_not_follow_each_other_are_refused(stages, words):
    keys = ("drag_area_ratio", "delay_s", "filling_time_s")
    given = [dict(zip(keys, stage, strict=True)) for stage in stages]
    with pytest.raises(ValueError, match=words):
        chute(model="reefed", reefed={"stages": given})


def by_mach(mach, factor):
    return {"mach": mach, "factor": factor}


@pytest.mark.parametrize("model", ["disk_gap_band", "reefed"])
def test_drag_over_mach_is_a_table_where_one_is_given(model):
    """Whatever the model; on straight lines between the points, held beyond, times the loss in the wake."""
    record = chute(
        model=model,
        mach_efficiency=by_mach([0.5, 1.0, 2.0], [1.0, 0.7, 0.9]),
        wake_factor=by_mach([0.0, 2.0], [1.0, 0.8]),
        pack_drag_area_m2=0.0,
    )
    full = 0.5 * 0.01 * 120.0**2 * pi / 4 * 15.96**2 * 0.62
    for mach, share in [(0.0, 1.0), (0.75, 0.85 * 0.925), (1.0, 0.7 * 0.9), (1.5, 0.8 * 0.85), (3.0, 0.72)]:
        assert -force(record, 0.0, mach=mach)[0][0] == pytest.approx(full * share, rel=1e-12)


def test_the_published_curve_as_a_table_is_the_closed_form_within_half_a_percent():
    """What the closed form says at 16 Mach numbers, on straight lines, against itself in between."""
    nodes = [0.0, 0.7, 0.94, 1.0, 1.06, 1.12, 1.18, 1.25, 1.32, 1.4, 1.5, 1.6, 1.7, 1.77, 1.85, 2.6]
    record = chute(mach_efficiency=by_mach(nodes, [model_efficiency(mach) for mach in nodes]))
    machs = np.linspace(0.0, 3.0, 3001)
    table = np.array([kernels.drag_efficiency(record, mach) for mach in machs])
    assert np.abs(table - [model_efficiency(mach) for mach in machs]).max() < 0.005


@pytest.mark.parametrize(
    "table, words",
    [
        (by_mach([1.0], [1.0]), "two or more"),
        (by_mach([1.0, 1.0], [1.0, 0.9]), "ascend"),
        (by_mach([0.0, 1.0], [1.0]), "as many as"),
        (by_mach([0.0, 1.0], [1.0, 0.0]), "above 0"),
        (by_mach([-1.0, 1.0], [1.0, 0.5]), "negative"),
    ],
)
def test_a_table_over_mach_that_cannot_be_read_is_refused(table, words):
    with pytest.raises(ValueError, match=words):
        chute(mach_efficiency=table)


def test_a_reefed_descent_settles_at_the_closed_form_speed_of_each_stage():
    """Weight equals drag: v = sqrt(2 m g / (rho Cd S)) with the reefed area, then the open one."""
    record = chute(model="reefed", reefed=reefed(25.0), pack_drag_area_m2=0.0, diameter_m=25.0)
    mass, g, density = 3000.0, 9.81, 1.1
    area = 0.62 * pi / 4.0 * 25.0**2

    def fall(t, y):
        share = kernels.inflation(record, t)
        drag = kernels.canopy_force(record, share, density, 0.2, t, (0.0, 0.0, y[0]), (0.0, 0.0, 1.0))[2]
        return [drag / mass + g]

    times = np.array([24.9, 60.0])
    speeds = solve_ivp(fall, (0.0, 60.0), [60.0], t_eval=times, rtol=1e-9, max_step=0.02).y[0]
    expected = [sqrt(2.0 * mass * g / (density * area * share)) for share in (0.12, 1.0)]
    assert speeds == pytest.approx(expected, rel=1e-4)


def test_the_area_of_a_filling_canopy_may_be_left_in_peace():
    """What it did until it was open is in the opening load factor."""
    record = chute(area_oscillation=0.1, area_oscillates="open", pack_drag_area_m2=0.0)
    for fraction, swings in ((0.5, False), (1.2, False), (1.0, True)):
        drag = [force(record, 0.0, fraction, mach=1.6, t=t)[0][0] for t in np.arange(60) / 60]
        assert (np.ptp(drag) > 0.0) == swings
