"""The report's page of hazards against the map that the lander made."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest

import edl6dof
from edl6dof.manifest import seal
from edl6dof.report.catalogue import CELLS
from edl6dof.report.flight import landing
from edl6dof.report.flight.flight_report import flight_report
from edl6dof.runs.run import Run, write_run
from edl6dof.telemetry.landing_map import CELL_CLASSES


@pytest.fixture(scope="module")
def seen(tmp_path_factory):
    folder = tmp_path_factory.mktemp("runs") / "hazards"
    folder.mkdir()
    write_run(edl6dof.fly("tianwen1_hazards", ["terrain.landing_area.rock_abundance=0.1"]), folder)
    seal(folder, "flight")
    return Run(folder)


@pytest.fixture(scope="module")
def drawn(seen):
    return {figure.key: figure for figure in landing.hazard_maps(seen)}


def named(panel):
    return {trace.name: trace for trace in panel.traces}


def test_colours_are_the_classes(seen, drawn):
    safety_map = drawn["hazard_map"].panels[0].heat
    kinds = list(CELLS)
    every = len(seen.landing_map.cell_class) // len(safety_map.x)
    counted = Counter(CELL_CLASSES[int(one)] for one in seen.landing_map.cell_class[::every, ::every].ravel())
    shown = Counter(kinds[int(one)] for one in safety_map.values.ravel())
    assert shown == counted
    assert len(shown) >= 3


def test_lander_goes_from_the_hover_to_the_chosen_footprint(seen, drawn):
    traces = named(drawn["hazard_map"].panels[0])
    way, ring = traces["way, as navigated"], traces["chosen footprint"]
    middle = np.array([ring.x[:-1].mean(), ring.y[:-1].mean()])
    assert np.allclose(middle, seen.landing_map.spot_m, atol=1e-6)
    assert np.hypot(way.x[0] - seen.landing_map.hover_m[0], way.y[0] - seen.landing_map.hover_m[1]) < 1.0
    assert np.hypot(way.x[-1] - middle[0], way.y[-1] - middle[1]) < 1.5
    touchdown = traces["touchdown"]
    assert np.hypot(touchdown.x[0] - way.x[-1], touchdown.y[0] - way.y[-1]) < 0.1


def test_words_count_what_was_passed_over(seen, drawn):
    reasons = Counter(seen.landing_map.reasons())
    caption = drawn["hazard_map"].caption
    for name, count in reasons.items():
        assert f"{count} for {name}" in caption


def test_words_say_what_the_nearest_safe_spot_lacks(seen, drawn):
    found = seen.landing_map
    rows, columns = np.nonzero(found.cell_class == CELL_CLASSES.index("safe"))
    places = found.corner_m + (np.column_stack([columns, rows]) + 0.5) * found.cell_m
    away = np.hypot(*(places - found.hover_m[:2]).T)
    first = np.argmin(away)
    clear = found.clearance_m[rows[first], columns[first]]
    told = f"The nearest safe one, {away[first]:.1f} m away, is clear of unsafe ones by {clear:.1f} m only"
    assert told in drawn["hazard_map"].caption


def test_coarse_choice_takes_a_part_of_the_image(seen, drawn):
    traces = named(drawn["coarse_choice"].panels[0])
    parts, taken = traces["parts of the image"], traces["part taken"]
    assert len(parts.x) in (2, 4)
    assert (taken.x[0], taken.y[0]) in set(zip(parts.x.tolist(), parts.y.tolist(), strict=True))


def test_coarse_choice_without_a_part_says_so(seen):
    found = seen.landing_map._replace(coarse_part=np.array(-1))
    figure = landing.coarse_choice(seen, found)
    assert len(named(figure.panels[0])["part taken"].x) == 0
    assert (
        "None was" in figure.caption
        and "None was" not in landing.coarse_choice(seen, seen.landing_map).caption
    )


def test_flight_without_a_scan_has_no_such_page(run):
    assert "hazards" not in {section.key for section in flight_report(run).sections}
