"""A user's own law in a file outside the package: it flies, its mistakes are named in one line, and editing
it is never overlooked.
"""

import json
import os
import re
import subprocess
import sys
from math import sqrt
from pathlib import Path

import pytest

from edl6dof import plugins
from edl6dof.config.document.locate import find_shipped
from edl6dof.config.errors import ConfigError
from edl6dof.config.plugin_files import accept
from edl6dof.fsw.guidance.entry.registry import ENTRY_LAWS
from edl6dof.kernels import cache, kernel
from edl6dof.registry import Member
from edl6dof.scenario.loading import load_scenario
from edl6dof.scenario.plugin_trial import try_on_plan

EXAMPLE = Path(__file__).parents[3] / "scenarios" / "plugin" / "energy_law.py"

LAW = """
from edl6dof.config.base import Params
from edl6dof.kernels import kernel
from edl6dof.registry import Member

class MineParams(Params):
    "Mine."

@kernel
def guide(params, plan, onboard, nav, memory, out):
    "Mine."
    return 0.5

FAMILY = "entry_law"
MEMBER = Member("mine", MineParams, {"guide": guide}, "me, 2026")
"""

ESTIMATOR = """
from edl6dof.config.base import Params
from edl6dof.kernels import kernel
from edl6dof.registry import Member

class NoneParams(Params):
    "No estimate."

@kernel
def estimate(params, measured, dt, memory, out):
    "Estimate nothing."
    out.pole = 1.0 / dt

FAMILY = "estimator"
MEMBER = Member("blind", NoneParams, {"estimate": estimate}, "null member")
"""


def write_accepted(file, text):
    """Write a plugin that the user of the suite has accepted."""
    file.write_text(text, encoding="utf-8")
    accept(file, file.read_bytes())


def scenario_with(folder, plugin):
    """The shipped Tianwen-1 scenario with a plugin named in line 2."""
    text = find_shipped("scenarios", "tianwen1").read_text(encoding="utf-8")
    assert "name: tianwen1" in text
    text = text.replace("name: tianwen1", f'name: tianwen1\nplugins: ["{plugin}"]', 1)
    file = folder / "mine.yaml"
    file.write_text(text, encoding="utf-8")
    return file


@pytest.fixture(autouse=True)
def plugins_of_this_process(monkeypatch):
    """Tests may try plugins; nothing of that stays."""
    monkeypatch.setattr(plugins, "ACTIVE", {})
    monkeypatch.setattr(cache, "received", {})
    monkeypatch.setattr(cache, "_in_loop", [])
    yield
    for known in (cache.folder, cache.stamp):
        known.cache_clear()


# ---- mistakes ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "name, text, message",
    [
        ("missing.py", None, "is no such file"),
        ("law.txt", LAW, "must be a Python file"),
        ("law.py", LAW.replace("return 0.5", "return 0.5)"), "cannot be imported: SyntaxError: unmatched"),
        (
            "law.py",
            LAW.replace("edl6dof.kernels", "edl6dof.karnels"),
            "cannot be imported: ModuleNotFoundError.*line 3",
        ),
        (
            "law.py",
            LAW.replace("entry_law", "entry law"),
            "must say FAMILY = one of entry_law, reversal, .*got 'entry law'",
        ),
        ("law.py", LAW.replace("MEMBER =", "LAW ="), r"must define MEMBER = Member\(...\)"),
        (
            "law.py",
            LAW.replace("(params, plan, onboard, nav, memory, out)", "(onboard, nav, mem, out)"),
            r"must define guide\(params, plan, onboard, nav, memory, out\) "
            r"\(got guide\(onboard, nav, mem, out\)",
        ),
        ("law.py", LAW.replace('{"guide"', '{"steer"'), r"must give the kernel guide \(got steer\)"),
        ("law.py", LAW.replace("@kernel", ""), "must compile 'guide' with @kernel"),
        ("law.py", LAW.replace('"mine"', '"My law"'), "no lower-case identifier"),
        (
            "law.py",
            ESTIMATOR.replace("measured, dt, memory, out", "dt, memory, out"),
            r"must define estimate\(params, measured, dt, memory, out\)",
        ),
        ("law.py", LAW, "comes too late: the family of entry guidance laws was built"),
    ],
)
def test_plugin_that_cannot_be_used_is_named_with_the_line_that_names_it(tmp_path, name, text, message):
    if text is not None:
        write_accepted(tmp_path / name, text)
    file = scenario_with(tmp_path, name)
    import edl6dof.fsw.onboard  # noqa: F401  the families exist

    with pytest.raises(ConfigError, match=message) as caught:
        plugins.activate([file])
    (problem,) = caught.value.problems
    assert problem.file.endswith("mine.yaml") and problem.path == "plugins.0"
    assert file.read_text().splitlines()[problem.line - 1].startswith("plugins:")


