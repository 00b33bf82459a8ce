"""Covariance from mirrored pairs: designs, moments, linear and noisy responses, an entry in closed form."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from scipy import stats

from edl6dof.campaign.covariance_estimate import (
    Alone,
    Covariance,
    Pairs,
    Sampled,
    fly_alone,
    fly_covariance,
    principal,
)
from edl6dof.campaign.covariance_flights import (
    EventFigures,
    Source,
    at_least,
    cases,
    design,
    figures_at,
    hadamard,
    moments,
    sources,
)
from edl6dof.campaign.design.dispersions import Draw
from edl6dof.campaign.design.plan import load_plan
from edl6dof.config.errors import ConfigError
from edl6dof.verify.case import BARE, ENDLESS, ONE_BODY, WEIGHTLESS

#: A body of constant drag that falls straight through an exponential atmosphere, without weight or rotation.
STRAIGHT_DOWN = (
    *(*BARE, *WEIGHTLESS, *ONE_BODY, *ENDLESS),
    "atmosphere.model=exponential",
    "vehicle.aero.model=constant",
    "vehicle.aero.constant={drag_coefficient: 1.5, reference_area_m2: 9, moment_reference_x_m: -0.85}",
    "vehicle.mass.entry_centre_m=[-0.85, 0, 0]",
    "vehicle.mass.entry_kg=400",
    "initial.speed_m_s=4800",
    "initial.flight_path_angle_deg=-90",
    "initial.rate_deg_s=[0, 0, 0]",
    "simulation.time_limit_s=40",
)


@pytest.mark.parametrize("order", [1, 2, 4, 8, 12, 16, 20, 24, 32, 44, 48, 60])
def test_designs_have_orthogonal_columns(order):
    matrix = hadamard(order)
    assert np.array_equal(np.abs(matrix), np.ones((order, order)))
    assert np.array_equal(matrix.T @ matrix, order * np.eye(order))


def test_a_design_has_as_many_pairs_as_columns():
    assert hadamard(28) is None and len(at_least(25)) == 32
    steps = design(columns=30, more=5, pairs=24, seed=1)
    assert steps.shape == (32, 35)
    assert np.array_equal(steps[:, :30].T @ steps[:, :30], 32.0 * np.eye(30))
    assert set(np.unique(steps)) == {-1.0, 1.0}
    assert not np.array_equal(steps, design(30, 5, 24, seed=2))


@pytest.fixture(scope="module")
def linear() -> tuple[np.ndarray, np.ndarray]:
    """Slopes of two figures to 20 deviates, and steps that tell them apart."""
    return np.random.default_rng(5).standard_normal((20, 2)), design(20, 0, 24, seed=3)


def test_a_linear_response_is_found_exactly(linear):
    slopes, steps = linear
    pairs = Pairs.of(steps, np.vstack([steps, -steps]) @ slopes + [7.0, -2.0])
    assert pairs.slopes == pytest.approx(slopes, abs=1e-12)
    assert pairs.covariance == pytest.approx(slopes.T @ slopes, abs=1e-12)
    axes = pairs.spread(principal(pairs.covariance))
    assert axes.deviation == pytest.approx(np.linalg.svd(slopes)[1])
    assert axes.linear == pytest.approx(axes.deviation) and axes.error == pytest.approx([0.0, 0.0], abs=1e-9)
    assert pairs.spread(np.eye(2)).mean == pytest.approx([7.0, -2.0])


def test_noise_adds_without_bias_and_the_errors_are_true(linear):
    """Over many designs: the mean of the variance, and the scatter of deviation, mean and slopes."""
    slopes, steps = linear
    rng, found, whole = np.random.default_rng(8), [], []
    for _ in range(600):
        noise = 3.0 * rng.standard_normal((48, 2))
        pairs = Pairs.of(steps, np.vstack([steps, -steps]) @ slopes + noise)
        spread = pairs.spread(np.eye(2))
        found.append((spread.deviation, spread.error, spread.mean, spread.mean_error))
        whole.append((pairs.slopes[0], pairs.slope_error))
    deviation, error, mean, mean_error = np.array(found).transpose(1, 0, 2)
    expected = np.sqrt((slopes**2).sum(axis=0) + 9.0)
    assert np.sqrt((deviation**2).mean(axis=0)) == pytest.approx(expected, rel=0.02)
    assert deviation.std(axis=0) == pytest.approx(error.mean(axis=0), rel=0.12)
    assert mean.std(axis=0) == pytest.approx(mean_error.mean(axis=0), rel=0.12)
    first, slope_error = np.array(whole).transpose(1, 0, 2)
    assert first.std(axis=0) == pytest.approx(slope_error.mean(axis=0), rel=0.12)


def test_the_budget_of_sources_random_effects_and_interactions_is_the_variance():
    """y = slopes z + 2 z1 z2 + noise of 3 + a random effect of 1 at z3 = 1 and of 2 at z3 = -1: the variances
    are known, and their sum is that of independent flights. Over designs of 24 pairs, an interaction counts
    24 / 23 times, and as an error of each slope, whose square is reduced by it.
    """
    rng, slopes, found = np.random.default_rng(4), np.array([4.0, 0.5, 0.0]), []
    apart = tuple(Source(f"s{k}", (Draw((None,), None),)) for k in range(3))

    def flown(z):
        noise = 3.0 * rng.standard_normal(len(z)) + (1.5 - 0.5 * z[:, 2]) * rng.standard_normal(len(z))
        return (z @ slopes + 2.0 * z[:, 0] * z[:, 1] + noise)[:, None]

    for seed in range(1500):
        steps = design(3, 0, 24, seed)
        pairs = Pairs.of(steps, np.vstack([flown(steps), flown(-steps), flown(steps)]))
        one = Covariance(EventFigures((), ("y",)), pairs, apart, ())
        found.append([*one.budget[:, 0], pairs.random[0], one.spread.deviation[0] ** 2])
    first, second, third, random, total = np.mean(found, axis=0)
    assert [first, second, third] == pytest.approx([16.0, 0.25, 0.0], abs=0.25)
    assert random == pytest.approx(9.0 + 2.5, rel=0.03)
    interaction = 4.0 * 24.0 / 23.0
    assert total - first - second - third - random == pytest.approx(
        interaction * (1.0 + 3.0 / 24.0), abs=0.35
    )
    steps = rng.standard_normal((100_000, 3))
    assert total == pytest.approx(flown(steps).var(), rel=0.03)
    still = Pairs.of(design(3, 0, 24, 1), np.ones((48, 1)))
    assert still.random == pytest.approx([0.0]) and still.changes.shape == (0, 1)


def test_a_second_order_shifts_the_mean_and_adds_what_it_should_to_it():
    steps = design(2, 0, 8, seed=1)
    both = np.vstack([steps, -steps])
    pairs = Pairs.of(steps, (4.0 * both[:, :1] + 0.5 * both[:, :1] ** 2))
    assert pairs.spread(np.eye(1)).mean == pytest.approx([0.5])
    alone = Alone.of((), np.array([[0.0], [4.5], [0.0], [-3.5], [0.0]]))
    assert alone.slopes[:, 0] == pytest.approx([4.0, 0.0]) and alone.bends[:, 0] == pytest.approx([0.5, 0.0])


def test_a_campaign_has_wider_errors_where_its_tails_are_heavy():
    rng = np.random.default_rng(2)
    samples = np.stack([rng.standard_normal(4000), rng.standard_t(5, 4000)], axis=1)
    flown = Sampled.of(samples)
    assert flown.error[0] == pytest.approx(flown.deviation[0] / np.sqrt(8000), rel=0.1)
    assert flown.error[1] > 1.3 * flown.error[0]
    assert flown.core[0] == pytest.approx(1.0, abs=0.05) and flown.core[1] < 0.95 * flown.deviation[1]


def plan_of(tmp_path, lines: str, more: str = ""):
    path = tmp_path / "straight.yaml"
    path.write_text(f"extends: tianwen1\nname: straight\ncampaign:\n  cases: 10\n  truth:\n{lines}{more}")
    return load_plan(str(path), STRAIGHT_DOWN)


@pytest.mark.parametrize(
    ("kind", "expected"),
    [
        ("{kind: normal, three_sigma: 30}", stats.norm(400.0, 10.0)),
        ("{kind: normal, mean: 1300, sigma: 4}", stats.norm(1300.0, 4.0)),
        ("{kind: uniform, low: 1200, high: 1300}", stats.uniform(1200.0, 100.0)),
        ("{kind: log_normal, median: 1200, sigma_ln: 0.1}", stats.lognorm(0.1, scale=1200.0)),
        (
            "{kind: truncated_normal, mean: 1250, sigma: 20, low: 1240, high: 1300}",
            stats.truncnorm(-0.5, 2.5, 1250.0, 20.0),
        ),
        (
            "{kind: discrete, choices: [1200, 1300], weights: [1, 3]}",
            stats.rv_discrete(values=([1200, 1300], [0.25, 0.75])),
        ),
    ],
)
def test_moments_are_those_of_scipy(tmp_path, kind, expected):
    plan = plan_of(tmp_path, f"    vehicle.mass.entry_kg: {kind}\n")
    assert moments(plan.draws[0]) == pytest.approx((expected.mean(), expected.std()), rel=2e-3)


def test_steps_reach_the_cases(tmp_path):
    """A step of one is one standard deviation; a group is stepped along its covariance."""
    plan = plan_of(
        tmp_path,
        "    vehicle.rcs.thrusters.*.thrust_n: {kind: uniform, half_width: 5.0}\n"
        "    initial.speed_m_s: {kind: normal, sigma: 10}\n",
        more="  correlated:\n    - paths: [vehicle.mass.entry_kg, atmosphere.density_factor]\n"
        "      covariance: [[100.0, 0.4], [0.4, 0.01]]\n",
    )
    found = sources(plan)
    assert [source.name for source in found] == [
        "initial.speed_m_s",
        "vehicle.mass.entry_kg and 1 more",
        "vehicle.rcs.thrusters.*.thrust_n",
    ]
    signs = np.array(list(product((-1.0, 1.0), repeat=3)))
    steps = np.hstack([signs, np.ones((8, found[2].width))])
    flown = list(cases(plan, found, steps))
    truth = [case.truth for case in flown]
    group = np.array([[one["vehicle.mass.entry_kg"], one["atmosphere.density_factor"]] for one in truth])
    assert np.cov(group.T, bias=True) == pytest.approx(np.array([[100.0, 0.4], [0.4, 0.01]]))
    assert {round(one["initial.speed_m_s"], 6) for one in truth} == {4790.0, 4810.0}
    thrust = "vehicle.rcs.thrusters.A1.thrust_n"
    nominal = next(t.nominal for draw in plan.draws for t in draw.targets if t.path == thrust)
    assert truth[0][thrust] == pytest.approx(nominal + 5.0 / np.sqrt(3.0), rel=1e-3)
    profiles = [case.profile for case in flown]
    assert len(set(profiles)) == 8 and min(profiles) >= plan.count
    assert len({case.profile for case in cases(plan, found, steps, own_profiles=False)}) == 1


def test_sensitivities_of_a_straight_entry_are_those_of_allen_and_eggers(tmp_path):
    """Peak load goes with V^2 alone, peak dynamic pressure with V^2 m, peak heat flux with V^3 sqrt(m).

    Source: Allen and Eggers, NACA report 1381 (1958); Sutton and Graves, NASA TR R-376 (1971).
    """
    plan = plan_of(
        tmp_path,
        "    initial.speed_m_s: {kind: normal, sigma: 24}\n"
        "    vehicle.mass.entry_kg: {kind: normal, sigma: 2}\n"
        "    atmosphere.density_factor: {kind: normal, sigma: 0.02}\n",
    )
    event = figures_at("entry")
    alone = fly_alone(plan, event, workers=1)
    speed, heavy, thick = alone.slopes[:, :3]
    load, pressure, flux = fly_covariance(plan, event, 8, workers=1).spread.mean[:3]
    v, m = 24.0 / 4800.0, 2.0 / 400.0
    assert speed == pytest.approx([2 * v * load, 2 * v * pressure, 3 * v * flux], rel=2e-3)
    assert heavy == pytest.approx([0.0, m * pressure, 0.5 * m * flux], rel=2e-3, abs=1e-5 * load)
    assert thick / [load, pressure, flux] == pytest.approx([0.0, 0.0, 0.0], abs=1e-5)


@pytest.mark.parametrize(
    ("lines", "more", "words"),
    [
        (
            "    initial.speed_m_s: {kind: normal, sigma: 1}\n",
            "sweep: {axes: [{path: wind.scale, values: [0, 1]}]}\n",
            "leave out sweep",
        ),
        ("    {}\n", "", "has no dispersions"),
        (
            "    atmosphere.model: {kind: discrete, choices: [exponential, table]}\n",
            "",
            "has values that are no numbers",
        ),
    ],
)
def test_what_has_no_covariance_is_refused(tmp_path, lines, more, words):
    with pytest.raises(ConfigError, match=words):
        fly_covariance(plan_of(tmp_path, lines, more=more), figures_at("entry"), 8, workers=1)


def test_an_event_that_does_not_come_is_refused(tmp_path):
    plan = plan_of(tmp_path, "    initial.speed_m_s: {kind: normal, sigma: 1}\n")
    with pytest.raises(ConfigError, match="24 of 24 flights do not come to the event"):
        fly_covariance(plan, figures_at("parachute"), 8, workers=1)
    with pytest.raises(ConfigError, match="--at: must be entry, parachute"):
        figures_at("landing")
