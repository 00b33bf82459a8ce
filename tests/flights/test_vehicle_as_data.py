"""Other vehicles and missions by their YAML alone: a ballast mass, a drogue, a second engine, other models of
parachute and engine.

What each of them must do follows from sums and closed forms of its own, taken here in numpy.
"""

from __future__ import annotations

import json

import numpy as np
import pytest
from scipy.interpolate import RegularGridInterpolator
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation

import edl6dof
from edl6dof.vehicle.aerodynamics.table import read_static_table
from edl6dof.vehicle.plant import PROPELLANT


@pytest.fixture(scope="module")
def nominal():
    return edl6dof.fly("tianwen1")


def phases(change):
    """Override: the mission of Tianwen-1 with ``change(phases)`` applied to its phases by name."""
    own = edl6dof.load("tianwen1").scenario.mission.phases
    table = {phase.name: phase.model_dump(mode="json", exclude_none=True) for phase in own}
    change(table)
    return f"mission.phases={json.dumps(list(table.values()))}"


def when(quantity, goes, value, **window):
    return {"quantity": quantity, "goes": goes, "value": value, **window}


def event(name, action, thing, trigger, delay_s=0.0):
    return {"name": name, "action": action, "thing": thing, "delay_s": delay_s, "when": trigger}


def at(flight, column, t):
    return np.interp(t, flight.telemetry["t_s"], flight.telemetry[column])


# ---- names -------------------------------------------------------------------------------------


def test_the_names_of_events_are_free(nominal):
    """Figures follow from what an event does: under other names, all of them are the same."""

    def change(table):
        for phase in table.values():
            for one in phase.get("events", []):
                one["name"] = f"own_{one['name']}"

    flight = edl6dof.fly("tianwen1", [phases(change)])
    assert flight.metrics == nominal.metrics
    assert [one["milestone"] for one in flight.events if "milestone" in one] == [
        one["key"] if one["key"] != "cut_off" else "" for one in nominal.events if "milestone" in one
    ]


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
    assert flight.metrics["backshell_s"] == pytest.approx(released, abs=1e-9)


# ---- ballast -----------------------------------------------------------------------------------

BALLAST = {"name": "ballast", "mass_kg": 30.0, "centre_m": [-0.9, 0.0, -1.1], "drag_area_m2": 0.05}
BALLAST_OFF_S = 40.0


def parts(*more):
    own = [part.model_dump(mode="json") for part in edl6dof.load("tianwen1").scenario.vehicle.parts]
    return f"vehicle.parts={json.dumps([*own, *more])}"


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


# ---- another model of a parachute, of an engine -------------------------------------------------

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


def test_a_pulsed_engine_lands_on_full_pulses_of_the_thrust_that_is_asked_for(nominal):
    flight = edl6dof.fly("tianwen1", ["vehicle.engines.main.model=pulsed"])
    assert flight.outcome == "landed within limits"
    begin = next(one["t_s"] for one in flight.events if one["key"] == "phase.hover_imaging") + 1.0
    hover = [
        (one.telemetry["t_s"] > begin) & (one.telemetry["t_s"] < begin + 10.0) for one in (flight, nominal)
    ]
    thrust = flight.telemetry["truth.engine_thrust_n"][hover[0]]
    asked = nominal.telemetry["truth.engine_thrust_n"][hover[1]]
    assert thrust.max() > 0.8 * 7500.0 and thrust.min() < 0.1 * 7500.0
    assert np.ptp(asked) < 0.2 * 7500.0  # the throttled one holds a level
    assert thrust.mean() == pytest.approx(asked.mean(), rel=0.05)


# ---- two engines side by side ------------------------------------------------------------------

ARM_M = 0.3


