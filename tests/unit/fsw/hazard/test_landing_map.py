"""The landing map of a flight: what it tells, and its file written and read back."""

import io

import numpy as np
import pytest
from test_detection import SITE, Lander

from edl6dof.runs.run import LANDING_MAP, read_landing_map, write_landing_map
from edl6dof.telemetry.landing_map import LandingMap, landing_map


@pytest.fixture(scope="module")
def chosen():
    fsw = Lander(stones=[(SITE[1], SITE[0], 1.0)]).fsw
    fsw["hazard"]["spot_t"] = np.nan
    assert landing_map(fsw) is None
    lander = Lander(stones=[(SITE[1], SITE[0], 1.0)])
    lander.scan()
    return landing_map(lander.fsw)


def test_map_tells_what_was_seen_and_chosen(chosen):
    assert chosen.elevation_m.shape == chosen.cell_class.shape == (256, 256)
    assert chosen.cell_m == pytest.approx(0.2) and chosen.hover_m[2] == pytest.approx(100.0)
    assert chosen.corner_m + 25.6 == pytest.approx(SITE, abs=0.3)
    assert np.hypot(*(chosen.spot_m - SITE)) > 2.4 and chosen.found
    assert chosen.reasons() == ["rock"]
    assert np.nanmax(chosen.elevation_m) == pytest.approx(0.5, abs=0.05)


def test_file_holds_the_map_and_no_more_than_numbers(chosen, tmp_path):
    write_landing_map(chosen, tmp_path)
    content = (tmp_path / LANDING_MAP).read_bytes()
    for written, read in zip(chosen, read_landing_map(content), strict=True):
        np.testing.assert_array_equal(written, read)
    write_landing_map(chosen, tmp_path)
    assert (tmp_path / LANDING_MAP).read_bytes() == content


@pytest.mark.parametrize(
    "planted",
    [{"spot_m": np.array([{}, {}])}, {"cell_class": np.zeros((2000, 2000))}, {"found": np.array("x")}],
)
def test_file_with_anything_else_is_refused(chosen, planted):
    file = io.BytesIO()
    np.savez(file, **{**chosen._asdict(), **planted})
    with pytest.raises(ValueError, match="is no landing map"):
        read_landing_map(file.getvalue())


def test_file_that_is_cut_or_lacks_an_array_is_refused(chosen):
    file = io.BytesIO()
    np.savez(file, **{name: chosen._asdict()[name] for name in LandingMap._fields[1:]})
    for content in (file.getvalue(), file.getvalue()[:1000], b""):
        with pytest.raises(ValueError, match="is no landing map"):
            read_landing_map(content)
