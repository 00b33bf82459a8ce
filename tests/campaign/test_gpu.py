"""The engine that flies on a GPU, where there is none: on numba's simulator, and refused."""

from __future__ import annotations

import json
import os
import runpy
import subprocess
import sys
from contextlib import closing
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
from campaign_run import ROOT, write_drop
from gpu_simulator import CASES

import edl6dof as package
from edl6dof.campaign import run
from edl6dof.campaign.design.case import Case
from edl6dof.campaign.design.plan import load_plan
from edl6dof.campaign.executor import CaseRunner
from edl6dof.campaign.gpu import device, layouts
from edl6dof.campaign.gpu.crew import Helpers, awaited
from edl6dof.campaign.gpu.host import Host, Left
from edl6dof.campaign.storage.files import StoreError
from edl6dof.campaign.storage.store import Store
from edl6dof.fsw.onboard import FSW
from edl6dof.interface.sensed import SENSED
from edl6dof.records import offset
from edl6dof.sensors.registry import SENSORS
from edl6dof.sim.underway import NO_BRIEFS, Underway, log_rows
from edl6dof.telemetry.channels import BRIEF


@pytest.mark.exact_start
@pytest.mark.long
def test_simulated_gpu_gives_the_rows_of_threads():
    """To the last bit, from the rows of telemetry that figures need: a batch for a GPU changes nothing in a
    flight, and one that cannot fly keeps its place.  A flight that needs more rows than there is room for is
    flown again with all of them.
    """
    mine = CaseRunner(package.load("tianwen1")).fly(CASES)  # compiles what the simulator calls
    words = [sys.executable, str(Path(__file__).with_name("gpu_simulator.py"))]
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "NUMBA_ENABLE_CUDASIM": "1"}
    done = subprocess.run(words, env=environment, capture_output=True, text=True, timeout=1200)
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    assert len({row["outcome"] for row in mine}) > 2 and found["batches"] == [[3, True], [1, True]]
    assert found["rows"] == json.loads(json.dumps(mine))
    assert 0 < max(found["telemetry"]) < 200
    assert found["then"] == [[1, True], [1, False]] and found["crowded"] == found["rows"][:1]


@pytest.mark.exact_start  # which processes of the program build that are not nudged
def test_helpers_prepare_cases_and_make_rows_as_this_process_does(tmp_path):
    """One that dies is missed; of a case that cannot fly they hand on nothing, and say why in its row."""
    plan = load_plan(write_drop(tmp_path))
    unflyable = Case(2, truth={"vehicle.mass.entry_kg": -1.0})
    cases, runner = [*plan.cases(0, 2), unflyable], CaseRunner(plan.loaded)
    with closing(Helpers(plan, 1)) as helpers:
        starts = awaited(helpers.prepare(0, cases))
        assert starts == Host(runner).prepare(cases) and starts[2] is None
        assert awaited(helpers.again(0, cases[0])).layout == layouts.WHOLE_LOG
        assert awaited(helpers.again(0, cases[1])).needs == b""
        left = [left_by(runner.variants.build(case)) for case in cases[:2]]
        assert awaited(helpers.rows(0, cases, [*left, None])) == runner.fly(cases)
        with pytest.raises(OSError, match="has died"):
            awaited(helpers.prepare(0, Fatal()))


class Fatal(list):
    """Cases that kill who receives them."""

    def __reduce__(self):
        return os._exit, (1,)


def left_by(variant):
    """What a flight leaves on a GPU that keeps every row, flown here."""
    flight = Underway(variant.loaded, parts=variant.parts, log=np.zeros(log_rows(variant.loaded), BRIEF))
    flight.advance(flight.last_cycle + 1)
    changed = ("plant", "outputs", "peaks", "work", "sensors", "fsw")
    own = {name: getattr(flight, name).tobytes() for name in changed}
    return Left(own, flight.log[: flight.rows].tobytes(), flight.code, flight.cycle)


