"""Whatever ends a campaign - Ctrl-C, a kill, a full disk - ``--resume`` completes it to the same table, byte
for byte.
"""

from __future__ import annotations

import hashlib
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from campaign_run import write_drop
from forked import Forked, finished, program_with_small_files

from edl6dof.campaign import identity as origin
from edl6dof.campaign import run
from edl6dof.campaign.design.plan import load_plan
from edl6dof.campaign.store import Store
from edl6dof.config.errors import ConfigError
from edl6dof.config.plugin_files import files_naming_plugins

FOLDER = Path("runs/drops")


def begin_and_wait_for_parts(tmp_path, process, parts=3):
    end = time.monotonic() + 120.0
    while len(list((tmp_path / FOLDER / "parts").glob("0*.parquet"))) < parts:
        assert process.returncode is None, process.communicate(timeout=30)
        assert time.monotonic() < end
        time.sleep(0.002)


def resume(tmp_path) -> bytes:
    status, _, err = finished("campaign", str(FOLDER), "--resume", "-q", cwd=tmp_path)
    assert status == 0, err
    assert sorted(os.listdir(tmp_path / FOLDER)) == [
        "campaign.json",
        "campaign.yaml",
        "cases.parquet",
        "summary.json",
    ]
    return (tmp_path / FOLDER / "cases.parquet").read_bytes()


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGKILL])
def test_killed_at_any_moment(tmp_path, undisturbed, number):
    process = Forked("campaign", write_drop(tmp_path), "-q", cwd=tmp_path)
    begin_and_wait_for_parts(tmp_path, process)
    process.send_signal(number)
    _, err = process.communicate(timeout=30)
    assert process.returncode != 0
    if number == signal.SIGINT:
        assert process.returncode == 130 and "go on with: edl6dof campaign runs/drops --resume" in err
    assert not (tmp_path / FOLDER / "cases.parquet").exists()
    assert resume(tmp_path) == undisturbed


def test_killed_again_and_again(tmp_path, undisturbed):
    """Each attempt lives for a part or two; a part half written must never be taken for one."""
    process = Forked("campaign", write_drop(tmp_path), "-q", cwd=tmp_path)
    for parts in (1, 3):
        begin_and_wait_for_parts(tmp_path, process, parts)
        process.kill()
        process.communicate(timeout=30)
        process = Forked("campaign", str(FOLDER), "--resume", "-q", cwd=tmp_path)
    assert process.wait(timeout=120) == 0
    assert (tmp_path / FOLDER / "cases.parquet").read_bytes() == undisturbed


def test_damaged_part_is_flown_again(tmp_path, undisturbed):
    process = Forked("campaign", write_drop(tmp_path), "-q", cwd=tmp_path)
    begin_and_wait_for_parts(tmp_path, process)
    process.kill()
    process.communicate(timeout=30)
    part = tmp_path / FOLDER / "parts" / "000001.parquet"
    part.write_bytes(part.read_bytes()[:-100])
    assert resume(tmp_path) == undisturbed


def test_file_size_limit_stops_it_with_a_plain_word(tmp_path, undisturbed):
    """The parts fit, the table that they are put together to does not."""
    path = write_drop(tmp_path)
    status, _, err = finished("campaign", path, "-q", cwd=tmp_path, main=program_with_small_files)
    assert status == 2 and "Traceback" not in err
    assert "File too large" in err and "go on with: edl6dof campaign runs/drops --resume" in err
    assert not [name for name in os.listdir(tmp_path / FOLDER) if name.endswith(".part")]
    assert resume(tmp_path) == undisturbed


@pytest.fixture
def small_disk(tmp_path):
    disk = tmp_path / "disk"
    disk.mkdir()
    mounted = subprocess.run(
        ["mount", "-t", "tmpfs", "-o", "size=200k", "tmpfs", str(disk)], capture_output=True
    )
    if mounted.returncode != 0:
        pytest.skip(f"a small file system cannot be mounted here: {mounted.stderr.decode().strip()}")
    yield disk
    subprocess.run(["umount", str(disk)], check=False)


def test_full_disk(small_disk, undisturbed):
    path = write_drop(small_disk)
    status, _, err = finished("campaign", path, "-q", cwd=small_disk)
    assert status == 2 and "No space left on device" in err and "Traceback" not in err
    kept = list((small_disk / FOLDER / "parts").glob("0*.parquet"))
    assert kept and not list((small_disk / FOLDER / "parts").glob(".*"))
    assert subprocess.run(["mount", "-o", "remount,size=10m", str(small_disk)]).returncode == 0
    assert resume(small_disk) == undisturbed


