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


@pytest.fixture(scope="module")
def nominal():
    return edl6dof.load("tianwen1", ["mission.goal=deployment"])


def test_every_entry_law_but_the_constant_one_is_compared():
    assert set(guidance.LAWS) == set(ENTRY_LAWS.names) - {"constant_bank"}
    assert {"etpc", "npc", "bank_profile", "drag_tracking"} <= set(guidance.LAWS)


def named(chosen, *in_suite):
    """Vehicles as cases by name; those that are not in the suite for the long run."""
    return [pytest.param(v, id=v.name, marks=[] if v.name in in_suite else pytest.mark.long) for v in chosen]


@pytest.mark.parametrize(
    "vehicle", named([v for v in guidance.VEHICLES if v.dispersions], "tianwen1_range_trigger")
)
def test_dispersed_entries_are_those_of_the_campaign_about_the_nominal(vehicle):
    """Every case can be built on the vehicle, also where the parachute opens by another trigger."""
    loaded, truths = vehicle.load(), guidance.entries(vehicle, 200)
    angle, mass = ([truth[path] for truth in truths] for path in (ANGLE, MASS))
    assert np.mean(angle) == pytest.approx(loaded.scenario.initial.flight_path_angle_deg, abs=0.01)
    assert np.std(angle) == pytest.approx(0.1, rel=0.06)
    nominal = loaded.scenario.vehicle.mass.entry_kg
    assert 3.0 * np.std(mass) / nominal == pytest.approx(15.0 / 1285.0, rel=0.06)
    variants = Variants(loaded)
    for i, truth in enumerate(truths[:20]):
        variants.build(Case(i, truth=truth, profile=i))


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
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(guidance, "entries", lambda vehicle, flights: [{}, steep, {}][:flights])
        return guidance.lift_up(guidance.VEHICLES[0], rows, 3)


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


@pytest.mark.parametrize("vehicle", named(guidance.VEHICLES, "tianwen1", "zheng2015"))
def test_every_condition_is_truly_met(vehicle):
    """What the flight of a condition meets, read back from the records that fly."""
    nominal, variants = vehicle.load(), Variants(vehicle.load())
    met = {c.name: variants.build(c.case(0, nominal.scenario, 0, {})) for c in CONDITIONS}

    def truth(name):
        return met[name].loaded.truth

    assert truth("density -40 %").atmosphere.density_factor == 0.6
    assert truth("density +40 %").atmosphere.density_factor == 1.4
    for name, more in (("entry -0.3 deg", -0.3), ("entry +0.3 deg", 0.3)):
        before = nominal.scenario.initial.flight_path_angle_deg
        assert truth(name).initial.flight_path_angle_deg == pytest.approx(before + more)
    wind = truth("wind 60 m/s").wind
    assert wind.model == "constant"
    assert np.hypot(wind.constant.north_m_s, wind.constant.east_m_s) == pytest.approx(60.0)
    slow = met["bank 5 deg/s"].loaded.scenario
    assert slow.flight_software.guidance.entry.bank_rate_deg_s == 5.0
    # nobody has told the flight computer
    believed = met["L/D -20 %"].parts.onboard[0]["vehicle"]
    assert believed == met["nominal"].parts.onboard[0]["vehicle"]


def test_less_lift_is_a_fifth_less_in_flight():
    """Lift over drag across and along the true air-relative velocity."""
    for vehicle in (guidance.VEHICLES[0], guidance.VEHICLES[-1]):
        loaded, found = vehicle.load("simulation.log_every=5"), {}
        for condition in CONDITIONS:
            if condition.name in ("nominal", "L/D -20 %"):
                variant = Variants(loaded).build(condition.case(0, loaded.scenario, 0, {}))
                found[condition.name] = lift_over_drag(edl6dof.fly(variant.loaded))
        assert found["L/D -20 %"] == pytest.approx(0.8 * found["nominal"], rel=0.03)


def lift_over_drag(flight):
    """Mean between Mach 8 and 20."""
    rows = flight.telemetry
    fast = (rows["truth.mach"] > 8.0) & (rows["truth.mach"] < 20.0)
    alpha, beta = (np.radians(rows[f"truth.{angle}_deg"][fast]) for angle in ("alpha", "beta"))
    ahead = np.stack([np.cos(alpha) * np.cos(beta), np.sin(beta), np.sin(alpha) * np.cos(beta)])
    force = np.stack([rows[f"truth.aero_force_{axis}_n"][fast] for axis in "xyz"])
    drag = -np.sum(force * ahead, axis=0)
    return float(np.mean(np.linalg.norm(force + drag * ahead, axis=0) / drag))


def test_wind_blows_from_all_sides_in_turn(nominal):
    towards = [guidance.wind(nominal.scenario, flight) for flight in range(4)]
    total = np.sum([[w["wind.constant.north_m_s"], w["wind.constant.east_m_s"]] for w in towards], axis=0)
    assert total == pytest.approx([0.0, 0.0], abs=1e-9)


def test_figures_of_a_flight_are_its_own_telemetry(nominal):
    flight = edl6dof.fly(edl6dof.load("tianwen1", ["mission.goal=deployment"]))
    found, rows = guidance.of_flight(flight), flight.telemetry
    lift = rows["guide.phase"] == 1
    # at least the reversals, each from one side to the other, and the levelling at the end
    reversals = flight.figures["bank_reversals"]
    assert found["bank_travel_deg"] > 2 * 15.0 * reversals
    assert found["bank_travel_deg"] <= 20.0 * np.ptp(rows["t_s"][lift])  # the rate limit
    assert 0.0 <= found["saturation_s"] < np.ptp(rows["t_s"][lift])
    assert 0.05 < found["tracking_error_m_s2"] < 5.0


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
    monkeypatch.setattr(guidance, "CONDITIONS", CONDITIONS[:2])
    monkeypatch.setattr(guidance, "REPEATS", 5)
    seen = []
    laws = ("npc", "bank_profile")
    report = guidance.STUDY.fly(3, laws, lambda done, total: seen.append((done, total)))
    # of two laws: 2 conditions and 3 dispersed entries of one vehicle, 2 conditions of the other
    density, angle = "truth.atmosphere.density_factor", f"truth.{ANGLE}"
    names = ("law", "condition", "profile", density, angle)
    columns = {name: [row.get(name) for row in report.rows] for name in names}
    assert len([law for law in columns["law"] if law in ("npc", "bank_profile")]) == 14
    # and one more for each entry that neither brings to the target
    assert report.runs == len(report.rows) >= 14 and seen[-1] == (14, 14)
    dispersed = [i for i, name in enumerate(columns["condition"]) if name == DISPERSED]
    assert [columns["law"][i] for i in dispersed] == ["npc"] * 3 + ["bank_profile"] * 3
    # both laws meet the same entries
    for path in (density, angle, "profile"):
        met = [columns[path][i] for i in dispersed]
        assert met[:3] == met[3:] and len(set(met)) == 3
    misses, quantiles, effort, *_ = report.grids
    assert quantiles.rows == (("npc", 3.0), ("bank_profile", 3.0))  # too few to bound any
    rows = {row[0]: dict(zip(misses.heads, row, strict=True)) for row in misses.rows}
    assert rows["npc"]["dispersed"] < 5.0 < rows["bank_profile"]["dispersed"]
    rows = {row[0]: dict(zip(effort.heads, row, strict=True)) for row in effort.rows}
    assert rows["npc"]["in box %"] == 100.0
    assert 0.0 < rows["bank_profile"]["call us"] < rows["npc"]["call us"] < 2000.0
    assert list(report.pictures) == ["comparison"]
