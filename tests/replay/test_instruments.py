"""What a replay shows of a flight on instruments: rays of the radar, lanes, events, errors with bounds."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from made_up import (
    BEAM_EXCLUDED,
    GYRO_EXCLUDED,
    LOCK,
    REFUSED,
    SATURATED,
    flight_on_instruments,
    read,
    synthetic_flight,
)

from edl6dof.replay.pages import NAVIGATION, PAGES
from edl6dof.replay.recording import history, write_replay
from edl6dof.replay.scene.sensing import RAYS
from edl6dof.telemetry.columns import EXCLUDED, NOT_USED, USED

pytest.importorskip("rerun")

#: Two of the radar's rows, and one of the replay's.
STEP = 0.09


@pytest.fixture(scope="module")
def flight() -> SimpleNamespace:
    return flight_on_instruments()


def rgb(colour: int) -> tuple[int, ...]:
    return tuple((colour >> shift) & 255 for shift in (24, 16, 8))


def test_a_ray_is_as_long_as_its_range_and_points_along_its_beam(flight, replay):
    times, columns = read(replay, "/site/vehicle/beams")
    radar = flight.scenario.sensors.radar
    assert times[0] == pytest.approx(LOCK, abs=STEP)
    for k in (0, len(times) // 2, len(times) - 2):
        row = int(np.argmin(np.abs(flight.telemetry["t_s"] - times[k])))
        strips = np.array(columns["LineStrips3D:strips"][k])
        assert np.allclose(strips[:, 0], radar.position_m, atol=1e-4)
        for (start, end), beam in zip(strips, radar.beams, strict=True):
            along = end - start
            length = flight.telemetry[f"range.{beam.name}_m"][row]
            assert np.linalg.norm(along) == pytest.approx(length, rel=1e-5)
            assert np.allclose(along / length, beam.axis, atol=1e-5)
    assert columns["LineStrips3D:strips"][-1] in (None, []), "no echo, no ray"
    assert times[-1] == pytest.approx(19.0, abs=STEP)


def test_colour_of_a_ray_is_what_navigation_makes_of_it(replay):
    times, columns = read(replay, "/site/vehicle/beams")
    colours = columns["LineStrips3D:colors"]

    def seen(t: float) -> list[tuple[int, ...]]:
        return [rgb(one) for one in colours[int(np.searchsorted(times, t))]][:4]  # of the first radar

    used, refused, excluded = RAYS[USED], RAYS[NOT_USED], RAYS[EXCLUDED]
    assert seen(LOCK + 1.0) == [used] * 4
    assert seen(REFUSED + 1.0) == [used, refused, used, used]
    assert seen(BEAM_EXCLUDED + 1.0) == [used, refused, used, excluded]


def test_lanes_change_with_the_telemetry(replay):
    def lane(name: str) -> list[tuple[float, str]]:
        times, columns = read(replay, f"/{name}")
        states = [cell[0] for cell in columns["StateChange:state"]]
        return list(zip(np.round(times, 1).tolist(), states, strict=True))

    def at(*changes: tuple[float, str]) -> list:
        return [(pytest.approx(t, abs=STEP), state) for t, state in changes]

    first, last = SATURATED
    common = ((0.0, "in use"), (first, "saturated"), (last, "in use"))
    assert lane("Gyro-g1") == at(*common)
    assert lane("Gyro-g3") == at(*common, (GYRO_EXCLUDED, "excluded"))
    assert lane("Accelerometer-a6") == at((0.0, "in use"))
    assert lane("Beam-b2") == at((0.0, "off"), (LOCK, USED), (REFUSED, NOT_USED), (19.0, "off"))
    assert lane("Beam-b4") == at((0.0, "off"), (LOCK, USED), (BEAM_EXCLUDED, "excluded"))


def test_exclusion_is_a_warning_and_stands_in_the_readout(flight, replay):
    times, columns = read(replay, "/events")
    k = int(np.searchsorted(times, GYRO_EXCLUDED))
    assert times[k] == GYRO_EXCLUDED
    assert "| **warning: gyro g3 excluded** |" in columns["TextDocument:text"][k][0]
    times, columns = read(replay, "/readout")
    told = ["**excluded:** g3" in cell[0] for cell in columns["TextDocument:text"]]
    assert told == (times > GYRO_EXCLUDED - 1e-6).tolist() and True in told and False in told


def test_errors_stand_between_three_claimed_sigmas(flight, replay):
    times, columns = read(replay, "/plots/nav_height_m")
    rows = np.searchsorted(flight.telemetry["t_s"], times - 1e-6)
    error, sigma = (flight.telemetry[f"nav.{name}_height_m"][rows] for name in ("error", "sigma"))
    wanted = np.stack([error, 3.0 * sigma, -3.0 * sigma], axis=-1)
    assert np.allclose(np.array(columns["Scalars:scalars"]), wanted, rtol=2e-7, atol=0.0)  # single precision


def test_perfect_sensors_leave_no_trace(tmp_path):
    from rerun.chunk import RrdReader

    path = tmp_path / "perfect.rrd"
    write_replay([history(synthetic_flight())], path)
    held = {c.entity_path for c in RrdReader(path).stream().collect().schema().component_columns()}
    own = {f"/plots/{plot.key}" for plot in PAGES[NAVIGATION]} | {"/site/vehicle/beams"}
    assert not held & own and not any(name.startswith(("/Gyro", "/Accelerometer", "/Beam")) for name in held)


def test_a_recording_without_ranges_has_neither_rays_nor_lanes_of_beams(tmp_path):
    """As of a run folder of a version that did not record them."""
    flight = flight_on_instruments()
    for beam in flight.scenario.beam_names:
        del flight.telemetry[f"range.{beam}_m"]
    write_replay([history(flight)], tmp_path / "old.rrd")
    assert len(read(tmp_path / "old.rrd", "/site/vehicle/beams")[0]) == 0
    assert len(read(tmp_path / "old.rrd", "/Gyro-g1")[0]) > 1
