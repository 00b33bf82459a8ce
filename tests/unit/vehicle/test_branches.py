"""Propellant branches: what goes through them is what the tanks lose; a latch valve shuts all behind it."""

import numpy as np
import pytest
from given_functions import actuate

import edl6dof
from edl6dof.interface.command import COMMAND
from edl6dof.scenario.records import build_case, build_onboard, build_tables, initial_plant
from edl6dof.vehicle.plant import PROPELLANT

LOADED = edl6dof.load("tianwen1")
NAMES = LOADED.scenario.thruster_names
BRANCHES = {branch.name: branch.thrusters for branch in LOADED.scenario.vehicle.rcs.branches}


def used(*overrides):
    """Propellant (kg) lost by the tank, and through each branch, in a flight of the entry."""
    flight = edl6dof.fly(edl6dof.load("tianwen1", ["simulation.time_limit_s=110", *overrides]))
    tank = flight.scenario.vehicle.tanks[0].mass_kg
    count = len(flight.scenario.vehicle.rcs.branches or NAMES)
    return tank - flight.plant["y"][0, PROPELLANT], flight.plant["branch_used"][0, :count]


STUCK = "{thruster: D3, kind: stuck_on, at: {time_s: 40}}"
FAULTS = {
    "sound": (),
    "stuck on": (STUCK,),
    "degraded": ("{thruster: D2, kind: degraded, degraded: {thrust_factor: 0.3}, at: {time_s: 5}}",),
    "stuck off": ("{thruster: D6, kind: stuck_off, at: {time_s: 5}}",),
}


@pytest.mark.parametrize("faults", FAULTS.values(), ids=FAULTS)
def test_what_goes_through_the_branches_is_what_the_tank_loses(faults):
    lost, through = used(f"faults=[{', '.join(faults)}]")
    assert lost > 0.3
    assert through.sum() == pytest.approx(lost, rel=1e-9)


def test_empty_tank_feeds_no_branch():
    """Repeated steps up to the moment at which it runs dry count once."""
    without = "flight_software.diagnosis.enabled=false"
    both = f"faults=[{STUCK}, {STUCK.replace('D3', 'D8')}]"  # against each other: nothing turns
    lost, through = used(both, without, "vehicle.tanks.main.mass_kg=3")
    assert lost == pytest.approx(3.0, abs=1e-8)
    assert through.sum() == pytest.approx(3.0, abs=1e-8)
    assert through[list(BRANCHES).index("D38")] > 1.0


def test_vehicle_without_branches_has_one_for_every_thruster_and_flies_the_same():
    # branches decide which thrusters a test pulse pairs
    untested = "flight_software.diagnosis.enabled=false"
    plain, own = used(untested), used(untested, "vehicle.rcs.branches=[]")
    assert own[0] == plain[0] and len(own[1]) == len(NAMES)
    for name, through in zip(BRANCHES, plain[1], strict=True):
        assert sum(own[1][NAMES.index(jet)] for jet in BRANCHES[name]) == pytest.approx(through, rel=1e-12)


def test_latch_valve_shuts_every_thruster_of_its_branch_and_no_other():
    scenario = edl6dof.load("tianwen1", [f"faults=[{STUCK}]"]).scenario
    case = build_case(scenario, build_tables(scenario))
    for number, behind in enumerate(BRANCHES.values()):
        plant, command = initial_plant(scenario, case)[0], np.zeros(1, COMMAND)[0]
        plant["t"], command["valve_open_time"], command["valve_close_time"] = 41.0, 41.0, 41.02
        command["latch_closed"][number] = 1
        actuate(case[0], command, plant)
        valves = plant["valves"]
        open_ = {name for i, name in enumerate(NAMES) if valves["close_time"][i] > valves["open_time"][i]}
        assert open_ == set(NAMES) - set(behind)


@pytest.mark.parametrize("own", [False, True])
def test_truth_and_belief_hold_the_same_branches(own):
    scenario = edl6dof.load("tianwen1", ["vehicle.rcs.branches=[]"] if own else []).scenario
    laid = {name: [name] for name in NAMES} if own else BRANCHES
    for record in (build_case(scenario, build_tables(scenario))[0], build_onboard(scenario)[0]["vehicle"]):
        branches = record["branches"]
        assert branches["count"] == len(laid)
        for number, behind in enumerate(laid.values()):
            assert [name for i, name in enumerate(NAMES) if branches["of"][i] == number] == behind
            flows = (jet.full_flow_kg_s for jet in scenario.vehicle.rcs.thrusters if jet.name in behind)
            assert branches["full_flow"][number] == pytest.approx(sum(flows), rel=1e-12)


@pytest.mark.parametrize(
    "scenario, sensors, metered, noise",
    [
        ("tianwen1_meters", "sensors.set=carried", 1, 0.001),
        ("tianwen1_meters", "sensors.flow_meters.noise_pct=0.4", 1, 0.004),
        ("tianwen1", "sensors.set=perfect", 1, 0.001),
        ("tianwen1", "sensors.set=carried", 0, 0.001),
    ],
)
def test_flight_computer_knows_whether_branches_are_metered_and_how_well(scenario, sensors, metered, noise):
    onboard = build_onboard(edl6dof.load(scenario, [sensors]).scenario)[0]
    assert onboard["flow_meters"] == metered
    assert onboard["instruments"]["flow_noise_share"] == pytest.approx(noise)
