"""The comparison of entry laws: what is dispersed, what is measured, and that a small run of it comes out
whole.
"""

from math import degrees

import numpy as np
import pytest
from numba.core.runtime import _nrt_python, rtsys

import edl6dof
from edl6dof.campaign.design.case import Case, Variants
from edl6dof.fsw.functions import chosen
from edl6dof.fsw.guidance.entry.registry import ENTRY_LAWS, ENTRY_MEMORY
from edl6dof.fsw.guidance.guidance_command import GUIDE
from edl6dof.fsw.navigation.derived import NAV
from edl6dof.kernels import kernel
from edl6dof.scenario.records import build_records
from edl6dof.sim.flight_state import snapshots_at
from edl6dof.studies import guidance
from edl6dof.studies.guidance import CONDITIONS, DISPERSED

ANGLE, MASS = "initial.flight_path_angle_deg", "vehicle.mass.entry_kg"
DENSITY, PRESSURE = "atmosphere.density_factor", "atmosphere.seasonal.surface_pressure_factor"
NORTH_EAST = ("north", "east")


@pytest.fixture(scope="module")
def nominal():
    return edl6dof.load("tianwen1", ["mission.goal=deployment"])


def test_every_entry_law_but_the_constant_one_is_compared():
    assert set(guidance.LAWS) == set(ENTRY_LAWS.names) - {"constant_bank"}
    assert {"etpc", "npc", "bank_profile", "drag_tracking"} <= set(guidance.LAWS)


def named(chosen, *in_suite):
    """Vehicles as cases by name; those that are not in the suite for the long run."""
    return [pytest.param(v, id=v.name, marks=[] if v.name in in_suite else pytest.mark.long) for v in chosen]


@pytest.mark.parametrize("vehicle", named(guidance.VEHICLES, "tianwen1", "viking1", "wu2013"))
def test_dispersed_entries_lie_about_the_nominal_and_can_be_built(vehicle):
    """The widths are those of the campaign; of a point mass those of tianwen1_mc."""
    scenario, truths = vehicle.load().scenario, guidance.entries(vehicle, 200, 1)
    air, width = (DENSITY, 0.2 / 3.0) if DENSITY in truths[0] else (PRESSURE, 0.04)
    angle, mass, density = ([truth[path] for truth in truths] for path in (ANGLE, MASS, air))
    assert np.mean(angle) == pytest.approx(scenario.initial.flight_path_angle_deg, abs=0.03)
    assert np.std(angle) == pytest.approx(0.1, rel=0.15)
    assert np.std(mass) / np.mean(mass) == pytest.approx(0.0039, rel=0.2)
    assert np.std(density) == pytest.approx(width, rel=0.15)
    variants = Variants(vehicle.load())
    for i, truth in enumerate(truths[:20]):
        variants.build(Case(i, truth=truth, profile=i))


@pytest.mark.parametrize("vehicle", [guidance.VEHICLES[0], guidance.VEHICLES[-1]], ids=lambda v: v.name)
def test_another_seed_draws_other_entries(vehicle):
    first, same, other = (guidance.entries(vehicle, 5, seed) for seed in (1, 1, 2))
    assert first == same
    assert all(one[ANGLE] != two[ANGLE] for one, two in zip(first, other, strict=True))


def test_a_flight_whose_mortar_never_fires_counts_as_a_miss_without_end():
    rows = [{"parachute_miss_m": 1500.0, "law": "a"}, {"outcome": "crashed", "law": "a"}]
    assert list(guidance.misses(rows)) == [1.5, np.inf]
    assert guidance.unflown(rows) == rows[1:]


@pytest.fixture(scope="module")
def with_lift_up():
    """Rows with lift up of two entries that all laws missed, the second three sigma steeper, and of one that
    was hit.
    """
    label = {"vehicle": "tianwen1", "condition": DISPERSED}
    rows = [
        {**label, "law": law, "profile": n, "parachute_miss_m": miss}
        for law, missed in (("npc", (4e3, 9e3, 3e3)), ("fnpeg", (3e3, 9e3, 1e3)))
        for n, miss in enumerate(missed)
    ]
    steep = {"initial.flight_path_angle_deg": -11.581 - 0.45}
    waves = guidance.WAVES_AND_GUSTS
    return guidance.lift_up(guidance.VEHICLES[0], rows, [waves, {**steep, **waves}, waves])


