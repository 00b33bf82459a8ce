"""Constant and random uncertainties separated by one campaign: closed forms of a linear margin, and the
command.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from campaign_run import write_drop
from scipy.integrate import quad
from scipy.stats import norm

from edl6dof.campaign.assurance import share_bounds
from edl6dof.campaign.constants import flights_to_separate, separate

LIMIT = "limits: {entry_dynamic_pressure_pa: 900.0}\n"


@pytest.mark.parametrize(
    "flights, constants, effect, limit",
    [(1000, 37, 0.8, 2.5), (1000, 37, 0.3, 2.0), (600, 5, 0.8, 1.5), (300, 5, 0.6, 2.0), (300, 5, 0.0, 1.5)],
)
def test_share_at_the_worst_constants_of_a_linear_margin(flights, constants, effect, limit):
    """The margin is limit - effect s - r e with standard normal s (a sum of constants) and e, and variance 1:
    with constants at s, a share Phi((limit - effect s) / r) of the flights meets the requirement.
    """
    rng, random, found = np.random.default_rng(1), np.sqrt(1.0 - effect**2), []
    for _ in range(100):
        values = rng.normal(size=(flights, constants))
        s = values[:, :5].sum(axis=1) / np.sqrt(5.0)
        found.append(separate(7.0 + 3.0 * values, limit - effect * s - random * rng.normal(size=flights)))
    edge = norm.cdf((limit - effect * norm.ppf(0.9)) / random)
    tail = quad(lambda s: norm.cdf((limit - effect * s) / random) * norm.pdf(s), norm.ppf(0.9), 9.0)[0] / 0.1
    demonstrated = [share_bounds(one.failures, one.flights, 0.9)[0] for one in found]
    assert np.mean(np.array(demonstrated) <= edge) >= 0.9
    assert all(one.flights == flights // 10 for one in found)
    assert np.mean([one.failures for one in found]) / (flights // 10) == pytest.approx(1 - tail, abs=0.02)
    assert (
        -0.02 <= 1.0 - np.mean([one.moved_failures for one in found]) / flights - edge <= 0.005 or not effect
    )
    assert np.mean([one.explained for one in found]) == pytest.approx(effect**2, abs=0.01)


def test_a_curved_effect_is_found_with_enough_flights():
    rng = np.random.default_rng(2)
    values = rng.normal(size=(400, 3))
    margins = 2.0 - values[:, 0] ** 2 + 0.3 * rng.normal(size=400)
    many, few = separate(values, margins), separate(values[:100], margins[:100])
    assert many.explained > 0.9 and many.failures == 40
    assert few.explained < 0.5


def test_failures_without_a_figure_count_and_few_flights_are_refused():
    rng = np.random.default_rng(3)
    values = rng.normal(size=(200, 2))
    margins = 10.0 - values[:, 0] + 0.1 * rng.normal(size=200)
    lost = values[:, 0] > 1.5
    one = separate(values, np.where(lost, -np.inf, margins))
    assert one.moved_failures == lost.sum() and 15 <= one.failures <= one.flights == 20
    assert flights_to_separate(2) == 40
    assert separate(values[:39], margins[:39]) is None and separate(values[:40], margins[:40]) is not None
    assert separate(values, np.full(200, -np.inf)) is None


def test_the_page_separates_the_constants_of_the_plan(edl6dof, tmp_path):
    file = Path(write_drop(tmp_path))
    plain = LIMIT + file.read_text()
    file.write_text(plain.replace("  seed: 3", "  seed: 3\n  constant: [vehicle.mass.*, wind.scale]"))
    status, _, err = edl6dof("campaign", str(file), "-q")
    assert status == 2 and "campaign.constant.1: no dispersed parameter is called wind.scale" in err
    for constant, share in (("vehicle.mass.entry_kg", 0.0), ("atmosphere.*", 1.0)):
        file.write_text(plain.replace("  seed: 3", f"  seed: 3\n  constant: [{constant}]"))
        assert edl6dof("campaign", str(file), "-n", "60", "-q", "--force")[0] == 0
        assert f"Constant but unknown: {constant}." in edl6dof("assure", "runs/drops")[1]
        found = json.loads(edl6dof("assure", "runs/drops", "--json")[1])
        apart = found["requirements"][0]["constants_at_worst"]
        assert apart["explained"] == pytest.approx(share, abs=0.05)
        assert apart["flights"] == 10 and apart["failures"] == 0
        assert not any("does not separate" in words for words in found["notes"])
    assert edl6dof("campaign", str(file), "-n", "19", "-q", "--force")[0] == 0
    assert "Too few flights: 1 constant would need 20." in edl6dof("assure", "runs/drops")[1]