def test_a_flight_without_eyes_touches_no_image(nominal):
    """What its records on a GPU leave out is neither read nor written."""
    flight = Underway(nominal.loaded, log=NO_BRIEFS)
    own = layouts.LEAN.own
    images = [*left_out(flight.sensors, own["sensors"]), *left_out(flight.fsw, own["fsw"])]
    assert sum(image.nbytes for image in images) > 4_000_000
    assert own["sensors"].itemsize + own["fsw"].itemsize < 120_000
    # where the look for what is not finite finds its words
    assert all(offset(own["fsw"], name) == offset(FSW, name) for name in FSW.names)
    assert offset(own["sensors"], "sensed") == offset(SENSORS, "sensed")
    seen = own["sensors"]["sensed"]
    before_images = SENSED.names[: SENSED.names.index("lidar")]
    assert all(offset(seen, name) == offset(SENSED, name) for name in before_images)
    for image in images:  # no numbers, and indices out of range
        image[...] = np.frombuffer(b"\xff" * image.itemsize, image.dtype)[0]
    poisoned = [image.tobytes() for image in images]
    flight.advance(flight.last_cycle + 1)
    assert flight.plant.tobytes() == nominal.plant.tobytes()
    assert [image.tobytes() for image in images] == poisoned


def left_out(records, lean, outer=1):
    """Views of the arrays that are smaller in a lean layout; ``outer``: axes of arrays that hold them."""
    if records.shape[outer:] != lean.shape:
        return [records]
    inner = outer + len(lean.shape)
    names = lean.base.names or ()
    return [one for name in names for one in left_out(records[name], lean.base[name], inner)]


def test_without_numba_cuda_or_a_gpu_a_line_says_what_is_missing(edl6dof, tmp_path, monkeypatch):
    words = ("campaign", write_drop(tmp_path), "--engine", "gpu")
    monkeypatch.setattr(device, "find_spec", lambda name: None)
    status, out, err = edl6dof(*words)
    assert (status, out) == (2, "") and "pip install 'edl6dof[gpu]'" in err and "Traceback" not in err
    monkeypatch.setattr(device, "find_spec", lambda name: name)
    monkeypatch.setattr("numba.cuda.is_available", lambda: False)
    status, out, err = edl6dof(*words)
    assert (status, out) == (2, "") and "no GPU that CUDA can use" in err and "Traceback" not in err
    assert not Path("runs").exists()
    assert "leave it out" in edl6dof(*words, "--workers", "2")[2]


def test_rows_of_two_devices_never_stand_in_one_table(edl6dof, tmp_path):
    """A campaign begun on a GPU goes on there or not at all."""
    store = Store(tmp_path / "begun")
    run.begin(load_plan(write_drop(tmp_path)), store, None, device="GP100")
    run.require_device(store, "GP100")
    with pytest.raises(StoreError, match=r"not on a GPU \(another\)"):
        run.require_device(store, "another")
    status, _, err = edl6dof("campaign", str(store.folder), "--resume")
    assert status == 2 and "was begun on a GPU (GP100), not on the processor" in err


def test_two_engines_are_told_from_two_models():
    """The samples of flights that went their own way after a while are alike; a tenth more of a figure is
    not.
    """
    compared = runpy.run_path(str(ROOT / "tools/two_engines.py"))["compared"]
    case, figure = np.arange(200), np.random.default_rng(1).normal(10.0, 1.0, (2, 200))
    threads = pa.table({"case": case, "lift_start_s": figure[0], "end_s": figure[0]})
    gpu = pa.table({"case": case, "lift_start_s": figure[0], "end_s": figure[1]})
    before, after = compared(threads, gpu)
    assert before[:4] == ("lift_start_s", 200, 200, 0.0)
    assert after[2] == 0 and after[3] > 1.0 and after[4] > 0.01
    shifted = pa.table({"case": case, "end_s": 1.1 * figure[1]})
    assert compared(threads, shifted)[0][4] < 1e-6