def test_scenario_loaded_past_the_command_line_says_what_to_do(tmp_path):
    from edl6dof.scenario.loading import load_scenario

    write_accepted(tmp_path / "law.py", LAW)
    with pytest.raises(ConfigError, match="comes too late.*load this scenario first.*EDL6DOF_PLUGINS"):
        load_scenario(scenario_with(tmp_path, "law.py"))


def test_environment_may_name_plugins_and_is_named_in_their_mistakes(tmp_path, monkeypatch):
    monkeypatch.setenv("EDL6DOF_PLUGINS", str(tmp_path / "gone.py"))
    with pytest.raises(ConfigError, match=r"^EDL6DOF_PLUGINS: plugin .*gone.py is no such file$"):
        plugins.activate([])


def test_plugins_cannot_be_set_on_the_command_line():
    from edl6dof.scenario.loading import load_scenario

    with pytest.raises(ConfigError, match="must be named in the scenario file"):
        load_scenario("tianwen1", ["plugins=[law.py]"])


def cli(*arguments, cores=None):
    """The command line in a fresh process: (exit status, standard output, standard error).

    ``cores``: on so many; on one a flight is compiled by one process, in two thirds of the work of two.
    """
    code = (
        f"import sys; sys.argv = ['edl6dof', *{[str(a) for a in arguments]!r}]; from edl6dof.cli import "
        "main; main()"
    )
    if cores is not None and hasattr(os, "sched_setaffinity"):
        code = f"import os; os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[-{cores}:]); {code}"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=900)
    return run.returncode, run.stdout, run.stderr


#: A plugin, what is wrong in it, and what is said of that.
WRONG = [
    (LAW, "return 0.5", "return nav.bonk", "guide: uses a field that its records do not have: .bonk"),
    (LAW, "return 0.5", "return nav.speed.bonk", "guide: does not compile: Unknown attribute.*bonk"),
    (LAW, "return 0.5", "return 1, 2", r"guide: must return a bank angle \(float\) \(got tuple\)"),
    (
        *(LAW, "return 0.5", "nav.speed = 3.0\n    return 0.5"),
        r"guide: writes nav.speed, which it may only read \(was 0, now 3\)",
    ),
    (
        *(LAW, "return 0.5", "onboard.planet.mu *= 2.0\n    return 0.5"),
        r"guide: writes onboard.planet.mu, which it may only read \(was 0.5",
    ),
    (ESTIMATOR, "out.pole = 1.0 / dt", "return out.pole", "estimate: must return nothing"),
    (ESTIMATOR, "out.pole", "measured.bonk", "estimate: uses a field that its records do not have: .bonk"),
]


def test_kernels_that_do_not_fit_are_refused_before_the_simulator_is_compiled(tmp_path):
    """Each in one line."""
    for number, (text, old, new, _) in enumerate(WRONG):
        assert old in text
        own = re.sub('Member\\("(mine|blind)"', rf'Member("my_{number}"', text.replace(old, new))
        write_accepted(tmp_path / f"wrong_{number}.py", own)
    files = ", ".join(f"wrong_{number}.py" for number in range(len(WRONG)))
    (tmp_path / "mine.yaml").write_text(f"extends: tianwen1\nname: mine\nplugins: [{files}]\n")
    status, _, error = cli("check", tmp_path / "mine.yaml")
    assert status == 2
    lines = error.strip().splitlines()
    assert len(lines) == len(WRONG), error
    for number, (line, (*_, message)) in enumerate(zip(lines, WRONG, strict=True)):
        assert f"wrong_{number}.py" in line and re.search(message, line)


@kernel
def _writes_when_slow(params, plan, onboard, nav, memory, out):
    if nav.speed < 2000.0:
        nav.drag = 1.0
    return 0.5


@kernel
def _infinite_when_slow(params, plan, onboard, nav, memory, out):
    out.reference_drag = 1.0 / max(nav.speed - 2000.0, 0.0)
    return 0.5


@kernel
def _no_number_when_slow(params, plan, onboard, nav, memory, out):
    return sqrt(nav.speed - 2000.0)


@kernel
def _all_is_well(params, plan, onboard, nav, memory, out):
    out.reference_drag, memory.unused = nav.drag, nav.speed
    return 0.5


