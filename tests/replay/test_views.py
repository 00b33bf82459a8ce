"""What the views tell in words and figures: names of arrows that stand clear, axes with ticks, lanes whose
names fit, a readout of what counts.
"""

from __future__ import annotations

import re
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from made_up import END, MORTAR, SHELL, flight_on_instruments, read, synthetic_flight

from edl6dof.replay.charts import axis_range
from edl6dof.replay.lanes import fitted
from edl6dof.replay.pages import body_eye
from edl6dof.replay.recording import history, recorded_span, write_replay
from edl6dof.replay.scene.arrows import COVERED, Label, forces, laid_out, scales, screen
from edl6dof.replay.scene.poses import Motion
from edl6dof.report.catalogue import BANK, RANGE, RATES

RrdReader = pytest.importorskip("rerun.chunk").RrdReader


def overlaps(middles: np.ndarray, halves: np.ndarray) -> bool:
    """Whether any two boxes overlap by more than rounding."""
    apart = np.abs(middles[:, None] - middles[None]) - (halves[:, None] + halves[None])
    return bool(np.any(np.triu(np.all(apart < -1e-3, axis=-1), 1)))


def test_names_of_arrows_and_axes_stand_clear_of_the_vehicle_and_of_each_other(flight, replay):
    motion = Motion(history(flight))
    size = motion.shape.size
    plane = screen(body_eye(motion.centre[0], motion.last, size))
    times, columns = read(replay, "/site/near/arrows/names")
    seen = 0
    for t, labels, places in zip(
        times, columns["Points3D:labels"], columns["Points3D:positions"], strict=True
    ):
        middles = plane.seen(np.array(places)) + plane.below
        halves = np.array([plane.box(len(label)) for label in labels])
        assert not overlaps(middles, halves), t
        nearest = np.linalg.norm(np.maximum(np.abs(middles) - halves, 0.0), axis=-1)
        assert nearest.min() > 0.99 * COVERED * size, t
        words = [label.split()[0] for label in labels]
        assert "velocity" in words and ("thrust" in words) == (t > SHELL + 0.01), t
        seen += len(labels)
    assert seen > 4 * len(times), "most axes can be named"


def test_labels_that_all_point_the_same_way_are_moved_apart_or_left_out():
    plane, rows = screen(np.array([0.0, -6.0, 1.0])), 50
    way = np.array([np.cos(k) for k in range(rows)]), np.array([np.sin(k) for k in range(rows)])
    end = 1.5 * np.stack(way, axis=-1)
    there = np.ones(rows, bool)
    labels = [Label(end, there, 18, True)] * 3 + [Label(end, there, 2, False)]
    places, shown = laid_out(plane, 1.0, labels)
    assert shown[:3].all() and not shown[3].all()
    halves = np.array([plane.box(label.letters) for label in labels])
    for row in range(rows):
        assert not overlaps(places[shown[:, row], row] + plane.below, halves[shown[:, row]])


def test_an_arrow_is_its_force_over_what_a_metre_stands_for(flight, replay):
    thinned = history(flight)
    motion = Motion(thinned)
    rows = np.arange(len(thinned.t))
    thrust = next(arrow for arrow in forces(thinned, motion, rows) if arrow.name == "thrust")
    assert thrust.metre == 1000.0, "3 kN in at most nine tenths of 3.35 m, rounded up to 1, 2, 5, ..."
    times, columns = read(replay, "/site/near/arrows/thrust")
    lengths = [np.linalg.norm(cell[0]) for cell in columns["Arrows3D:vectors"] if cell]
    assert np.allclose(lengths, 3.0, rtol=1e-5)
    assert "1 kN (thrust)" in scales(thinned, motion)


@pytest.mark.parametrize(
    ("low", "high"),
    [
        *(
            (0.0, 8.2),
            (0.0, 91.7),
            (0.0, 4.8),
            (0.0, 5.4),
            (-4.4, 125.0),
            (-0.7, 0.6),
            (-21.0, -2.0),
            (955.0, 1010.0),
        ),
        *((3.0, 3.0), (0.0, 0.0)),
    ],
)
def test_an_axis_holds_its_curve_and_has_two_to_six_ticks(low, high):
    first, last = axis_range(low, high)
    assert first < low and last > high
    steps = [10.0**k for k in range(-6, 6)]
    ticks = [int(np.floor(last / s) - np.ceil(first / s)) + 1 for s in steps]
    assert any(2 <= count <= 6 for count in ticks), ticks
    assert last - first < 3.0 * max(high - low, 1.0 if high == low else 0.0), "not lost on it"


def test_a_command_that_no_law_gives_is_not_drawn():
    zero, some = np.zeros(3), np.array([0.0, np.nan, 1.0])
    flown = BANK.shown({"guide.bank_deg": zero, "truth.bank_deg": some})
    assert (flown.channels, flown.curves) == (("truth.bank_deg",), {"truth.bank_deg": "flown"})
    assert BANK.shown({"guide.bank_deg": some, "truth.bank_deg": zero}) == BANK
    rates = dict.fromkeys(RATES.channels, zero) | {"truth.rate_q_deg_s": some}
    assert RATES.shown(rates) == RATES, "zero of what is flown is told"
    assert RANGE.shown({"guide.range_to_go_km": zero}) is None, "a plot has a curve"


