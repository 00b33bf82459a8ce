"""A flight that records only what its figures need is the same flight, with the same figures to the last
bit.
"""

from __future__ import annotations

import numpy as np
import pytest

from edl6dof.sim.flight import fly, log_rows
from edl6dof.telemetry.channels import BRIEF, BRIEF_CHANNELS, TICK
from edl6dof.telemetry.columns import Telemetry


@pytest.fixture(scope="module")
def brief(nominal):
    return fly(nominal.loaded, log=np.full(log_rows(nominal.loaded), np.nan, BRIEF))


def test_every_channel_is_that_of_the_whole_telemetry(nominal, brief):
    assert len(brief.log) == len(nominal.log)
    assert list(brief.telemetry) == ["t_s", *(channel.name for channel in BRIEF_CHANNELS)]
    for name, column in brief.telemetry.items():
        assert column.tobytes() == nominal.telemetry[name].tobytes(), name


def test_flight_and_figures_are_the_same(nominal, brief):
    assert brief.plant.tobytes() == nominal.plant.tobytes()
    assert brief.fsw.tobytes() == nominal.fsw.tobytes()
    assert brief.figures == nominal.figures
    assert brief.events == nominal.events
    assert (brief.success, brief.outcome, brief.cause) == (nominal.success, nominal.outcome, nominal.cause)


def test_channels_that_were_not_recorded_are_refused(brief):
    with pytest.raises(KeyError):
        brief.telemetry["truth.tilt_deg"]
    with pytest.raises(KeyError):
        brief.telemetry["rcs.D1"]
    assert BRIEF.itemsize < TICK.itemsize / 4


@pytest.fixture(params=[1, 2, 65, 1001])
def rows(request):
    """Numbers in the words of a log, the angles among them within a right angle."""
    return np.random.default_rng(request.param).uniform(-1.5, 1.5, (request.param, TICK.itemsize // 8))


def of(rows):
    return Telemetry(rows.view(TICK)[:, 0], ())


def test_longest_vector_and_nearest_places_are_those_of_the_columns(rows):
    telemetry, angles = of(rows), ("control.error_pitch_deg", "control.error_yaw_deg")
    length = np.linalg.norm([telemetry[name] for name in angles], axis=0)
    assert telemetry.largest(*angles) == max(np.abs(telemetry[name]).max() for name in angles)
    assert telemetry.longest(*angles) == pytest.approx(length.max(), rel=1e-14)
    place, other = (
        [f"truth.{body}_{axis}_m" for axis in ("east", "north", "up")] for body in ("site", "backshell")
    )
    telemetry[other[0]][::3] = np.nan  # a place that is not always known
    apart = np.linalg.norm(
        [telemetry[one] - telemetry[two] for one, two in zip(place, other, strict=True)], axis=0
    )
    found = telemetry.nearest(place, other)
    assert np.isnan(found) if np.isnan(apart).all() else found == pytest.approx(np.nanmin(apart), rel=1e-14)


SWING = ("truth.rate_r_deg_s", "truth.rate_p_deg_s", "truth.alpha_deg")


def test_fastest_swing_is_what_banking_leaves_and_sees_what_is_no_number(rows):
    telemetry = of(rows)
    rate, roll, angle = (telemetry[name] for name in SWING)
    expected = np.max(np.abs(rate - roll * np.tan(np.radians(angle))))
    assert telemetry.fastest_swing(*SWING) == pytest.approx(expected, rel=1e-13)
    telemetry._log["truth"]["rate_r"][0] = np.nan
    assert np.isnan(telemetry.fastest_swing(*SWING)) and np.isnan(telemetry.largest(*SWING))


def test_extremes_of_nothing_are_no_numbers():
    nothing = of(np.zeros((0, TICK.itemsize // 8)))
    assert np.isnan(
        [nothing.nearest(["truth.mach"], ["guide.bank_deg"]), nothing.fastest_swing(*SWING)]
    ).all()


def test_peaks_are_the_largest_of_the_telemetry(nominal):
    """Every cycle is logged in the nominal flight, so what the vehicle met is what was logged."""
    flight, figures = nominal.telemetry, nominal.figures
    load, hangs = flight["truth.load_g0"], np.isfinite(flight["truth.canopy_up_m"])
    assert figures["peak_load_g0"] == np.max(load[: hangs.argmax()])
    assert figures["max_load_parachute_g0"] == np.max(load[hangs])
    assert 5.0 < figures["peak_load_g0"] < 6.5 < figures["max_load_parachute_g0"]
    assert figures["peak_dynamic_pressure_pa"] == np.max(flight["truth.dynamic_pressure_pa"])
    assert figures["peak_heat_flux_w_cm2"] == pytest.approx(
        np.max(flight["truth.heat_flux_w_cm2"]), rel=1e-15
    )
    assert figures["max_riser_tension_n"] == np.max(flight["truth.riser_tension_n"])


def test_values_between_rows_lie_on_straight_lines_and_are_held_beyond_the_ends(nominal):
    flight, names = nominal.telemetry, ("truth.mach", "truth.height_m", "control.error_roll_deg")
    for t in (0.0, 100.013, 277.2561, nominal.time_s, nominal.time_s + 5.0):
        assert flight.at(t, *names) == pytest.approx(
            [np.interp(t, flight["t_s"], flight[name]) for name in names], rel=1e-12
        )
    assert flight.rows(7, 8).at(1.0, "truth.mach") == [flight["truth.mach"][7]]
