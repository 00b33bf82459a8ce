"""Thruster diagnosis on made-up residuals: signatures written out by numpy, noise and disturbances of known
size.

The vehicle is the Tianwen-1 lander's set of 22 thrusters.  Valves follow a random schedule, the residual is
what the fault leaves by its definition, and the kernels see only the schedule and the residual.
"""

import numpy as np
import pytest

from edl6dof.config.dtype import fill
from edl6dof.fsw.allocation.effectiveness import EFFECTIVENESS, update_effectiveness
from edl6dof.fsw.diagnosis.diagnose import KIND_NAMES, WRITES, DiagnosisParams, DiagnosisSignals, diagnose
from edl6dof.fsw.diagnosis.flow_evidence import FLOW, NONE
from edl6dof.fsw.diagnosis.hypotheses import (
    HYPOTHESES,
    SUMS,
    collect,
    evidence,
    evidence_by_flow_and_thrust,
)
from edl6dof.fsw.diagnosis.residual import PLANES
from edl6dof.fsw.onboard import FSW
from edl6dof.interface.capacities import MAX_THRUSTERS
from edl6dof.interface.sensed import SENSED
from edl6dof.kernels import kernel
from edl6dof.scenario.loading import load_scenario

#: Parts of Tianwen-1 that are gone, a bit for each: heat shield, backshell, parachute pack.
LANDER = 0b111

NAMES = load_scenario("tianwen1").scenario.thruster_names
DT = 0.04


@pytest.fixture(scope="module")
def effectiveness(shared_onboard):
    record = np.zeros(1, EFFECTIVENESS)
    update_effectiveness(shared_onboard[0]["vehicle"], LANDER, np.zeros(MAX_THRUSTERS), record[0])
    return record["matrix"][0]


@kernel
def look(onboards, sensed, memories, t):
    """A cycle of diagnosis with the records of a flight, for which it is compiled."""
    onboard, memory = onboards[0], memories[0]
    signals = DiagnosisSignals(
        vehicle=onboard.vehicle,
        instruments=onboard.instruments,
        metered=onboard.flow_meters != 0,
        used=sensed[0].branch_used,
        effectiveness=memory.effectiveness.matrix,
        activity=memory.estimation.activity,
        unexplained=memory.disturbance.unexplained,
        lag=0.0,
        t=t,
        dt=DT,
        healthy=memory.health.thruster,
        loss=memory.health.loss,
    )
    diagnose(onboard.diagnosis, signals, memory.diagnosis)


