"""The sums of the balance against closed forms: free fall, Tsiolkovsky, a separation, an orbit in a field
that turns; and the potential against scipy.
"""

from __future__ import annotations

import numpy as np
import pytest

from edl6dof.config.units import G0
from edl6dof.environment.gravity import potential_F
from edl6dof.scenario import records
from edl6dof.verify.case import (
    BARE,
    ENDLESS,
    FLAT,
    VACUUM,
    WEIGHTLESS,
    Bench,
    doing,
    scenes,
    state_of,
    to_the_end,
)
from edl6dof.verify.planet import potential
from edl6dof.verify.propulsion import BURN, ENGINE_ISP

AT_REST = ("initial.speed_m_s=0", "initial.rate_deg_s=[0, 0, 0]")


def balance(flight):
    return flight.plant["balance"][0]


@pytest.mark.parametrize("model, degree", [("central", 2), ("j2", 2), ("harmonics", 4), ("harmonics", 12)])
def test_potential_is_that_of_the_field(model, degree):
    nominal, loaded = scenes([f"planet.gravity.model={model}", f"planet.gravity.degree={degree}"])
    field = records.build_case(loaded.truth, records.build_tables(loaded.truth))[0]["planet"]["gravity"]
    gravity = nominal.planet.gravity
    rng = np.random.default_rng(11)
    for _ in range(5):
        p = rng.normal(size=3)
        p *= rng.uniform(3.38e6, 3.6e6) / np.linalg.norm(p)
        expected = gravity.mu_m3_s2 / np.linalg.norm(p)
        if model != "central":
            expected += potential(p, degree, gravity.j2 if model == "j2" else None)
        assert potential_F(field, tuple(p)) == pytest.approx(expected, abs=1e-7), "1e-14 of it"


def test_free_fall_gives_gravity_times_time_and_no_work():
    scene = [*BARE, *VACUUM, *FLAT, *ENDLESS, *AT_REST, "simulation.time_limit_s=10"]
    nominal, flight = Bench().flown(scene)
    g = 3.72 / (1.0 + nominal.initial.altitude_m / 1e9) ** 2
    assert np.linalg.norm(balance(flight)["velocity"]) == pytest.approx(10.0 * g, rel=1e-6)
    assert balance(flight)["work"] == 0.0
    assert balance(flight)["lost"] == 0.0


def test_a_burn_gives_what_its_propellant_gives_by_tsiolkovsky():
    _, loaded = scenes([*BURN, "simulation.time_limit_s=20"])
    state = state_of(loaded)
    state.plant["running"][0, 0], state.fsw["command"]["thrust"][0, 0] = 1, 7500.0
    state.fsw["command"]["engine_mode"] = 2
    kept = balance(flight := to_the_end(loaded, state))
    assert kept["lost"] > 40.0
    gained = ENGINE_ISP * G0 * np.log(kept["mass"] / (kept["mass"] - kept["lost"]))
    assert np.linalg.norm(kept["velocity"]) == pytest.approx(gained, rel=1e-5)
    assert max(flight.figures["energy_balance"], flight.figures["mass_balance"]) < 1e-6


def test_a_separation_books_recoil_its_work_and_the_part():
    scene = [*BARE, *VACUUM, *WEIGHTLESS, *ENDLESS, *AT_REST, *doing(("jettison", "heat_shield", 0.0))]
    nominal, flight = Bench().flown([*scene, "simulation.time_limit_s=1"])
    part = next(part for part in nominal.vehicle.parts if part.name == "heat_shield")
    recoil = part.mass_kg / nominal.vehicle.mass.entry_kg * np.linalg.norm(part.separation_velocity_m_s)
    kept = balance(flight)
    assert np.linalg.norm(kept["velocity"]) == pytest.approx(recoil, rel=1e-9)
    assert kept["work"] == pytest.approx(0.5 * recoil * recoil, rel=1e-9)
    assert kept["lost"] == pytest.approx(part.mass_kg, rel=1e-12)
    assert kept["separations"] < 1e-12


def test_a_field_that_turns_does_work_and_it_is_counted():
    """The energy in I of an orbit about a planet that is no body of revolution is not constant."""
    _, flight = Bench().flown(
        [
            *BARE,
            *VACUUM,
            *ENDLESS,
            "planet.rotation_rate_rad_s=1e-3",
            "initial.altitude_m=300e3",
            "initial.speed_m_s=4000",
            "initial.flight_path_angle_deg=0",
            "limits.skip_out_m=1e7",
            "simulation.time_limit_s=600",
        ]
    )
    kept = balance(flight)
    energy = 0.5 * np.dot(kept["v_I"], kept["v_I"])
    assert abs(kept["work"]) > 1e-5 * energy
    assert flight.figures["energy_balance"] < 1e-9


def test_a_parachute_whose_lines_are_not_yet_taut_goes_on_when_its_carrier_leaves():
    """It vanished with its momentum."""
    events = doing(("deploy", "main", 0.0), ("jettison", "backshell", 0.2))
    _, flight = Bench().flown(
        [*BARE, *VACUUM, *WEIGHTLESS, *ENDLESS, *AT_REST, *events, "simulation.time_limit_s=0.4"]
    )
    assert np.isfinite(flight.plant["done"][0, 1])
    assert np.isnan(flight.plant["line_stretch_time"][0, 0])
    assert balance(flight)["separations"] < 1e-12
    assert flight.figures["mass_balance"] < 1e-12