def test_entries_that_some_law_hits_are_in_reach_without_being_flown_again(with_lift_up):
    assert [row["profile"] for row in with_lift_up] == [0, 1]


def test_an_entry_that_ends_short_with_lift_up_all_the_way_is_out_of_reach(with_lift_up):
    nominal, steep = (row["parachute_downrange_m"] for row in with_lift_up)
    assert nominal > 20e3 and steep < -5e3
    assert guidance.out_of_reach(with_lift_up) == {1}


def found(misses, beyond):
    """Results by label on dispersed entries of these misses (km)."""
    about = {"vehicle": "msl", "law": "npc", "condition": DISPERSED, "success": True}
    rows = [{**about, "profile": n, "parachute_miss_m": 1e3 * miss} for n, miss in enumerate(misses)]
    listed = guidance.findings(rows, {("msl", "npc"): 1.0}, {"msl": beyond})
    return {finding.label: (finding.computed, finding.ok) for finding in listed}


def test_misses_of_entries_out_of_reach_explain_the_99_percent_and_nothing_else_does():
    near, far = [1.0] * 396, {396, 397, 398, 399}
    assert found([*near, *[9.0] * 4], far)["msl: 99 % of misses, best law"] == (9.0, True)
    assert found([*near, *[9.0] * 4], far)["msl: 99 % of misses of the entries in reach"] == (1.0, True)
    assert found([*near, *[9.0] * 4], far)["msl: entries short of the target with lift up"] == (1.0, True)
    assert found([*near, *[9.0] * 4], set())["msl: 99 % of misses, best law"] == (9.0, False)
    assert found([*near, *[9.0] * 5], {396})["msl: 99 % of misses, best law"] == (9.0, False)


def test_too_few_entries_have_no_99_percent_and_no_result_of_it():
    miss, ok = found([1.0] * 200, set())["msl: 99 % of misses, best law"]
    assert np.isnan(miss) and ok


@pytest.mark.parametrize(("law", "speed"), [("fnpeg", 700.0), ("etpc", 1100.0)])
def test_fnpeg_alone_controls_range_for_longer(law, speed):
    """What MSL flew stays what it flew: the settings of one law are no other's."""
    loaded = edl6dof.load("msl", [f"{guidance.ENTRY}.law={law}"])
    assert build_records(loaded).onboard[0]["guidance"]["entry"]["heading"]["speed"] == speed


def test_open_loop_profile_is_the_planned_bank():
    loaded = guidance.with_law(guidance.VEHICLES[0], "bank_profile")
    points = loaded.scenario.flight_software.guidance.entry.bank_profile.points
    # a constant profile, shifted to the range
    fitted = edl6dof.load(
        "tianwen1", ["mission.goal=deployment", f"{guidance.ENTRY}.reference_bank.fit_range=true"]
    )
    record = build_records(fitted).onboard[0]
    cosine = np.cos(record["guidance"]["entry"]["reference_bank"]["points"]["bank"][0])
    planned = degrees(np.arccos(cosine + record["reference"]["shift"]))
    assert [point.bank_deg for point in points] == pytest.approx([planned] * len(points))


def flown_under(vehicle, truth):
    """Loaded scenario of one entry under each condition, and the record of what the flight computer knows."""
    loaded, variants, met = vehicle.load("simulation.log_every=5"), Variants(vehicle.load()), {}
    for case in guidance.cases(loaded.scenario, [truth], {}):
        met.setdefault(case.label["condition"], variants.build(case))
    return met