class Watch:
    """The diagnosis with a valve schedule and a true fault to look at.

    ``metered``: whether there are flow meters, with errors of the sizes that are believed.
    """

    def __init__(self, onboard, effectiveness, seed=0, metered=True, **settings):
        self.onboard, self.fsw, self.sensed = onboard.copy(), np.zeros(1, FSW), np.zeros(1, SENSED)
        self.onboard["flow_meters"], self.vehicle = metered, onboard[0]["vehicle"]
        self.effectiveness, self.rng = effectiveness, np.random.default_rng(seed)
        self.true_effectiveness = effectiveness.copy()
        self.fsw["effectiveness"]["matrix"], self.params = effectiveness, self.onboard["diagnosis"]
        fill(self.params[0], DiagnosisParams(**settings))
        self.memory, self.activity = self.fsw["diagnosis"], self.fsw["estimation"]["activity"]
        self.memory["leak"]["branch"] = self.memory["hypotheses"]["meter"] = NONE
        self.healthy, self.shut = self.fsw["health"]["thruster"][0], self.memory["leak"]["latch_closed"][0]
        self.unexplained, self.used = self.fsw["disturbance"]["unexplained"][0], self.sensed["branch_used"][0]
        self.healthy[:], self.loss = 1, self.fsw["health"]["loss"][0]
        self.t, self.asked = 0.0, np.zeros(32)
        jets = self.vehicle["thrusters"][: len(NAMES)]
        self.flow = jets["thrust"] / (jets["specific_impulse"] * 9.80665)
        self.branch = self.vehicle["branches"]["of"][: len(NAMES)]
        self.branches = int(self.vehicle["branches"]["count"])
        self.scale = 1.0 + self.rng.normal(0.0, 0.01, 32)
        self.dead_meters = []

    def cycle(self, fault=None, disturbance=0.0, use=0.15, who=None, against=(), flows=True, common=0.0):
        """One control cycle with ``fault`` = (thruster number, kind, loss), or several of them in a list, or
        for a leak (thruster number, "leaking", its share of the thrust); ``who`` may fire, each for the share
        ``use`` of cycles, and those ``against`` it throughout.  Of a fault with ``flows`` false the
        propellant flows as if there were none; ``common`` is a loss of all thrusters.
        """
        firing = self.rng.random(32) < use
        if who is not None:
            firing[: len(NAMES)] &= who
        share = np.where(firing, self.rng.uniform(0.3, 1.0, 32), 0.0) * self.healthy
        share[len(NAMES) :] = 0.0
        share[list(against)] = self.healthy[list(against)]
        self.asked += share
        given = (1.0 - common) * share
        for i, kind, loss in fault if isinstance(fault, list) else [fault] if fault is not None else []:
            leak = {"stuck on": 1.0, "leaking": loss}.get(kind)
            given[i] = (1.0 - loss) * share[i] if leak is None else leak + (1.0 - leak) * share[i]
        open_to = np.append(self.shut[self.branch] == 0, np.ones(32 - len(NAMES), bool))
        given[~open_to] = 0.0
        noise = self.rng.normal(0.0, [2.0, 2.0, 2.0, 1.0, 1.0, 1.0])
        believed = (1.0 - self.loss)[:, np.newaxis] * self.effectiveness
        self.fsw["effectiveness"]["matrix"] = believed
        self.unexplained[:] = given @ self.true_effectiveness - share @ believed + noise + disturbance
        self.activity["share"], self.activity["wrench"] = share, share @ believed
        self.count(given if flows else share)
        look(self.onboard, self.sensed, self.fsw, self.t)
        self.t += DT

    def count(self, given):
        """Let the meters count what the thrusters let through."""
        full = np.bincount(self.branch, self.flow, self.branches)
        through = np.bincount(self.branch, given[: len(NAMES)] * self.flow, self.branches)
        read = self.scale[: self.branches] * through + self.rng.normal(0.0, 0.005 * full)
        read[self.dead_meters] = 0.0
        self.used[: self.branches] += read * DT

    @property
    def found(self):
        memory = self.memory[0]
        return [
            (NAMES[slot["thruster"]], KIND_NAMES[int(slot["kind"])])
            for slot in memory["isolated"][: memory["n_isolated"]]
        ]

    def mates(self, i):
        """Thrusters on the branch of ``i``, itself among them."""
        return np.flatnonzero(self.branch == self.branch[i])


def test_diagnosis_writes_its_memory_and_the_signals_that_it_declares(
    monkeypatch, shared_onboard, effectiveness
):
    """While a dead thruster is found and while a leak is looked into."""
    changed, plain = set(), look

    def watched(onboard, sensed, fsw, t):
        records = {"onboard": onboard, "sensed": sensed}
        records |= {name: fsw[name] for name in FSW.names if name != "diagnosis"}
        before = {name: record.tobytes() for name, record in records.items()}
        plain(onboard, sensed, fsw, t)
        changed.update(name for name, record in records.items() if record.tobytes() != before[name])

    monkeypatch.setitem(globals(), "look", watched)
    for fault in ((3, "stuck off", 1.0), (5, "stuck on", 0.0)):
        watch = Watch(shared_onboard, effectiveness)
        for _ in range(80):
            watch.cycle(fault)
    assert changed == {"health"} and WRITES == ("healthy", "loss")


@pytest.fixture(scope="module")
def watch_of(shared_onboard, effectiveness):
    return lambda *args, **settings: Watch(shared_onboard, effectiveness, *args, **settings)


FAULTS = [("stuck off", 1.0), ("stuck on", 0.0), ("degraded", 0.5), ("degraded", 0.2)]


def long_unless(short, *values):
    """A case that the suite makes if it is ``short``."""
    return pytest.param(*values, marks=[] if short else pytest.mark.long)