def two_engines():
    main = edl6dof.load("tianwen1").scenario.vehicle.engines[0].model_dump(mode="json")
    halves = []
    for name, side in (("left", -1.0), ("right", 1.0)):
        half = {**main, "name": name, "nozzle_m": [-0.3, side * ARM_M, 0.0]}
        for key in ("full_thrust_n", "throttle_min_n", "throttle_max_n"):
            half[key] = main[key] / 2.0
        valve = main["throttled"]
        half["throttled"] = {**valve, **{key: valve[key] / 2.0 for key in ("rate_n_s", "start_rate_n_s")}}
        halves.append(half)
    return f"vehicle.engines={json.dumps(halves)}"


def both(table):
    ignition, cut = table["powered_deceleration"]["events"][1], table["landed"]["events"][0]
    table["powered_deceleration"]["events"][1:] = [
        {**ignition, "thing": "left"}, {**ignition, "name": "second_ignition", "thing": "right"},
    ]  # fmt: skip
    table["landed"]["events"] = [
        {**cut, "thing": "left"}, {**cut, "name": "second_cut_off", "thing": "right"},
    ]  # fmt: skip


def test_two_engines_of_half_the_thrust_descend_as_one(nominal):
    flight = edl6dof.fly("tianwen1", [two_engines(), phases(both)])
    assert flight.metrics["touchdown_s"] == pytest.approx(nominal.metrics["touchdown_s"], abs=0.5)
    assert flight.metrics["propellant_used_kg"] == pytest.approx(
        nominal.metrics["propellant_used_kg"], abs=0.5
    )
    start = flight.metrics["backshell_s"]
    for s in (1.5, 10.0, 25.0):
        thrust = [at(one, "truth.engine_thrust_n", start + s) for one in (flight, nominal)]
        assert thrust[0] == pytest.approx(thrust[1], rel=0.01)


def test_an_engine_that_is_cut_off_leaves_the_moment_of_the_other():
    def change(table):
        both(table)
        stop = event("failure", "cut_off", "left", when("phase_time_s", "above", 3.0))
        table["powered_deceleration"]["events"].append(stop)

    flight = edl6dof.fly("tianwen1", [two_engines(), phases(change)])
    t = next(one["t_s"] for one in flight.events if one["key"] == "failure")
    table, step = flight.telemetry, 0.6  # after the decay of one and the build-up of the other
    thrust = at(flight, "truth.engine_thrust_n", t + step)
    # r x F about the centre of mass, of a thrust along -x at y = ARM_M
    lever = ARM_M - at(flight, "truth.centre_y_m", t + step)
    before, after = (at(flight, "truth.disturbance_z_nm", s) for s in (t - 0.05, t + step))
    assert thrust > 500.0
    # no more is asked for than the other can give
    asked = table["guide.thrust_n"]
    rows = table["t_s"] > t + 0.2
    assert asked[rows].max() <= 3750.0 < asked[~rows].max()
    assert after - before == pytest.approx(lever * thrust, rel=0.1)
    assert np.all(np.isfinite(table["truth.disturbance_z_nm"]))