@pytest.mark.parametrize("vehicle", named(guidance.VEHICLES, "tianwen1", "zheng2015"))
def test_every_condition_is_truly_met(vehicle):
    """Read back from the scenario that flies: changes of the drawn entry, not of the nominal one."""
    nominal = vehicle.load().scenario
    entry = {ANGLE: nominal.initial.flight_path_angle_deg + 0.1, MASS: 1.01 * nominal.vehicle.mass.entry_kg}
    entry |= {DENSITY: 0.9, **guidance.WAVES_AND_GUSTS}
    met = flown_under(vehicle, entry)
    assert list(met) == list(CONDITIONS)

    def truth(name):
        return met[name].loaded.truth

    assert truth("density x0.8").atmosphere.density_factor == pytest.approx(0.72)
    assert truth("density x1.25").atmosphere.density_factor == pytest.approx(1.125)
    assert truth("mass +3 %").vehicle.mass.entry_kg == pytest.approx(1.03 * entry[MASS])
    steeper = truth("entry errors x2").initial.flight_path_angle_deg - nominal.initial.flight_path_angle_deg
    assert steeper == pytest.approx(0.2)
    blown = {name: truth(f"{name} wind").wind.constant for name in ("head", "tail", "cross")}
    north, east = ({name: getattr(one, f"{axis}_m_s") for name, one in blown.items()} for axis in NORTH_EAST)
    course = np.radians(nominal.initial.azimuth_deg)
    along = {name: north[name] * np.cos(course) + east[name] * np.sin(course) for name in blown}
    assert along == pytest.approx({"head": -40.0, "tail": 40.0, "cross": 0.0}, abs=1e-9)
    assert np.hypot(north["cross"], east["cross"]) == pytest.approx(40.0)
    slow = met["half bank rate"].loaded.scenario.flight_software
    assert slow.guidance.entry.bank_rate_deg_s == 10.0
    if vehicle.dispersions:
        assert slow.control.bank_to_steer.bank.rate_deg_s == 10.0
    believed = met["L/D -10 %"].parts.onboard[0]["vehicle"]
    assert believed == met[DISPERSED].parts.onboard[0]["vehicle"]


@pytest.mark.parametrize("vehicle", named(guidance.VEHICLES, "tianwen1", "viking1", "yan2016"))
def test_less_lift_is_a_tenth_less_in_flight(vehicle):
    """Lift over drag across and along the true air-relative velocity."""
    met = flown_under(vehicle, {})
    less, usual = (lift_over_drag(edl6dof.fly(met[name].loaded)) for name in ("L/D -10 %", DISPERSED))
    assert less == pytest.approx(0.9 * usual, rel=0.02)


def lift_over_drag(flight):
    """Mean between Mach 8 and 20."""
    rows = flight.telemetry
    fast = (rows["truth.mach"] > 8.0) & (rows["truth.mach"] < 20.0)
    alpha, beta = (np.radians(rows[f"truth.{angle}_deg"][fast]) for angle in ("alpha", "beta"))
    ahead = np.stack([np.cos(alpha) * np.cos(beta), np.sin(beta), np.sin(alpha) * np.cos(beta)])
    force = np.stack([rows[f"truth.aero_force_{axis}_n"][fast] for axis in "xyz"])
    drag = -np.sum(force * ahead, axis=0)
    return float(np.mean(np.linalg.norm(force + drag * ahead, axis=0) / drag))


@pytest.mark.parametrize(
    ("bank", "travel", "extra"),
    [
        ([60.0, 20.0, -30.0, -60.0], 120.0, 0.0),  # one reversal
        ([60.0, 60.0, 0.0, 0.0, -60.0], 120.0, 0.0),  # with a pause
        ([60.0, 20.0, 60.0, 20.0], 120.0, 120.0),  # chatter on one side
        ([60.0, -60.0, -40.0, 0.0], 180.0, 60.0),  # a reversal, then level
        ([40.0, 40.0], 0.0, 0.0),
    ],
)
def test_travel_beyond_the_reversals_leaves_out_the_turns_to_the_other_side(bank, travel, extra):
    assert guidance.bank_travel(np.array(bank)) == (travel, extra)


def test_propellant_of_a_reversal_starts_and_stops_the_roll(nominal):
    """Two impulses I w of the horizontal 250 N thrusters, 1.06 m from the axis."""
    impulse = 2.0 * 1150.0 * np.radians(20.0) / 1.06
    assert guidance.reversal_kg(nominal.scenario) == pytest.approx(impulse / (270.0 * 9.80665))


