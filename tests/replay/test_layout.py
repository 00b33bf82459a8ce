"""The pages of a replay: axes that fit their curves, legends that cover none, one unit for each quantity, and
pictures of the tour without teaching aids and without the controls of the viewer.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from edl6dof.replay import pages
from edl6dof.replay.charts import drawn, framed, frames, legend, legend_share, shown
from edl6dof.replay.lanes import READOUT
from edl6dof.replay.recording import history
from edl6dof.replay.scene.poses import Motion
from edl6dof.report.document import printed
from edl6dof.telemetry.columns import describe

rr = pytest.importorskip("rerun")


@pytest.fixture(scope="module")
def flight(nominal):
    """A real flight, in place of the made-up one."""
    return history(nominal)


@pytest.fixture(scope="module")
def layout(flight):
    from edl6dof.replay.blueprint import Layout

    return Layout([flight], Motion(flight), rr.RecordingStream("edl6dof"), ("",))


def views(part: Any) -> Iterator[Any]:
    """All views below a container."""
    if hasattr(part, "class_identifier"):
        yield part
    else:
        for one in part.contents:
            yield from views(one)


def pages_of(blueprint: Any) -> dict[str, list[Any]]:
    """The views of each page by its name."""
    return {page.name: list(views(page)) for page in blueprint.root_container.contents}


def test_axes_fit_their_curves_and_no_legend_covers_one(flight, layout):
    plots = {plot.key: plot for plot in shown(flight)}
    found = frames([flight], {"Flight": layout.span, **layout.spans}, ("",))
    assert len(found) > 20
    for (page, key), frame in found.items():
        first, last = {"Flight": layout.span, **layout.spans}[page]
        t, curves = drawn(plots[key], flight)
        inside = (t >= first) & (t <= last)
        across, up = (t[inside] - first) / (last - first), curves[inside]
        low, high = frame.axis
        values = up[np.isfinite(up)]
        assert low <= values.min() and values.max() <= high, (page, key)
        names = legend(plots[key], "")
        if len(names) == 1:
            assert np.ptp(np.append(values, 0.0 if low <= 0.0 <= high else values[0])) > 0.5 * (high - low), (
                key
            )
            continue
        count = sum(plot.key in plots for plot in pages.PAGES[page])
        width, height = legend_share(page, count, names)
        share = (up - low) / (high - low)
        beside = across < width if frame.corner.startswith("Left") else across > 1.0 - width
        level = share > 1.0 - height if frame.corner.endswith("Top") else share < height
        assert not np.any(level[beside]), (page, key, frame)


def test_the_heights_of_several_flights_have_a_short_legend(flight):
    alone, among = ({plot.key: plot for plot in shown(flight, several)} for several in (False, True))
    assert len(legend(alone["altitude"], "")) > 1 == len(legend(among["altitude"], "one"))
    assert alone.keys() == among.keys()


@pytest.mark.parametrize("whole", [(0.0, 4.8), (-3.0, 100.0), (7.9, 8.1), (-1.0, -0.2)])
@pytest.mark.parametrize("height", [0.2, 0.6])
def test_an_axis_is_extended_where_every_corner_is_taken(whole, height):
    frame = framed(whole, whole, whole, height)
    (low, high), (first, last) = whole, frame.axis
    room = last - high if frame.corner.endswith("Top") else low - first
    assert room / (last - first) >= height - 1e-5


def test_the_viewer_fits_the_axes_of_fast_processes_to_what_it_shows_before_the_legend(layout):
    shown_by = pages_of(layout.blueprint())
    for page, near in pages.AROUND_NOW.items():
        plots = [view for view in shown_by[page] if view.class_identifier == "TimeSeries"]
        for view in plots:
            assert "ScalarAxis" not in view.properties and "VisibleTimeRanges" in view.properties
        if not plots:  # nothing was diagnosed
            assert page == pages.THRUSTERS
            continue
        key = pages.PAGES[page][0].key
        names = legend(layout.plots[key], "")
        width = legend_share(page, len(plots), names)[0] if len(names) > 1 else 0.0
        seen = layout._window(near, (1.0 - 2.0 * width) * near).ranges.as_arrow_array().to_pylist()
        assert plots[0].properties["VisibleTimeRanges"].ranges.as_arrow_array().to_pylist() == seen


def test_a_quantity_has_one_unit_in_plots_and_readout():
    for page, plots in pages.PAGES.items():
        for plot in plots:
            for channel in plot.curves:
                if channel in READOUT and READOUT[channel].unit:
                    assert f"({READOUT[channel].unit}" in plot.label.replace("Earth ", ""), (page, channel)
                    assert READOUT[channel].unit == printed(describe(channel)[0])


def test_beams_of_the_radar_are_shown_on_the_page_about_them_alone(layout):
    beams = "- /site/vehicle/beams/**"
    for page, shown_there in pages_of(layout.blueprint()).items():
        scenes = [view for view in shown_there if view.class_identifier == "3D" and view.origin != "/globe"]
        site = [view for view in scenes if "/site/**" in view.contents]
        assert all((beams in view.contents) != (page == pages.NAVIGATION) for view in site), page
        assert site or page == pages.THRUSTERS or page == "Control"


def test_a_picture_of_the_tour_has_no_control_of_the_viewer(layout):
    picture = layout.blueprint(pages.TOUR, bare=True)
    assert (picture.time_panel.state, picture.top_panel.state) == ("hidden", "hidden")
    seen = list(views(picture.root_container))
    assert len(seen) == 2 and all(view.titlebar is False for view in seen)
    assert "- /site/hazards/**" in seen[0].contents
    assert len(list(views(layout.blueprint("Entry", bare=True).root_container))) > 9
    assert layout.blueprint(pages.TOUR).time_panel.state == "collapsed"