def test_another_process_is_kept_out(tmp_path):
    """Whatever it wants: nothing of a campaign that is being flown is looked at, cleared or begun."""
    store, file = Store(tmp_path / "runs" / "drops"), write_drop(tmp_path)
    run.begin(load_plan(file), store, None)
    before = {path.name: path.read_bytes() for path in store.folder.iterdir()}
    with store.lock():
        for words in (
            (str(FOLDER), "--resume"),
            (file,),
            (file, "--force"),
            (file, "--force", "--seed", "9"),
        ):
            status, out, err = finished("campaign", *words, cwd=tmp_path)
            assert (status, out) == (2, "") and "runs/drops: another process flies this campaign" in err
    assert {path.name: path.read_bytes() for path in store.folder.iterdir()} == before
    assert finished("campaign", str(FOLDER), "--resume", "-q", cwd=tmp_path)[0] == 0


def test_memory_does_not_grow_with_the_number_of_cases():
    """8,000 cases with a plant that does nothing: the peak is that of 2,000; rows that were kept would
    add 12 MB and more.
    """
    code = """
import resource, tempfile
from pathlib import Path
from campaign_run import write_drop
from edl6dof.campaign import run
from edl6dof.campaign.design.plan import load_plan
from edl6dof.campaign.store import Store
from edl6dof.config.errors import ConfigError

class NullPlant:
    def rows(self, plan, ranges):
        for first, last in ranges:
            yield from (self.row(case) for case in plan.cases(first, last))

    def row(self, case):
        inputs = {f"truth.{path}": value for path, value in case.truth.items()}
        figures = {f"figure_{k}": k * 0.1 for k in range(20)}
        outcome = {"success": True, "cause": "", "outcome": "nothing", "end_s": 0.0}
        return {"case": case.index, **inputs, **outcome, **figures}

for cases in (2_000, 8_000):
    with tempfile.TemporaryDirectory() as folder:
        file = write_drop(Path(folder), **{"vehicle.rcs.thrusters.*.thrust_n": ""})
        plan, store = load_plan(file, cases=cases), Store(Path(folder) / "out")
        run.begin(plan, store, None)
        tally = run.fly(plan, store, NullPlant())
        assert tally.flown == cases and store.table(["case"])["case"].to_pylist() == list(range(cases))
    print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024)
"""
    here = str(Path(__file__).parent)
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([here, str(Path(here).parents[1])])}
    done = subprocess.run(
        [sys.executable, "-c", code], env=environment, capture_output=True, text=True, timeout=600
    )
    assert done.returncode == 0, done.stderr
    few, many = map(float, done.stdout.split())
    assert many - few < 7.5, (few, many)


def test_folder_remembers_its_plugins(tmp_path, monkeypatch):
    """It says which is gone, changed, not loaded or new."""
    plan, store, plugin = load_plan(write_drop(tmp_path)), Store(tmp_path / "out"), tmp_path / "law.py"
    plugin.write_text("x = 1\n")
    monkeypatch.setattr(origin, "received", [str(plugin)])
    run.begin(plan, store, None)
    was = hashlib.sha256(b"x = 1\n").hexdigest()
    assert store.info.identity.plugins == {str(plugin): was}
    run.resumed_plan(store)

    for change, words in (
        (origin.received.clear, "is not loaded in this process: set EDL6DOF_PLUGINS to it"),
        (
            lambda: origin.received.append(str(plugin)) or plugin.write_text("x = 2\n"),
            "is [0-9a-f]{12}",
        ),
        (lambda: origin.received.clear() or plugin.unlink(), "is gone"),
    ):
        change()
        with pytest.raises(ConfigError, match=f"plugin {plugin}: was {was[:12]}, {words}"):
            run.resumed_plan(store)
    monkeypatch.setattr(origin, "received", [str(plugin), "/other.py"])
    plugin.write_text("x = 1\n")
    with pytest.raises(ConfigError, match="plugin /other.py: was not there, is gone"):
        run.resumed_plan(store)


@pytest.mark.parametrize("written, named", [('["/a/law.py"]', True), ("[]  # [S]", False)])
def test_plugins_of_a_campaign_folder_are_loaded_with_it(tmp_path, written, named):
    (tmp_path / "campaign.yaml").write_text(f"name: x\nplugins: {written}\n")
    assert list(files_naming_plugins(tmp_path)) == ([tmp_path / "campaign.yaml"] if named else [])