def test_figures_of_a_flight_are_its_own_telemetry(nominal):
    flight = edl6dof.fly(nominal)
    found, rows = guidance.of_flight(flight), flight.telemetry
    lift = rows["guide.phase"] == 1
    # at least the reversals, each from one side to the other, and the levelling at the end
    reversals = flight.figures["bank_reversals"]
    assert found["bank_travel_deg"] - found["extra_travel_deg"] > 2 * 15.0 * reversals
    assert found["bank_travel_deg"] <= 20.0 * np.ptp(rows["t_s"][lift])  # the rate limit
    used = flight.figures["propellant_used_kg"]
    assert 0.0 < found["extra_propellant_kg"] < used
    assert used - found["extra_propellant_kg"] == pytest.approx(
        reversals * guidance.reversal_kg(nominal.scenario)
    )


@kernel
def _allocate(n):
    """An array for each turn, to see that allocations are counted."""
    total = 0.0
    for i in range(n):
        total += np.full(10, float(i))[3]
    return total


def allocations(function, *arguments):
    before = rtsys.get_allocation_stats().alloc
    function(*arguments)
    return rtsys.get_allocation_stats().alloc - before


def test_no_entry_law_allocates(nominal):
    """Calls in mid entry, counted by numba's own runtime: twenty allocate no more than one."""
    _nrt_python.memsys_enable_stats()
    assert allocations(_allocate, 50) - allocations(_allocate, 10) == 40
    loaded = edl6dof.load("tianwen1", ["flight_software.guidance.entry.law=etpc"])
    onboard, (state,) = build_records(loaded).onboard, snapshots_at(loaded, [120.0])
    navs, memories = np.zeros(1, NAV), np.zeros(1, ENTRY_MEMORY)
    navs[0], memories[0] = state.fsw["nav"][0], state.fsw["guidance"]["entry"][0]
    for law in range(len(ENTRY_LAWS.members)):
        onboard["guidance"]["entry"]["law"] = law
        functions = [chosen(name, onboard[0]) for name in ("entry_law", "bank_side")]
        rest = (onboard, navs, memories, np.zeros(1, ENTRY_MEMORY), np.zeros(1, GUIDE))
        _, once, often = (allocations(guidance._repeat, *functions, *rest, n) for n in (1, 1, 20))
        assert once == often, ENTRY_LAWS.names[law]


def test_small_run_comes_out_whole(monkeypatch):
    monkeypatch.setattr(guidance, "VEHICLES", (guidance.VEHICLES[0], guidance.VEHICLES[-1]))
    first = {name: CONDITIONS[name] for name in (DISPERSED, "tail wind")}
    monkeypatch.setattr(guidance, "CONDITIONS", first)
    monkeypatch.setattr(guidance, "REPEATS", 5)
    seen = []
    laws = ("npc", "bank_profile")
    report = guidance.STUDY.fly(3, laws, lambda done, total: seen.append((done, total)), seed=5)
    # of two laws on two vehicles: three dispersed entries, and the first again in a tail wind
    flown = [row for row in report.rows if row["law"] in laws]
    assert len(flown) == 16 and seen[-1] == (16, 16)
    # and one more for each entry that neither brings to the target
    assert report.runs == len(report.rows) >= 16
    for vehicle in ("tianwen1", "yan2016"):
        met = {
            law: [(row["profile"], row[f"truth.{ANGLE}"], row[f"truth.{DENSITY}"]) for row in flown
                  if (row["vehicle"], row["law"], row["condition"]) == (vehicle, law, DISPERSED)]
            for law in laws
        }  # fmt: skip
        assert met["npc"] == met["bank_profile"] and len(set(met["npc"])) == 3  # the same entries
    quantiles, cost, missed, biased, *others = report.grids
    assert len(others) == 4
    assert quantiles.rows == (("npc", 3.0), ("bank_profile", 3.0))  # too few to bound any
    rows = {row[0]: dict(zip(missed.heads, row, strict=True)) for row in missed.rows}
    assert rows["npc"][DISPERSED] < 5.0 < rows["bank_profile"][DISPERSED]
    rows = {row[0]: dict(zip(biased.heads, row, strict=True)) for row in biased.rows}
    assert abs(rows["npc"]["tail wind"]) < abs(rows["bank_profile"]["tail wind"])
    rows = {row[0]: dict(zip(cost.heads, row, strict=True)) for row in cost.rows}
    assert rows["npc"]["in box %"] == 100.0
    assert 0.0 < rows["bank_profile"]["call us"] < rows["npc"]["call us"] < 2000.0
    assert list(report.pictures) == ["comparison"]
