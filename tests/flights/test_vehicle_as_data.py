"""Other vehicles and missions by their YAML alone: free names, a ballast mass, a drogue, a reefed parachute,
another order of separation; engines and tanks stand in ``test_propulsion_as_data.py``.

What each of them must do follows from sums and closed forms of its own, taken here in numpy.
"""

from __future__ import annotations

import json

import numpy as np
import pytest
from other_vehicle import at, event, parts, phases, when
from scipy.interpolate import RegularGridInterpolator
from scipy.optimize import brentq

import edl6dof
from edl6dof.vehicle.aerodynamics.capsule_table import read_static_table

# ---- names -------------------------------------------------------------------------------------


def test_the_names_of_events_are_free(nominal):
    """Figures follow from what an event does: under other names, all of them are the same."""

    def change(table):
        for phase in table.values():
            for one in phase.get("events", []):
                one["name"] = f"own_{one['name']}"

    flight = edl6dof.fly("tianwen1", [phases(change)])
    assert flight.figures == nominal.figures
    milestones = (
        [one["milestone"] for one in each.events if "milestone" in one] for each in (flight, nominal)
    )
    assert next(milestones) == next(milestones)


def test_another_event_may_have_the_name_of_a_milestone(nominal):
    """A ballast mass jettisoned under the name of the backshell's event is no release of the backshell."""

    def change(table):
        for one in table["powered_deceleration"]["events"]:
            if one["name"] == "backshell":
                one["name"] = "shell_off"
        table["trim_aoa"]["events"] = [
            event("backshell", "jettison", "ballast", when("time_s", "above", 40.0))
        ]

    flight = edl6dof.fly("tianwen1", [parts(BALLAST), phases(change), "mission.goal=landing"])
    ballast, released = (
        next(one["t_s"] for one in flight.events if one["key"] == key) for key in ("backshell", "shell_off")
    )
    assert ballast == pytest.approx(40.0, abs=0.03)
    assert flight.figures["backshell_s"] == pytest.approx(released, abs=1e-9)


# ---- ballast -----------------------------------------------------------------------------------

BALLAST = {"name": "ballast", "mass_kg": 30.0, "centre_m": [-0.9, 0.0, -1.1], "drag_area_m2": 0.05}
BALLAST_OFF_S = 40.0


@pytest.fixture(scope="module")
def without_ballast():
    def change(table):
        table["trim_aoa"]["events"] = [
            event("ballast", "jettison", "ballast", when("time_s", "above", BALLAST_OFF_S))
        ]

    return edl6dof.fly("tianwen1", [parts(BALLAST), phases(change), "mission.goal=deployment"])


def test_a_ballast_mass_leaves_and_moves_the_centre_by_its_share(without_ballast):
    flight = without_ballast
    t = next(one["t_s"] for one in flight.events if one["key"] == "ballast")
    assert t == pytest.approx(BALLAST_OFF_S, abs=0.03)
    before, after = (
        np.array([at(flight, f"truth.centre_{axis}_m", s) for axis in "xyz"]) for s in (t - 0.5, t + 0.5)
    )
    mass = at(flight, "truth.mass_kg", t - 0.5)
    moved = (before - np.array(BALLAST["centre_m"])) * 30.0 / (mass - 30.0)
    assert mass - at(flight, "truth.mass_kg", t + 0.5) == pytest.approx(30.0, abs=0.1)
    assert after - before == pytest.approx(moved, abs=1e-5)
    # the flight computer believes so too
    assert at(flight, "nav.mass_kg", t - 0.5) - at(flight, "nav.mass_kg", t + 0.5) == pytest.approx(
        30.0, abs=0.1
    )


def trim_angles_deg(flight, rows):
    """Angles at which the static coefficients leave no moment about the centre of mass, shape (rows,)."""
    capsule = flight.scenario.vehicle.aero.capsule
    mach, total_angle, coefficients = read_static_table(capsule.static_table)
    table = RegularGridInterpolator((mach, total_angle), coefficients)
    reference = capsule.moment_reference_x_over_d * capsule.diameter_m

    def moment(angle, mach, x, z):
        """Over q S, nose up: of axial and normal force and of the couple at the reference, wind from -z."""
        axial, normal, couple = table((mach, angle))
        return z * axial - (reference - x) * normal - capsule.diameter_m * couple

    states = (flight.telemetry[f"truth.{name}"][rows] for name in ("mach", "centre_x_m", "centre_z_m"))
    return np.array([-brentq(moment, 0.0, 16.0, args=state) for state in zip(*states, strict=True)])


def test_without_its_ballast_the_vehicle_trims_at_another_angle(nominal, without_ballast):
    """Both fly at the angle of no moment, by their static table and the place of their centre of mass."""
    offsets = []
    for flight in (nominal, without_ballast):
        t = flight.telemetry["t_s"]
        rows = np.flatnonzero((t > 120.0) & (t < 180.0))[::25]
        alpha = flight.telemetry["truth.alpha_deg"][rows]
        assert alpha.mean() == pytest.approx(trim_angles_deg(flight, rows).mean(), abs=0.15)
        offsets.append(flight.telemetry["truth.centre_z_m"][rows].mean())
    assert offsets[1] - offsets[0] == pytest.approx((-0.034 + 1.1) * 30.0 / 1255.0, abs=2e-3)


# ---- drogue, then main -------------------------------------------------------------------------

DROGUE_PACK = {"name": "drogue_pack", "mass_kg": 8.0, "centre_m": [-2.25, 0.0, -0.034]}
DROGUE_S = 6.0