def test_a_fault_of_one_engine_leaves_the_other_all_its_thrust(nominal):
    """Forces and moments balance: the velocity lacks the share of one engine, which no longer turns it."""
    fault = (
        "faults=[{kind: engine_shortfall, engine: left, engine_shortfall: {thrust_factor: 0.7}, "
        "at: {phase: powered_deceleration, plus_s: 6}}]"
    )
    limit = f"simulation.time_limit_s={nominal.metrics['backshell_s'] + 10.0}"
    flight = edl6dof.fly("tianwen1", [two_engines(), phases(both), fault, limit])
    event = next(one for one in flight.events if one["key"] == "fault")
    assert event["name"] == "fault: left engine shortfall"
    table, t, span = flight.telemetry, event["t_s"], 0.2

    def mean_force(begin):
        """Force (N, I) over a short while, from velocity and mass, without that of the thrusters."""
        velocities = [
            np.array([at(flight, f"truth.v_I_{axis}_m_s", s) for axis in "xyz"])
            for s in (begin, begin + span)
        ]
        rows = (table["t_s"] > begin) & (table["t_s"] <= begin + span)
        gas = np.array([table[f"truth.rcs_force_{axis}_n"][rows].mean() for axis in "xyz"])
        return at(flight, "truth.mass_kg", begin) * (velocities[1] - velocities[0]) / span, gas

    # x of B points down, against the thrust; gravity and air are the same before and after
    (before, gas_before), (after, gas_after) = mean_force(t - span - 0.02), mean_force(t + 0.02)
    attitude = np.array([at(flight, f"truth.q_I2B_{part}", t) for part in "xyzw"])
    lost = Rotation.from_quat(attitude).inv().apply(after - before)[0] - (gas_after - gas_before)[0]
    share = 0.3 * at(flight, "truth.engine_thrust_n", t - 0.02) / 2.0
    assert lost == pytest.approx(share, rel=0.01)
    # r x F of what the left engine, at y = -ARM_M, no longer pushes along -x
    turned = at(flight, "truth.disturbance_z_nm", t + 0.04) - at(flight, "truth.disturbance_z_nm", t - 0.02)
    assert turned == pytest.approx(share * (ARM_M + at(flight, "truth.centre_y_m", t)), rel=0.01)


# ---- tanks -------------------------------------------------------------------------------------


def tanks(**loads):
    """Override: tanks of these loads (kg), all in the place of the one."""
    own = edl6dof.load("tianwen1").scenario.vehicle.tanks[0].model_dump(mode="json")
    whole = np.array(own["inertia_kg_m2"]) / own["mass_kg"]
    rows = [
        {**own, "name": name, "mass_kg": load, "inertia_kg_m2": (whole * load).tolist()}
        for name, load in loads.items()
    ]
    return f"vehicle.tanks={json.dumps(rows)}"


def test_tanks_that_share_a_place_fly_as_one(nominal):
    flight = edl6dof.fly("tianwen1", [tanks(front=120.0, aft=70.0)])
    assert flight.outcome == "landed within limits"
    for name in ("parachute_height_m", "backshell_height_m", "touchdown_s", "propellant_used_kg"):
        assert flight.metrics[name] == pytest.approx(nominal.metrics[name], rel=1e-2)
    left = flight.plant["y"][0, PROPELLANT : PROPELLANT + 2]
    assert left / (120.0, 70.0) == pytest.approx(
        np.full(2, 1.0 - flight.metrics["propellant_used_kg"] / 190.0), rel=1e-9
    )
    # the first minute, before chaos: masses, truth and belief
    for column in ("truth.mass_kg", "nav.mass_kg", "truth.centre_y_m"):
        assert at(flight, column, 60.0) == pytest.approx(at(nominal, column, 60.0), rel=1e-9)


def test_thrusters_on_a_small_tank_of_their_own_starve_and_the_engine_does_not():
    scenario = edl6dof.load("tianwen1").scenario.vehicle
    own = [{**jet.model_dump(mode="json"), "draws_from": ["rcs"]} for jet in scenario.rcs.thrusters]
    flight = edl6dof.fly(
        "tianwen1",
        [
            tanks(main=180.0, rcs=10.0),
            f"vehicle.rcs.thrusters={json.dumps(own)}",
            "vehicle.engines.main.draws_from=[main]",
        ],
    )
    empty = next(one for one in flight.events if one["key"] == "propellant_exhausted")
    assert empty["name"] == "tank rcs empty"
    assert f"tank rcs empty at {empty['t_s']:.1f} s" in flight.outcome
    t, table = flight.telemetry["t_s"], flight.telemetry
    after = t > empty["t_s"] + 0.02
    jets = np.stack([table[f"rcs.{jet['name']}"] for jet in own])
    assert jets[:, ~after].max() == pytest.approx(1.0) and np.all(jets[:, after] == 0.0)
    assert table["truth.engine_thrust_n"][after].max() > 1000.0
    used = -np.diff(table["truth.propellant_kg"][after])
    assert used.min() >= 0.0 and used.sum() > 5.0


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
