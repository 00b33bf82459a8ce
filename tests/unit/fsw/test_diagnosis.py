"""Thruster diagnosis on made-up residuals: signatures written out by numpy, noise and disturbances of known
size.

The vehicle is the Tianwen-1 lander's set of 22 thrusters.  Valves follow a random schedule, the residual is
what the fault leaves by its definition, and the kernels see only the schedule and the residual.
"""

import numpy as np
import pytest

from edl6dof.config.dtype import dtype_of, fill
from edl6dof.fsw.allocation.effectiveness import effectiveness_matrix
from edl6dof.fsw.diagnosis.diagnose import DIAGNOSIS, KIND_NAMES, DiagnosisParams, diagnose
from edl6dof.fsw.diagnosis.hypotheses import SUMS, collect, evidence
from edl6dof.fsw.diagnosis.probe import NONE
from edl6dof.fsw.diagnosis.residual import RESIDUAL, WINDOW, restart_residual, without_slow_part
from edl6dof.fsw.estimation.activity import ACTIVITY
from edl6dof.scenario.schema import load_scenario

#: Parts of Tianwen-1 that are gone, a bit for each: heat shield, backshell, parachute pack.
LANDER = 0b111

NAMES = load_scenario("tianwen1").scenario.thruster_names
DT = 0.04


@pytest.fixture(scope="module")
def effectiveness(shared_onboard):
    vehicle, table = shared_onboard[0]["vehicle"], np.zeros((32, 6))
    effectiveness_matrix(
        vehicle["thrusters"], len(NAMES), tuple(vehicle["configuration"][LANDER]["centre"]), table
    )
    return table


class Watch:
    """The diagnosis with a valve schedule and a true fault to look at."""

    def __init__(self, effectiveness, seed=0, **settings):
        self.effectiveness, self.rng = effectiveness, np.random.default_rng(seed)
        self.params = np.zeros(1, dtype_of(DiagnosisParams))
        fill(self.params[0], DiagnosisParams(**settings))
        self.memory = np.zeros(1, DIAGNOSIS)
        self.memory["probe"]["suspect"] = NONE
        self.activity, self.healthy, self.shut = (
            np.zeros(1, ACTIVITY),
            np.ones(32, "i8"),
            np.zeros(32, "i8"),
        )
        self.t, self.asked = 0.0, np.zeros(32)

    def cycle(self, fault=None, disturbance=0.0, load=0.0, use=0.15, who=None, against=()):
        """One control cycle with ``fault`` = (thruster number, kind, loss); ``who`` may fire, each for the
        share ``use`` of cycles, and those ``against`` it throughout.
        """
        firing = self.rng.random(32) < use
        if who is not None:
            firing[: len(NAMES)] &= who
        share = np.where(firing, self.rng.uniform(0.3, 1.0, 32), 0.0) * self.healthy
        share[len(NAMES) :] = 0.0
        share[list(against)] = self.healthy[list(against)]
        self.asked += share
        given = share.copy()
        if fault is not None:
            i, kind, loss = fault
            given[i] = 1.0 if kind == "stuck on" else (1.0 - loss) * share[i]
        given[self.shut != 0] = 0.0
        noise = np.concatenate([self.rng.normal(0, 2.0, 3), self.rng.normal(0, 1.0, 3)])
        unexplained = (given - share) @ self.effectiveness + noise + disturbance
        self.activity["share"], self.activity["wrench"] = share, share @ self.effectiveness
        arguments = (
            self.params[0],
            len(NAMES),
            np.arange(32),
            self.effectiveness,
            self.activity[0],
            load,
            unexplained,
            self.t,
            DT,
        )
        diagnose(*arguments, self.memory[0], self.healthy, self.shut)
        self.t += DT

    @property
    def found(self):
        memory = self.memory[0]
        return [
            (NAMES[slot["thruster"]], KIND_NAMES[int(slot["kind"])])
            for slot in memory["isolated"][: memory["n_isolated"]]
        ]


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize(("kind", "loss"), [("stuck off", 1.0), ("stuck on", 0.0), ("degraded", 0.5)])
def test_every_thruster_is_named_with_its_fault(effectiveness, name, kind, loss):
    """22 thrusters times three faults, first flown sound for 4 s: nothing else is ever named."""
    if kind == "degraded" and name.startswith("F"):
        pytest.skip("12 N is what the residual of a sound vehicle is allowed")
    fine = np.array([other.startswith("F") for other in NAMES])
    # 25 N are within the tolerance of the models while 250 N thrusters fire
    who = fine if name.startswith("F") else ~fine
    watch = Watch(effectiveness, seed=NAMES.index(name))
    for _ in range(100):
        watch.cycle(who=who)
    assert watch.found == []
    for _ in range(600):
        watch.cycle((NAMES.index(name), kind, loss), who=who)
    assert [who for who, _ in watch.found] == [name]
    if not name.startswith("F"):  # the loss of 25 N is measured to a tenth or two: it may pass for degraded
        assert watch.found == [(name, kind)]
    assert watch.healthy[NAMES.index(name)] == 0
    assert watch.shut[NAMES.index(name)] == (watch.found[0][1] == "stuck on")
    assert watch.healthy[: len(NAMES)].sum() == len(NAMES) - 1


def test_dead_thruster_is_named_after_a_few_cycles_of_use(effectiveness):
    """Its use between fault and isolation, in cycles at full thrust, for the eight horizontal thrusters."""
    for i in range(8):
        watch = Watch(effectiveness, seed=i)
        for _ in range(60):
            watch.cycle()
        before = watch.asked[i]
        while not watch.found:
            watch.cycle((i, "stuck off", 1.0))
        assert watch.asked[i] - before < 8.0