@pytest.mark.parametrize(
    ("name", "kind", "loss"),
    [
        long_unless(number // 2 % len(FAULTS) == k, name, *fault)
        for number, name in enumerate(NAMES)
        for k, fault in enumerate(FAULTS)
    ],
)
def test_every_thruster_is_named_with_its_fault(watch_of, name, kind, loss):
    """22 thrusters times four faults, one for each in the suite, first flown sound for 4 s; in free fall, or
    in air that shakes the vehicle with 0.1 % of its load from one cycle to the next.  Nothing else is named.
    """
    watch, number = watch_of(NAMES.index(name)), NAMES.index(name)
    load = 35e3 * ((number + FAULTS.index((kind, loss))) % 2)

    def air():
        return 0.001 * load * watch.rng.normal(size=6) * [0, 1, 1, 0.1, 1, 1]

    for _ in range(100):
        watch.cycle(disturbance=air())
    assert watch.found == []
    for _ in range(300):
        watch.cycle((number, kind, loss), disturbance=air())
    assert watch.found == [(name, kind)]
    unused = {"stuck on": watch.mates(number), "stuck off": [number], "degraded": []}[kind]
    assert np.flatnonzero(watch.healthy == 0).tolist() == list(unused)
    assert watch.loss[number] == pytest.approx(loss if kind == "degraded" else 0.0, abs=0.05)
    assert not np.delete(watch.loss, number).any()
    assert np.flatnonzero(watch.shut).tolist() == ([watch.branch[number]] if kind == "stuck on" else [])


@pytest.mark.parametrize(
    ("name", "kind", "loss"),
    [
        long_unless(number % 2 == k, name, *fault)
        for number, name in enumerate(name for name in NAMES if not name.startswith("F"))
        for k, fault in enumerate([("stuck off", 1.0), ("degraded", 0.5)])
    ],
)
def test_without_meters_force_and_torque_name_the_250_n_thrusters(watch_of, name, kind, loss):
    watch, number = watch_of(NAMES.index(name), metered=False), NAMES.index(name)
    who = np.array([not other.startswith("F") for other in NAMES])
    for _ in range(100):
        watch.cycle(who=who)
    while not watch.found and watch.t < 120.0:
        watch.cycle((number, kind, loss), who=who)
    assert watch.found == [(name, kind)] and watch.healthy[number] == (kind == "degraded")


@pytest.mark.parametrize("name", [long_unless(name == "D1", name) for name in ("D1", "D6", "P1", "P3")])
def test_a_cold_catalyst_is_named_by_force_and_torque_though_the_flow_is_sound(watch_of, name):
    watch, number = watch_of(3), NAMES.index(name)
    for k in range(800):
        watch.cycle((number, "degraded", 0.6) if k > 100 else None, flows=False)
    assert watch.found == [(name, "degraded")]
    # the flow is not lost, so the meter is believed to read all of it
    assert watch.loss[number] == pytest.approx(0.6, abs=0.1) and not watch.memory["flow"]["known_loss"].any()


def test_a_pair_of_one_branch_that_fires_together_shows_a_cold_catalyst(watch_of):
    """As the train of test pulses does: the flow of both is as commanded, force and torque are not zero."""
    watch = watch_of(5)
    number = NAMES.index("F5")
    for k in range(150):
        fire = watch.mates(number) if k % 3 == 0 else ()
        watch.cycle((number, "degraded", 0.6) if k > 60 else None, use=0.0, against=fire, flows=False)
    assert watch.found == [("F5", "degraded")]


@pytest.mark.parametrize("branch", [long_unless(branch % 3 == 0, branch) for branch in range(11)])
def test_a_dead_meter_costs_no_thruster_where_force_and_torque_speak(watch_of, branch):
    watch = watch_of(branch)
    for k in range(800):
        watch.dead_meters = [branch] if k > 100 else []
        watch.cycle()
    if watch.flow[watch.branch == branch].max() > 0.05:  # 25 N are next to nothing beside 250 N
        assert watch.found == [] and np.all(watch.healthy == 1)
        assert np.flatnonzero(watch.memory["flow"]["meter_failed"][0]).tolist() == [branch]


@pytest.mark.parametrize("branch", [long_unless(branch % 4 == 0, branch) for branch in range(11)])
def test_a_dead_meter_costs_no_thruster_where_force_and_torque_say_nothing(watch_of, branch):
    """In air that shakes the vehicle harder than its thrusters do, meter or latch valve stays open; when the
    air is gone, force and torque decide.
    """
    watch = watch_of(branch)
    for k in range(400):
        watch.dead_meters = [branch] if k > 100 else []
        air = 0.05 * 35e3 * watch.rng.normal(size=6) * [0, 1, 1, 0.1, 1, 1]
        watch.cycle(disturbance=air)
    assert watch.found == [] and np.all(watch.healthy == 1)
    for _ in range(800):
        watch.cycle()
    if watch.flow[watch.branch == branch].max() > 0.05:
        assert watch.found == [] and np.all(watch.healthy == 1)
        assert np.flatnonzero(watch.memory["flow"]["meter_failed"][0]).tolist() == [branch]


@pytest.mark.parametrize("branch", [long_unless(branch % 3 == 0, branch) for branch in range(8)])
def test_a_dead_branch_is_not_taken_for_a_failed_meter(watch_of, branch):
    """Its meter reads nothing, as one that has failed; its thrusters, 250 N each, are missing while
    the riser swings.
    """
    watch = watch_of(branch)
    dead = [(int(i), "stuck off", 1.0) for i in np.flatnonzero(watch.branch == branch)]
    for k in range(1500):
        swing = 0.01 * 5e3 * watch.rng.normal(size=6) * [0, 1, 1, 0.1, 1, 1]
        watch.cycle(dead if k > 100 else None, disturbance=swing)
    assert sorted(watch.found) == sorted((NAMES[i], "stuck off") for i, _, _ in dead)
    assert not watch.memory["flow"]["meter_failed"].any()


@pytest.mark.parametrize("share", [0.2, 0.45])
@pytest.mark.parametrize("branch", [long_unless(branch % 5 == 0, branch) for branch in range(11)])
def test_a_meter_that_stands_still_at_part_of_a_flow_costs_no_thruster(watch_of, branch, share):
    """It reads each thruster of its branch as degraded, and a flow at rest that no open valve explains."""
    watch, mates = watch_of(branch), np.flatnonzero(watch_of().branch == branch)
    for k in range(300):
        watch.dead_meters = [branch] if k > 50 else []
        watch.used[branch] += share * watch.flow[mates[0]] * DT * (k > 50)
        who = np.zeros(len(NAMES), bool)
        who[mates[k // 8 % len(mates)]] = k % 8 < 4  # tried in turn
        watch.cycle(who=who, use=1.0)
    assert watch.found == [] and np.all(watch.healthy == 1)
    assert np.flatnonzero(watch.memory["flow"]["meter_failed"][0]).tolist() == [branch]


@pytest.mark.parametrize("held", [0.0, 0.69])
@pytest.mark.parametrize("branch", [long_unless(branch in (0, 10), branch) for branch in range(11)])
def test_a_meter_that_fails_within_a_cycle_of_use_costs_no_thruster(watch_of, branch, held):
    """Of that cycle it reads part of the flow, then none, or the same part, ``held``, whatever happens.  The
    air shakes the vehicle harder than its thrusters do.
    """
    watch, used = watch_of(branch), int(np.flatnonzero(watch_of().branch == branch)[0])
    elsewhere = [int(np.flatnonzero(watch.branch == (branch + more) % 11)[0]) for more in (1, 2, 3)]
    for k in range(120):
        asked = np.flatnonzero(watch.memory["flow"]["test_requested"][0])
        watch.dead_meters = [branch] if k > 50 else []
        part = held if k > 51 or held > 0.0 else 0.5
        watch.used[branch] += part * watch.flow[used] * DT * (k > 50)
        fire = {*asked, used, *elsewhere} if 45 < k < 60 else ()
        air = 0.05 * 35e3 * watch.rng.normal(size=6) * [0, 1, 1, 0.1, 1, 1]
        watch.cycle(use=0.0, against=fire, disturbance=air)
    assert watch.found == [] and np.all(watch.healthy == 1)


@pytest.mark.parametrize("branch", [long_unless(branch == 2, branch) for branch in range(8)])
def test_of_a_dead_meter_force_and_torque_of_all_its_thrusters_decide(watch_of, branch):
    """The riser hides one of them while it is first tried, and the other is felt."""
    watch, (hidden, felt) = watch_of(branch), np.flatnonzero(watch_of().branch == branch)
    for k in range(200):
        watch.dead_meters = [branch] if k > 50 else []
        fire = () if k < 60 or k % 2 else (felt, hidden)[k // 2 % 2]
        fire = (fire,) if isinstance(fire, np.integer) else fire
        riser = -watch.effectiveness[hidden] if fire == (hidden,) and k < 68 else 0.0
        watch.cycle(use=0.0, against=fire, disturbance=riser)
    assert watch.found == [] and np.all(watch.healthy == 1)
    assert np.flatnonzero(watch.memory["flow"]["meter_failed"][0]).tolist() == [branch]


@pytest.mark.parametrize("branch", [long_unless(branch == 9, branch) for branch in (8, 9, 10)])
def test_a_dead_branch_that_is_used_steadily_is_not_taken_for_a_failed_meter(watch_of, branch):
    """The slow part soon holds what one of its thrusters lacks: then steady use does not speak for it."""
    watch, (steady, other) = watch_of(branch), np.flatnonzero(watch_of().branch == branch)
    dead = [(steady, "stuck off", 1.0), (other, "stuck off", 1.0)]
    for k in range(400):
        air = 25.0 * watch.rng.normal(size=6) * [0, 1, 1, 0.1, 1, 1]
        fire = (steady, other) if k in (60, 61) else (steady,) if k > 50 else ()
        watch.cycle(dead if k > 50 else None, use=0.0, against=fire, disturbance=air)
    assert not watch.memory["flow"]["meter_failed"].any()


@pytest.mark.parametrize("branch", [long_unless(branch == 4, branch) for branch in range(11)])
def test_a_meter_that_reads_less_than_no_flow_has_failed(watch_of, branch):
    watch = watch_of(branch)
    for _ in range(100):
        watch.used[branch] += 0.02 * DT * watch.rng.normal()
        watch.cycle()
    assert watch.found == [] and np.all(watch.healthy == 1) and not watch.shut.any()
    assert np.flatnonzero(watch.memory["flow"]["meter_failed"][0]).tolist() == [branch]


def test_a_meter_that_reads_a_flow_through_a_shut_valve_has_failed(watch_of):
    watch = watch_of()
    for _ in range(40):
        watch.used[3] += 0.09 * DT
        watch.cycle(use=0.0)
    assert watch.found == [] and np.all(watch.healthy == 1) and not watch.shut.any()
    assert np.flatnonzero(watch.memory["flow"]["meter_failed"][0]).tolist() == [3]


@pytest.mark.parametrize("loss", [long_unless(loss > 0.3, loss) for loss in (0.1, 0.2, 0.35)])
def test_a_loss_of_all_thrusters_is_the_propellants_and_nobodys_fault(watch_of, loss):
    watch = watch_of(5)
    for k in range(1500):
        watch.cycle(common=loss if k > 100 else 0.0)
    assert watch.found == []
    assert watch.memory["flow"]["common"][0] == pytest.approx(loss, abs=0.04)


@pytest.mark.parametrize(
    ("load", "some"),
    [(0.0, slice(0, None, 2)), (35e3, slice(1, None, 2))]
    + [pytest.param(load, slice(None), marks=pytest.mark.long) for load in (0.0, 35e3)],
)
def test_a_leak_is_shut_off_within_four_cycles_and_its_thruster_named_within_five_seconds(
    watch_of, load, some
):
    """Nothing is fired: the flow alone, and what the latch valve does to force and torque."""
    for i, name in list(enumerate(NAMES))[some]:
        watch, slow, began, shut, named = watch_of(i), np.zeros(6), None, None, None
        for k in range(200):
            slow += -slow * DT + np.sqrt(2.0 * DT) * watch.rng.normal(0.0, 0.003 * load, 6) * [
                0,
                1,
                1,
                0,
                1,
                1,
            ]
            began = watch.t if k == 60 else began
            watch.cycle((i, "stuck on", 0.0) if k >= 60 else None, disturbance=slow, use=0.0)
            if watch.shut.any() and shut is None:
                shut = watch.t - began
            if watch.found and named is None:
                named = watch.t - began
        assert watch.found == [(name, "stuck on")]
        assert shut <= 4.1 * DT and named < 5.0


@pytest.mark.parametrize("leak", [0.1, 0.3])
@pytest.mark.parametrize("number", [long_unless(n % 7 == 0, n) for n in range(len(NAMES))])
def test_a_leak_smaller_than_an_open_valve_is_no_failed_meter(watch_of, number, leak):
    watch = watch_of(number)
    for k in range(400):
        watch.cycle((number, "leaking", leak) if k > 60 else None, use=0.0)
    assert not watch.memory["flow"]["meter_failed"].any()
    assert np.flatnonzero(watch.shut).tolist() == [watch.branch[number]]
    # 2.5 N of a small thruster are less than the noise: its branch is right
    small = leak * watch.effectiveness[number, :3].max() < 5.0 and NAMES[number].startswith("F")
    right = watch.mates(number) if small else [number]
    assert [name for name, _ in watch.found] in [[NAMES[i]] for i in right]


def test_a_valve_that_shut_late_costs_no_thruster(watch_of):
    """It leaked for a while: with its latch valve open again there is no flow, and the branch is used."""
    watch = watch_of(3)
    for k in range(200):
        watch.cycle((4, "stuck on", 0.0) if 60 < k < 66 else None, use=0.0)
    assert watch.found == [] and np.all(watch.healthy == 1) and not watch.shut.any()
    assert not watch.memory["flow"]["meter_failed"].any()


def test_a_leak_older_than_the_slow_disturbance_is_found_all_the_same(watch_of):
    """It was there before anyone looked at force and torque."""
    for i in range(len(NAMES)):
        watch = watch_of(i)
        watch.params["enabled"] = 0
        for _ in range(60):
            watch.cycle((i, "stuck on", 0.0), use=0.0)
        watch.params["enabled"] = 1
        for _ in range(100):
            watch.cycle((i, "stuck on", 0.0), use=0.0)
        assert watch.found == [(NAMES[i], "stuck on")]


@pytest.mark.parametrize(
    "name", [long_unless(name in ("D1", "A2"), name) for name in ("D1", "D6", "A2", "P3")]
)
def test_without_meters_an_old_leak_is_not_taken_for_a_dead_thruster(watch_of, name):
    """Its steady effect is predictable; when the thruster is used it does not respond, as a dead one."""
    watch, number = watch_of(4, metered=False), NAMES.index(name)
    who = np.array([not other.startswith("F") for other in NAMES])
    watch.params["enabled"] = 0
    for _ in range(150):
        watch.cycle((number, "stuck on", 0.0), use=0.0)
    for _ in range(50):
        watch.cycle((number, "stuck on", 0.0), use=0.0)
    watch.params["enabled"] = 1
    while not watch.found and watch.t < 60.0:
        watch.cycle((number, "stuck on", 0.0), who=who)
    assert watch.found == [(name, "stuck on")]
    assert np.flatnonzero(watch.shut).tolist() == [watch.branch[number]]
    assert np.flatnonzero(watch.healthy == 0).tolist() == list(watch.mates(number))


@pytest.mark.parametrize(
    "name", [long_unless(name in ("P1", "A2"), name) for name in ("P1", "P4", "A2", "A3")]
)
def test_without_meters_an_opening_that_a_jerk_hides_is_found_by_the_latch_valves(watch_of, name):
    """The canopy jerks the vehicle for a second; no thruster is used after that.  Branches that this may
    concern are closed together, and those of sound thrusters are used again.
    """
    jerk = np.array([0.0, 300.0, 300.0, 0.0, 900.0, -900.0])
    for fault in ((NAMES.index(name), "stuck on", 0.0), None):
        watch, closed, most = watch_of(7, metered=False), set(), 0
        for _ in range(100):
            watch.cycle()
        for k in range(150):
            watch.cycle(fault, use=0.0, disturbance=jerk * (-0.9) ** k if k < 60 else 0.0)
            closed |= set(np.flatnonzero(watch.shut).tolist())
            most = max(most, int(watch.shut.sum()))
        assert most > 1 and (fault or {4, 5, 6, 7} <= closed)
        assert watch.found == ([(name, "stuck on")] if fault else [])
        out = watch.mates(NAMES.index(name)) if fault else []
        assert np.flatnonzero(watch.healthy == 0).tolist() == list(out)
        assert np.flatnonzero(watch.shut).tolist() == ([watch.branch[out[0]]] if fault else [])


@pytest.mark.parametrize(("leaking", "alike"), [("D1", "D8"), ("D8", "D1"), ("A1", "A4")])
def test_of_two_thrusters_that_act_alike_the_latch_valve_of_one_alone_decides(watch_of, leaking, alike):
    """The leak acts more like that of a thruster of another branch than its own effectiveness says."""
    watch, number, other = watch_of(7, metered=False), NAMES.index(leaking), NAMES.index(alike)
    own, others = watch.effectiveness[number], watch.effectiveness[other]
    watch.true_effectiveness[number] = 0.45 * own + 0.55 * others
    jerk = np.array([0.0, 300.0, 300.0, 0.0, 900.0, -900.0])
    for _ in range(100):
        watch.cycle()
    for k in range(300):
        disturbance = jerk * (-0.9) ** k if k < 60 else 0.0
        watch.cycle((number, "stuck on", 0.0), use=0.0, disturbance=disturbance)
    assert watch.found == [(leaking, "stuck on")]
    assert np.flatnonzero(watch.healthy == 0).tolist() == list(watch.mates(number))


def test_without_meters_no_branch_is_closed_whose_thrusters_all_fire(watch_of):
    """After the jerk of the canopy the axial thrusters brake.  An open valve shows when they stop."""
    axial = [k for k, name in enumerate(NAMES) if name.startswith("A")]
    jerk = np.array([0.0, 300.0, 300.0, 0.0, 900.0, -900.0])
    for fault in ((NAMES.index("A2"), "stuck on", 0.0), None):
        watch = watch_of(7, metered=False)
        for _ in range(100):
            watch.cycle()
        for k in range(200):
            watch.cycle(fault, use=0.0, against=axial, disturbance=jerk * (-0.9) ** k if k < 60 else 0.0)
            assert np.all(watch.healthy[axial] == 1)
        for _ in range(200):
            watch.cycle(fault, use=0.0)
        assert watch.found == ([("A2", "stuck on")] if fault else [])


def shaken(watch, number, cycles, size):
    """A leak that begins now, without meters, in a white disturbance of ``size`` (N, N m); the largest
    variance of the innovation while the latch valve is moved, over that before, for each component.
    """
    before, most, looks = watch.memory["residual"]["variance"][0].copy(), np.zeros(5), 0
    for _ in range(cycles):
        air = size * watch.rng.normal(size=6) * [0, 1, 1, 0.1, 1, 1]
        watch.cycle((number, "stuck on", 0.0), use=0.0, disturbance=air)
        if watch.memory["leak"]["branch"][0] == watch.branch[number]:
            most = np.maximum(most, watch.memory["residual"]["variance"][0])
            looks = max(looks, int(watch.memory["leak"]["looks"][0]))
    return most / before, looks


@pytest.mark.parametrize("name", ["P2", "D6"])
def test_a_suspected_leak_is_no_noise(watch_of, name):
    """The force that follows the latch valve stays out of the variance; else 19 looks do not decide."""
    watch, number = watch_of(3, metered=False, prior=60.0), NAMES.index(name)
    for _ in range(300):
        watch.cycle(use=0.0, disturbance=40.0 * watch.rng.normal(size=6) * [0, 1, 1, 0.1, 1, 1])
    grown, looks = shaken(watch, number, 250, 40.0)
    assert watch.found == [(name, "stuck on")] and looks == 3
    assert np.all(grown < 2.5)


@pytest.mark.parametrize("seed", [7, 8, 9])
def test_a_look_that_would_not_decide_ends(watch_of, seed):
    """A branch is closed to verify it after a jerk; then the air shakes the vehicle."""
    watch, spell, longest = watch_of(seed, metered=False), 0, 0
    jerk = np.array([0.0, 300.0, 300.0, 0.0, 900.0, -900.0])
    for _ in range(100):
        watch.cycle()
    for k in range(150):
        watch.cycle(use=0.0, disturbance=jerk * (-0.9) ** k if k < 60 else 0.0)
        if watch.memory["leak"]["branch"][0] != NONE:
            break
    for _ in range(300):
        watch.cycle(use=0.0, disturbance=2000.0 * watch.rng.normal(size=6) * [0, 1, 1, 0.1, 1, 1])
        spell = spell + 1 if watch.memory["leak"]["branch"][0] != NONE else 0
        longest = max(longest, spell)
    assert watch.found == [] and 0 < longest < 40


def test_of_two_that_fire_against_each_other_only_the_dead_one_is_named(watch_of):
    """The meter of their branch cannot tell them apart: each is doubtful, and tried alone."""
    for i in range(len(NAMES)):
        watch, pair = watch_of(i), watch_of().mates(i)
        for k in range(150):
            doubtful = np.flatnonzero(watch.memory["flow"]["doubtful"][0])
            fire = doubtful[:1] if len(doubtful) else pair if k % 25 < 3 else ()
            watch.cycle((i, "stuck off", 1.0) if k > 30 else None, use=0.0, against=fire)
        assert watch.found == [(NAMES[i], "stuck off")] and watch.healthy[pair].sum() == 1


def test_dead_thruster_is_named_after_a_few_cycles_of_use(watch_of):
    """Its use between fault and isolation, in cycles at full thrust, for all thrusters."""
    for i in range(len(NAMES)):
        watch = watch_of(i)
        for _ in range(60):
            watch.cycle()
        before = watch.asked[i]
        while not watch.found:
            watch.cycle((i, "stuck off", 1.0))
        assert watch.asked[i] - before < 4.0


@pytest.mark.parametrize("seed", [long_unless(seed < 2, seed) for seed in range(6)])
def test_a_coloured_disturbance_as_large_as_the_thrusters_isolates_nothing(watch_of, seed):
    """Lateral force and torque wander by 250 N and N m within a second, as those of air and riser may under
    their load.
    """
    watch, slow = watch_of(seed), np.zeros(6)
    for _ in range(2500):
        slow += -slow * DT / 1.0 + np.sqrt(2.0 * DT) * watch.rng.normal(0.0, [0, 250, 250, 0, 250, 250])
        watch.cycle(disturbance=slow)
    assert watch.found == []


@pytest.mark.parametrize("minutes", [4, pytest.param(20, marks=pytest.mark.long)])
def test_sound_vehicle_is_left_alone(watch_of, minutes):
    watch = watch_of(5)
    for _ in range(round(60 * minutes / DT)):
        watch.cycle()
    assert watch.found == [] and np.all(watch.healthy == 1)


def test_switched_off_it_neither_names_nor_isolates(watch_of):
    watch = watch_of(enabled=False)
    for _ in range(200):
        watch.cycle((3, "stuck on", 0.0))
    assert watch.found == [] and np.all(watch.healthy == 1)


def test_confidence_is_a_probability_and_reaches_the_threshold_when_it_isolates(watch_of):
    watch = watch_of(2)
    for k in range(120):
        watch.cycle((6, "stuck off", 1.0) if k > 50 else None)
        assert 0.0 <= watch.memory["hypotheses"]["confidence"][0] <= 1.0
    assert 0.999 <= watch.memory["isolated"][0][0]["confidence"] <= 1.0


def test_evidence_is_the_gaussian_likelihood_ratio_of_unknown_variance():
    """Against the maximised log likelihoods by numpy, for planes whose noise differs and no floor in the
    limit of large residuals.
    """
    rng, sums, exact, size = np.random.default_rng(1), np.zeros(PLANES, SUMS), 0.0, 3e4

    def most_likely(error):
        return -0.5 * len(error) * np.log(np.mean(error**2))

    for plane in sums:
        signature, residual = rng.normal(size=40), rng.choice([1e4, 1e5]) * rng.normal(size=40)
        residual += size * signature
        plane["cross"], plane["own"] = signature @ residual, signature @ signature
        plane["all"], plane["cycles"] = residual @ residual, len(residual)
        exact += most_likely(residual - size * signature) - most_likely(residual)
    assert evidence(sums, size) == pytest.approx(exact, rel=1e-6)


def test_evidence_of_flow_and_of_force_and_torque_add(shared_onboard):
    """A loss of 0.9 by the flow and of 1.0 by force and torque: the flow alone proves less than force and
    torque do, both together more.
    """
    onboard, memory, flow = shared_onboard[0], np.zeros(1, HYPOTHESES)[0], np.zeros(1, FLOW)[0]
    for _ in range(30):
        for plane in memory["off"][3]:
            collect(plane, 1.0, 7.0, 7.0, 8.0, share=1.0)
    flow["off"][3] = (0.9 * 12.0, 12.0, 30)
    found = evidence_by_flow_and_thrust(
        onboard["diagnosis"], onboard["vehicle"], waiting=False, i=3, flow=flow, memory=memory, least=0.0
    )
    by_flow, felt = 0.5 * 0.9**2 * 12.0, evidence(memory["off"][3], 0.9)
    assert by_flow < evidence(memory["off"][3], 1.0) - 0.5 * onboard["diagnosis"]["prior"] < by_flow + felt
    assert found[1:] == pytest.approx((0.9, by_flow + felt, by_flow))


@pytest.mark.parametrize(("name", "seed"), [("P1", 5), ("A2", 0)])
def test_without_meters_a_valve_that_opens_at_random_is_isolated(watch_of, name, seed):
    """Every 0.12 s it opens or shuts by chance, so some movements of the latch valve show no leak."""
    watch, number = watch_of(8, metered=False), NAMES.index(name)
    for _ in range(100):
        watch.cycle()
    for is_open in np.random.default_rng(seed).random(100) < 0.5:
        for _ in range(3):
            watch.cycle((number, "stuck on", 0.0) if is_open else None, use=0.0)
    assert watch.found == [(name, "stuck on")] and watch.shut[watch.branch[number]]