@pytest.mark.parametrize(
    ("guide", "message"),
    [
        (
            _writes_when_slow,
            r"guide: writes nav.drag, which it may only read \(was [\d.]+, now 1\) at 1\d{3} m/s of the plan",
        ),
        (_infinite_when_slow, r"guide: writes out.reference_drag, which is not finite, at 1\d{3} m/s"),
        (_no_number_when_slow, r"guide: returns nan at 1\d{3} m/s of the planned entry"),
        (_all_is_well, ""),
    ],
)
def test_law_is_tried_along_the_planned_entry(monkeypatch, guide, message):
    """A write or a result that only some states show; the law takes the name of one of the package."""
    scenario = load_scenario("tianwen1", ["flight_software.guidance.entry.law=constant_bank"]).scenario
    member = ENTRY_LAWS.member("constant_bank")
    tried = Member("constant_bank", member.params, {"guide": guide}, "made up")
    monkeypatch.setattr(plugins, "ACTIVE", {Path("mine.py"): ("entry_law", tried)})
    if message:
        with pytest.raises(ConfigError, match=message):
            try_on_plan(scenario)
    else:
        try_on_plan(scenario)


def test_name_of_a_law_of_the_package_is_refused(tmp_path):
    write_accepted(tmp_path / "law.py", LAW.replace('"mine"', '"npc"'))
    status, _, error = cli("check", scenario_with(tmp_path, "law.py"))
    assert status == 2 and len(error.strip().splitlines()) == 1
    assert "entry guidance law of the package is called npc already" in error


@pytest.mark.long
def test_estimator_of_a_plugin_is_chosen_by_name(tmp_path):
    write_accepted(tmp_path / "law.py", ESTIMATOR)
    file = tmp_path / "mine.yaml"
    chosen = "flight_software: {estimation: {estimator: blind}}"
    file.write_text(f"extends: tianwen1\nname: mine\nplugins: [law.py]\n{chosen}\n")
    status, _, error = cli("check", file)
    assert (status, error) == (0, "")


IDLE = """
from edl6dof.config.base import Params
from edl6dof.kernels import kernel
from edl6dof.registry import Member

class IdleParams(Params):
    "No thruster fires."

@kernel
def share_out(params, shared, vehicle, healthy, effectiveness, demand, memory, duty, unallocated):
    "Leave the whole demand."
    for i in range(vehicle.n_thrusters):
        duty[i] = 0.0
    for i in range(unallocated.shape[0]):
        unallocated[i] = demand.wrench[i]

FAMILY = "allocator"
MEMBER = Member("idle", IdleParams, {"share_out": share_out}, "null member")
"""

CAREFREE = """
from edl6dof.config.base import Params
from edl6dof.kernels import kernel
from edl6dof.registry import Member

class CarefreeParams(Params):
    "Every cell is safe."

@kernel
def classify(params, elevation_map, footprint, radius, deviation, out):
    "Take every cell for safe."
    out.cell_class[:] = 0

FAMILY = "hazard_detector"
MEMBER = Member("carefree", CarefreeParams, {"classify": classify}, "null member")
"""

LATE = """
from edl6dof.config.base import param
from edl6dof.kernels import kernel
from edl6dof.registry import Member
from edl6dof.vehicle.faults.component import ThrusterFault

class LateParams(ThrusterFault):
    "A valve opens late."
    failure = "stuck_off"
    delay_s: float = param(0.05, "delay", ge=0.0)

@kernel
def inflict(fault, case, since, command, plant):
    "Open late."
    plant.valves.open_time[fault.component] += fault.params.late.delay

FAMILY = "fault_kind"
MEMBER = Member("late", LateParams, {"inflict": inflict}, "a made-up valve")
"""


@pytest.mark.long
def test_allocator_hazard_detector_and_kind_of_fault_of_plugins_are_tried_and_chosen(tmp_path):
    for name, text in (("idle", IDLE), ("carefree", CAREFREE), ("late", LATE)):
        write_accepted(tmp_path / f"{name}.py", text)
    chosen = (
        "flight_software: {allocation: {method: idle}, hazard: {detection: carefree}}\n"
        "faults: [{kind: late, thruster: D7, at: {time_s: 1}}]\n"
    )
    file = tmp_path / "mine.yaml"
    file.write_text(
        f"extends: tianwen1_hazards\nname: mine\nplugins: [idle.py, carefree.py, late.py]\n{chosen}"
    )
    status, _, error = cli("check", file)
    assert status == 0, error


# ---- cache -------------------------------------------------------------------------------------------------