@pytest.mark.parametrize("seed", range(6))
def test_a_coloured_disturbance_as_large_as_the_thrusters_isolates_nothing(effectiveness, seed):
    """Lateral force and torque wander by 250 N and N m within a second, as those of air and riser may under
    their load.
    """
    watch, slow = Watch(effectiveness, seed), np.zeros(6)
    for _ in range(2500):
        slow += -slow * DT / 1.0 + np.sqrt(2.0 * DT) * watch.rng.normal(0.0, [0, 250, 250, 0, 250, 250])
        watch.cycle(disturbance=slow, load=10000.0)
    assert watch.found == []


def test_sound_vehicle_is_left_alone_for_an_hour(effectiveness):
    watch = Watch(effectiveness, 5)
    for _ in range(90000):
        watch.cycle()
    assert watch.found == [] and np.all(watch.healthy == 1)


def test_thruster_stuck_on_since_before_anyone_looked_is_found_by_shutting_it_off(effectiveness):
    """Nothing is fired, and the thrust is there from the first cycle after a restart: part of the slow
    disturbance.
    """
    for i in range(20):
        watch = Watch(effectiveness, i)
        restart_residual(watch.memory[0]["residual"])
        for _ in range(100):
            watch.cycle((i, "stuck on", 0.0), use=0.0)
        assert watch.found == ([(NAMES[i], "stuck on")] if i < 16 else [])  # 25 N may be misalignment
        assert np.sum(watch.shut) == (1 if i < 16 else 0)


def test_probe_of_a_sound_thruster_gives_it_back(effectiveness):
    """A constant disturbance that looks exactly like D1 stuck on."""
    watch, shut = Watch(effectiveness), 0
    restart_residual(watch.memory[0]["residual"])
    for _ in range(300):
        watch.cycle(disturbance=effectiveness[0], use=0.0)
        shut += int(watch.shut[0])
    assert watch.found == [] and 5 < shut < 60 and watch.healthy[0] == 1 and watch.shut[0] == 0


def test_a_swing_under_the_canopy_makes_no_thruster_suspect(effectiveness):
    """The riser turns the vehicle to and fro once in a second, with three times the torque of a thruster: the
    mean that is taken for the slow disturbance looks like one at times.
    """
    watch, shut = Watch(effectiveness, 3), 0
    restart_residual(watch.memory[0]["residual"])
    for k in range(2000):
        swing = np.sin(2.0 * np.pi * k * DT) * np.array([0.0, 250.0, 180.0, 0.0, 560.0, -800.0])
        watch.cycle(disturbance=swing, load=14000.0, use=0.0)
        shut += int(watch.shut.sum())
    assert shut == 0 and watch.found == []


def test_a_probe_that_decides_nothing_trusts_nobody(effectiveness):
    """P2 is shut just when P1, which fired all the time, rests: P1 dead and P2 stuck on look alike."""
    p1, p2 = NAMES.index("P1"), NAMES.index("P2")
    watch = Watch(effectiveness)
    nobody = np.zeros(len(NAMES), bool)
    for k in range(120):
        fault = (p2, "stuck on", 0.0) if k > 60 else None
        fires = fault is not None and watch.shut[p2] == 0
        watch.cycle(fault, use=0.0, who=nobody, against=(p1,) if fires else ())
    assert watch.shut.sum() <= 1 and watch.healthy[p1] == 1
    assert watch.memory[0]["probe"]["trusted_until"][p2] == 0.0
    assert watch.found in ([], [("P2", "stuck on")])


def test_switched_off_it_neither_names_nor_isolates(effectiveness):
    watch = Watch(effectiveness, enabled=False)
    for _ in range(200):
        watch.cycle((3, "stuck on", 0.0))
    assert watch.found == [] and np.all(watch.healthy == 1)


def test_confidence_is_a_probability_and_reaches_the_threshold_when_it_isolates(effectiveness):
    watch = Watch(effectiveness, 2)
    for k in range(120):
        watch.cycle((6, "stuck off", 1.0) if k > 50 else None)
        assert 0.0 <= watch.memory["hypotheses"]["confidence"][0] <= 1.0
    assert 0.999 <= watch.memory["isolated"][0][0]["confidence"] <= 1.0


def test_evidence_is_the_gaussian_likelihood_ratio_of_unknown_variance(effectiveness):
    """Against the maximised log likelihoods by numpy, for two independent components and no floor in the
    limit of large residuals.
    """
    rng, sums = np.random.default_rng(1), np.zeros(1, SUMS)[0]
    signature, residual = rng.normal(size=40), 1e4 * rng.normal(size=40)
    residual += 3e4 * signature
    for s, y in zip(signature, residual, strict=True):
        collect(sums, 1.0, s, y, 1.0, y * y)
    size = sums["cross"] / sums["own"]

    def most_likely(error):
        return -0.5 * 2 * len(error) * np.log(np.mean(error**2))

    assert evidence(sums, size) == pytest.approx(
        most_likely(residual - size * signature) - most_likely(residual), rel=1e-6
    )


def test_slow_part_is_the_late_mean_by_numpy():
    rng, memory = np.random.default_rng(2), np.zeros(1, RESIDUAL)[0]
    restart_residual(memory)
    history, slow = [], np.zeros(6)
    for k in range(200):
        unexplained = rng.normal(size=6) + 50.0
        known = without_slow_part(0.4, unexplained, np.zeros(32), 22, DT, memory)
        if k >= WINDOW:
            slow = slow + max(DT / 0.4, 1.0 / (k - WINDOW + 1)) * (history[k - WINDOW] - slow)
            assert memory["value"] == pytest.approx(unexplained - slow, abs=1e-12)
        assert (known > 0) == (k - WINDOW >= 3)
        history.append(unexplained)
