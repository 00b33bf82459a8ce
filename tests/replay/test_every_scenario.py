"""Every shipped scenario can be replayed, and its replay speaks of nothing that the vehicle does not have."""

from __future__ import annotations

from pathlib import Path

import pytest
from made_up import entities

import edl6dof
from edl6dof.replay.recording import history, write_replay
from edl6dof.replay.scene.outline import outline

pytest.importorskip("rerun")

FOLDER = Path(edl6dof.__file__).parents[1] / "scenarios"
#: Those of the same vehicle and planet as another one are left out.
ALIKE = {"tianwen1_mc", "tianwen1_range_trigger", "msl_range_trigger", "case04", "case05", "case07"}
ALIKE |= {
    "tianwen1_meters",
    "tianwen1_trn",
    "case08",
    "case09",
    "case10",
    "energy_law",
    "stop_rates",
    "msl_mc",
    "msl_landing_mc",
    "mars2020",
    "mars2020_mc",
}
ALIKE |= {"viking1_mc", "pathfinder_mc", "stardust_mc", "genesis_mc", "genesis_planned", "genesis_planned_mc"}
ALIKE |= {"stop_rates", "phoenix_mc", "insight", "insight_mc", "schiaparelli_mc"}
#: Those that have no part which no other one has.
LONG = {"tianwen1", "msl", "genesis", "yan2016", "zheng2015", "case01", "case02", "case03"}
LONG |= {"pathfinder", "phoenix", "schiaparelli", "titan_probe"}
SCENARIOS = [
    pytest.param(path, id=path.stem, marks=pytest.mark.long if path.stem in LONG else ())
    for path in sorted(FOLDER.rglob("*.yaml"))
    if path.stem not in ALIKE
]


def words_of_absent_parts(vehicle) -> set[str]:
    """Words in entities that would speak of something that the vehicle has not."""
    jets, look = [jet.name for jet in vehicle.rcs.thrusters], outline(vehicle)
    kept = {
        "heat_shield": vehicle.showing("capsule"),
        "backshell": vehicle.showing("backshell"),
        "trim_wing": vehicle.surfaces,
        "nozzles": vehicle.engines or jets,
        "engine": vehicle.engines,
        "thrust": vehicle.engines or jets,
        "dust": vehicle.engines,
        "thruster": jets,
        "phase_plane": jets,
        "torque": jets,
        "diagnosis": jets,
        "lander": look.lander != "none",
        "legs": vehicle.landing_gear.footpads_m and look.lander in ("legs", "rover"),
        "parachute": [chute for chute in vehicle.parachutes if chute.pack],
        "canopy": [chute for chute in vehicle.parachutes if chute.pack],
        "riser": vehicle.parachutes,
        "propellant": vehicle.tanks,
        "powered": vehicle.engines,
        "forebody": look.body == "sphere_cone" and not vehicle.showing("capsule"),
        "vehicle/body": look.body in ("sphere", "box"),
    }
    return {word for word, there in kept.items() if not there}


@pytest.mark.parametrize("path", SCENARIOS)
def test_replay_of_the_first_second_speaks_of_what_is_there(path, tmp_path):
    flight = edl6dof.fly(str(path), ["simulation.time_limit_s=1.0", "mission.goal=time"])
    write_replay([history(flight)], tmp_path / "replay.rrd")
    vehicle = flight.scenario.vehicle
    held = {entity.lower() for entity in entities(tmp_path / "replay.rrd")}
    assert "/site/vehicle" in held and "/site/ground" in held
    absent = words_of_absent_parts(vehicle)
    told = {entity for entity in held for word in absent if word in entity}
    assert told == set()
    assert len(absent) < 21, "some of it is there"