def test_folder_follows_a_model_compiled_with_the_loop_and_no_member_that_is_passed(tmp_path):
    found = {cache.folder()}
    cache.receive(tmp_path / "law.py", LAW.encode(), in_loop=False)
    assert {cache.folder()} == found
    for content in (b"x = 1", b"x = 2"):
        cache.receive(tmp_path / "air.py", content, in_loop=True)
        found.add(cache.folder())
    assert len(found) == 3


FAMILIES = """
import json
from edl6dof import registry
import edl6dof.campaign.design.sections, edl6dof.sim.functions
from edl6dof.plugins import FAMILIES
print(json.dumps([sorted(registry._built), sorted(place.title for place in FAMILIES.values())]))
"""


def test_every_family_takes_plugins():
    run = subprocess.run([sys.executable, "-c", FAMILIES], capture_output=True, text=True, timeout=300)
    built, open_to_plugins = json.loads(run.stdout)
    assert built == open_to_plugins


def test_family_is_read_from_the_text_and_nothing_of_it_runs():
    assert plugins.said_family(f"{LAW}\nraise SystemExit\n".encode()) == "entry_law"
    assert plugins.said_family(b'FAMILY = "entry" + "_law"\n') == plugins.said_family(b"= nonsense") == ""


STEER = """
import numpy as np
from edl6dof import plugins
plugins.activate([{scenario!r}])
from edl6dof.fsw.functions import PLACES
from edl6dof.fsw.guidance.guidance_command import GUIDE
from edl6dof.fsw.guidance.entry.reversal.registry import REVERSALS
from edl6dof.fsw.navigation.derived import NAV
from edl6dof.fsw.onboard import ONBOARD

onboard, nav, out = (np.zeros(1, t)[0] for t in (ONBOARD, NAV, GUIDE))
memory, params = np.zeros(1, REVERSALS.memory)[0], onboard["guidance"]["entry"]["reversal"]
index = REVERSALS.names.index("mine")
side = PLACES["bank_side"].function({{index}}).kernel
print(side(index, params, onboard, nav, memory, out, 1.25, 1.0), sum(side.called.stats.cache_hits.values()))
"""

SIDE = LAW.replace(
    "guide(params, plan, onboard, nav, memory, out)", "side(params, onboard, nav, memory, out, wanted, sign)"
).replace('{"guide": guide}', '{"side": side}')


@pytest.mark.long
def test_edited_plugin_is_compiled_again_and_an_unchanged_one_is_not(tmp_path, monkeypatch):
    """A reversal logic in a process of its own each time: result, and whether numba took it from the
    cache.
    """
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "cache"))
    law, found = tmp_path / "law.py", []
    scenario = scenario_with(tmp_path, "law.py")
    for side in (1.0, 1.0, -1.0):
        write_accepted(law, SIDE.replace("entry_law", "reversal").replace("return 0.5", f"return {side}"))
        run = subprocess.run(
            [sys.executable, "-c", STEER.format(scenario=str(scenario))],
            capture_output=True,
            text=True,
            timeout=300,
        )
        assert run.returncode == 0, run.stderr
        side, hits = run.stdout.split()
        found.append((float(side), int(hits)))
    assert found == [(1.0, 0), (1.0, 1), (-1.0, 0)]


# ---- the example -------------------------------------------------------------------------------------------


def test_example_law_has_thirty_lines_and_flies_to_the_parachute(tmp_path):
    """From a scenario that extends the shipped one, on perfect sensors: for each plugin all of the flight
    software is compiled that a flight calls.  The scenario that it leaves finds the law again.
    """
    code = [line for line in EXAMPLE.read_text().split('"""', 2)[2].splitlines() if line.strip()]
    assert len(code) <= 30
    changes = "mission: {goal: deployment}\nsensors: {set: perfect}\n"
    (tmp_path / "mine.yaml").write_text(f"extends: plugin/energy_law\nname: mine\n{changes}")
    run = tmp_path / "run"
    status, _, error = cli("fly", tmp_path / "mine.yaml", "--out", run, "--no-replay", "--quiet", cores=1)
    assert status == 0, error
    figures = json.loads((run / "summary.json").read_text())["figures"]
    assert figures["parachute_miss_m"] < 10e3
    # triggered at navigated Mach 1.8, in air colder than believed
    assert figures["parachute_mach"] == pytest.approx(1.8, abs=0.1)
    status, out, error = cli("check", run / "scenario.yaml")
    assert status == 0 and "scenario.yaml: ok" in out, error
    assert str(EXAMPLE) in (run / "scenario.yaml").read_text()