def test_a_name_that_has_no_room_is_shortened_or_left_out_of_its_lane():
    changes = [(0.0, "entry"), (280.0, "parachute"), (450.0, "brief_hover"), (452.0, "landed")]
    names = [name for _, name in changes]
    assert fitted(changes, names, (0.0, 540.0)) == ["entry", "parachute", " ", "landed"]
    assert fitted(changes, names, (445.0, 455.0)) == [" ", "parachute", "brief hover", "landed"]
    assert fitted(changes, names, (440.0, 490.0)) == [" ", "parachute", "brief", "landed"]
    assert fitted(changes, names, (430.0, 500.0)) == [" ", "parachute", "BH", "landed"]


def lanes_by_view(path: Path) -> dict[str, list[str]]:
    """Entities that each view of lanes shows, by the view's name."""
    reader = RrdReader(path)
    (store,) = reader.blueprints()
    held: dict[str, dict[str, list[str]]] = {}
    for chunk in reader.stream(store=store).to_chunks():
        batch = chunk.to_record_batch()
        view = "/".join(str(chunk.entity_path).split("/")[:3])
        names = ("ViewBlueprint:class_identifier", "ViewBlueprint:display_name", "ViewContents:query")
        own = {name: batch.column(name).to_pylist()[-1] for name in names if name in batch.schema.names}
        held.setdefault(view, {}).update(own)
    lanes = [one for one in held.values() if one.get("ViewBlueprint:class_identifier") == ["StateTimeline"]]
    return {one["ViewBlueprint:display_name"][0]: one["ViewContents:query"] for one in lanes}


def test_the_viewer_names_a_lane_by_its_path_which_is_a_plain_name(tmp_path):
    """It offers no other name, and would show a space as a backslash and a space."""
    path = tmp_path / "replay.rrd"
    write_replay([history(flight_on_instruments())], path)
    shown = lanes_by_view(path)
    assert shown["Phases"] == ["/Phase", "/Vehicle", "/Engine"]
    assert shown["Radar beams"] == [f"/Beam-{radar}{k}" for radar in "bc" for k in range(1, 5)]
    assert {"/Gyro-g1", "/Accelerometer-a1"} <= {*shown["Gyros"], *shown["Accelerometers"]}
    assert shown["Thrusters A1 to D7"][0] == "/Thruster-A1"
    every = [name for names in shown.values() for name in names]
    assert [name for name in every if not re.fullmatch(r"/[A-Z][a-z]+(-\w+)?", name)] == []
    states = {
        str(one.entity_path)
        for one in RrdReader(path).stream().collect().schema().component_columns()
        if one.component == "StateChange:state"
    }
    assert states == set(every)


def test_readout_says_what_counts_in_each_stage_ten_times_a_second(flight, replay):
    times, columns = read(replay, "/readout")
    assert np.diff(times).max() < 0.1 + 1e-6
    said = [cell[0] for cell in columns["TextDocument:text"]]

    def fields(t: float) -> dict[str, str]:
        lines = said[int(np.searchsorted(times, t, side="right")) - 1].splitlines()
        cells = [line.strip("| ").split(" | ") for line in lines if line.startswith("| ")]
        return {name: value.replace("*", "") for name, value in cells}

    entry, hanging, powered, landed = (fields(t) for t in (MORTAR - 1.0, MORTAR + 2.0, SHELL + 2.0, END))
    assert {"bank", "heat flux", "Mach", "range to site"} <= entry.keys() and "throttle" not in entry
    assert {"riser tension", "Mach"} <= hanging.keys() and not {"bank", "tilt", "thrust"} & hanging.keys()
    assert {"throttle", "tilt", "thrust"} <= powered.keys() and not {"Mach", "bank"} & powered.keys()
    assert "tilt" in landed and not {"descent rate", "throttle", "load"} & landed.keys()
    full = sum(engine.full_thrust_n for engine in flight.scenario.vehicle.engines)
    assert powered["throttle"] == f"{100.0 * 3000.0 / full:.0f} %"
    t = times[int(np.searchsorted(times, SHELL + 2.0, side="right")) - 1]
    assert float(powered["range to site"].split()[0]) == pytest.approx(
        1e-3 * np.hypot(3.0 * t, 200.0 - 10.0 * t), abs=0.01
    )


def test_legend_speaks_of_what_the_flight_has(tmp_path):
    def told(flight: SimpleNamespace) -> str:
        write_replay([history(flight)], tmp_path / "x.rrd")
        chunks = RrdReader(tmp_path / "x.rrd").stream().filter(content=["/legend"]).to_chunks()
        batch = next(iter(chunks)).to_record_batch()
        return batch.column("TextDocument:text").to_pylist()[0][0]

    perfect, equipped = told(synthetic_flight()), told(flight_on_instruments())
    assert "failed red" in perfect and "radar beams" not in perfect
    assert "| phase HA | hazard avoidance |" in perfect, "initials in short lanes"
    assert "echo used blue" in equipped


def test_times_of_a_recording_are_those_of_its_flight(replay):
    assert recorded_span(replay) == (0.0, pytest.approx(END, abs=0.021))