def test_a_drogue_flies_before_the_main_parachute():
    def change(table):
        table["parachute"]["events"] = [
            event("drogue", "deploy", "drogue", when("phase_time_s", "above", -1.0)),
            event("drogue_off", "release", "drogue", when("phase_time_s", "above", DROGUE_S)),
            event("mortar", "deploy", "main", when("phase_time_s", "above", DROGUE_S + 0.4)),
            *table["parachute"]["events"][1:],
        ]

    own = [chute.model_dump(mode="json") for chute in edl6dof.load("tianwen1").scenario.vehicle.parachutes]
    drogue = {**own[0], "name": "drogue", "pack": "drogue_pack", "diameter_m": 5.0, "line_length_m": 12.0}
    flight = edl6dof.fly(
        "tianwen1",
        [parts(DROGUE_PACK), f"vehicle.parachutes={json.dumps([drogue, *own])}", phases(change)],
    )
    keys = [one["key"] for one in flight.events]
    order = [key for key in keys if key in ("drogue", "drogue_off", "mortar", "line_stretch")]
    assert order == ["drogue", "line_stretch", "drogue_off", "mortar", "line_stretch"]
    times = {one["key"]: one["t_s"] for one in flight.events}
    t, tension = flight.telemetry["t_s"], flight.telemetry["truth.riser_tension_n"]
    quiet = (t > times["drogue_off"] + 0.05) & (t < times["mortar"])
    assert quiet.sum() > 5 and np.all(tension[quiet] == 0.0)
    # before that what the drag of canopy and pack leaves when they have slowed themselves with the vehicle
    rows = (t > times["drogue_off"] - 1.5) & (t < times["drogue_off"] - 0.1)
    pressure, mach, load_g0 = (
        flight.telemetry[f"truth.{name}"][rows] for name in ("dynamic_pressure_pa", "mach", "load_g0")
    )
    assert np.all((mach > 1.4) & (mach < 1.85))  # where Cruz et al. 2013 give this loss of drag
    drag_area = np.pi / 4.0 * 25.0 * drogue["drag_coefficient"] * (1.0 - 0.16 * ((mach - 1.4) / 0.45) ** 2)
    pull = pressure * (drag_area + drogue["pack_drag_area_m2"]) - DROGUE_PACK["mass_kg"] * 9.80665 * load_g0
    assert tension[rows].mean() == pytest.approx(pull.mean(), rel=0.01)
    assert flight.outcome == "landed within limits"


def test_the_flight_computer_takes_a_pack_off_its_mass_when_the_mortar_throws_it(nominal):
    """To what is left of the small error in the propellant it counts; 38 kg of pack."""
    mortar, shield = (
        next(one["t_s"] for one in nominal.events if one["key"] == key) for key in ("mortar", "heat_shield")
    )
    for t in (mortar - 0.2, mortar + 0.2, shield - 0.2, shield + 0.2):
        assert at(nominal, "nav.mass_kg", t) == pytest.approx(at(nominal, "truth.mass_kg", t), abs=0.01)


# ---- another model of a parachute --------------------------------------------------------------

CUT_S = 5.0


def test_a_reefed_parachute_pulls_with_its_reefed_area_and_then_with_the_open_one():
    """Quasi-steady: tension over dynamic pressure is Cd S times the share that is open."""
    first, second = "drag_area_ratio: 0.3, filling_time_s: 0.5", "drag_area_ratio: 1.0, filling_time_s: 1.0"
    reefed = f"{{stages: [{{{first}}}, {{{second}, delay_s: {CUT_S}}}]}}"
    flight = edl6dof.fly(
        "tianwen1",
        [
            "vehicle.parachutes.main.model=reefed",
            f"vehicle.parachutes.main.reefed={reefed}",
            "vehicle.parachutes.main.area_oscillation=0",
        ],
    )
    taut = next(one["t_s"] for one in flight.events if one["key"] == "line_stretch")
    t, chute = flight.telemetry["t_s"], flight.scenario.vehicle.main_parachute
    area = chute.drag_coefficient * np.pi / 4.0 * chute.diameter_m**2
    for share, begin, end in ((0.3, 2.0, 4.9), (1.0, 12.0, 25.0)):
        rows = (t > taut + begin) & (t < taut + end)
        pull = flight.telemetry["truth.riser_tension_n"][rows].mean()
        pressure = flight.telemetry["truth.dynamic_pressure_pa"][rows].mean()
        assert pull / (pressure * area) == pytest.approx(share, rel=0.1)
    assert flight.outcome == "landed within limits"


# ---- order of separation -----------------------------------------------------------------------


def test_the_backshell_may_leave_before_the_heat_shield():
    """An abort at height: both go within a second, in the other order; shapes and masses follow."""

    def change(table):
        table["parachute"]["events"] = [
            table["parachute"]["events"][0],
            event("backshell", "jettison", "backshell", when("phase_time_s", "above", 20.0)),
            event("heat_shield", "jettison", "heat_shield", when("phase_time_s", "above", 21.0)),
        ]
        later = table["powered_deceleration"]["events"]
        later[:] = [one for one in later if one["name"] not in ("backshell", "heat_shield")]

    flight = edl6dof.fly("tianwen1", [phases(change), "simulation.time_limit_s=330"])
    times = {one["key"]: one["t_s"] for one in flight.events}
    assert times["heat_shield"] - times["backshell"] == pytest.approx(1.0, abs=0.03)
    masses = [at(flight, "truth.mass_kg", times["backshell"] + s) for s in (-0.1, 0.5, 1.5)]
    assert masses[0] - masses[1] == pytest.approx(130.0, abs=0.5)
    assert masses[1] - masses[2] == pytest.approx(150.0, abs=0.5)
