"""The comparison of landings among rocks: what is expected of blind ones, what is counted, and that a small
run comes out whole.
"""

from math import exp, inf

import numpy as np
import pytest
from scipy.special import exp1

from edl6dof.fsw.hazard.registry import HAZARD_DETECTION
from edl6dof.studies import hazards


@pytest.mark.parametrize("abundance, printed", [(0.04, 0.094), (0.1, 0.467)])
def test_blind_share_is_that_of_golombeks_law(abundance, printed):
    """Printed values, and the integral of exp(-q x) / x^2 by parts with the exponential integral."""
    q, least = 1.79 + 0.152 / abundance, 0.5
    per_m2 = 4.0 * q * abundance / np.pi * (exp(-q * least) / least - q * exp1(q * least))
    assert hazards.blind_share(abundance) == pytest.approx(1.0 - exp(-12.6 * per_m2), rel=1e-6)
    assert hazards.blind_share(abundance) == pytest.approx(printed, abs=6e-4)


def test_all_ways_of_detection_meet_the_same_ground_and_flights():
    assert hazards.STUDY.parts == HAZARD_DETECTION.names
    blind, looking = (hazards.cases(0.1, way, 5) for way in ("given", "lidar"))
    for one, other in zip(blind, looking, strict=True):
        assert (one.index, one.truth, one.belief, one.profile) == (
            *(other.index, other.truth, other.belief, other.profile),
        )
    assert [one.profile for one in blind] == [0, 1, 2, 3, 4]


def row(**figures):
    return {"abundance": 0.1, "way": "lidar", "success": True, "outcome": "", "cause": "", **figures}


def test_a_flight_that_does_not_come_down_counts_as_one_on_a_rock():
    rows = [row(rocks_under_lander=0.0, touchdown_s=1.0)] * 3
    assert hazards.on_a_rock(rows) == 0.0
    assert hazards.on_a_rock([*rows, row(rocks_under_lander=2.0)]) == 25.0
    assert hazards.on_a_rock([*rows, row()]) == 25.0


def test_targets_are_missed_by_what_breaks_them():
    good = row(rocks_under_lander=0.0, touchdown_s=1.0, spot_miss_m=0.4, spot_false_safe=0.0)
    good["min_drift_distance_m"] = 90.0
    assert all(finding.ok for finding in hazards.findings([good] * 100))
    for name, value in (
        ("rocks_under_lander", 1.0),
        ("spot_false_safe", 1.0),
        ("spot_miss_m", inf),
        ("min_drift_distance_m", 49.0),
        ("touchdown_s", inf),
    ):
        bad = [{**good, name: value}] * 6
        assert sum(not finding.ok for finding in hazards.findings([*[good] * 94, *bad])) == 1, name


def test_small_run_comes_out_whole(monkeypatch):
    monkeypatch.setattr(hazards, "ABUNDANCES", (0.1,))
    seen = []
    report = hazards.STUDY.fly(1, ("given", "lidar"), lambda done, total: seen.append((done, total)))
    assert report.runs == len(report.rows) == 2 and seen[-1] == (2, 2)
    blind, looking = report.rows
    assert blind.get("spot_found") is None and looking["spot_found"] in (0.0, 1.0)
    assert looking["spot_miss_m"] < 5.0
    grid, spot = report.grids
    assert spot.rows == (("lidar", 1.0),)
    assert [line[0] for line in grid.rows] == ["given", "lidar"]
    labels = [finding.label for finding in report.findings]
    assert "10 %: blind landings on a rock" in labels and "10 %, lidar: landings on a rock" in labels
    assert list(report.pictures) == ["comparison"]


def test_ways_differ_in_what_detects_hazards_alone():
    blind, looking = (hazards.over(0.2, way).scenario for way in ("given", "lidar"))
    assert blind.terrain.landing_area.rock_abundance == 0.2
    assert blind.flight_software.hazard.detection == "given"
    hazard = looking.flight_software.hazard.model_copy(update={"detection": "given"})
    software = looking.flight_software.model_copy(update={"hazard": hazard})
    assert looking.model_copy(update={"flight_software": software}) == blind
