"""A Dask cluster gives the same table, even when a worker is killed; nothing listens beyond this machine."""

from __future__ import annotations

import re
import signal
import time
from types import SimpleNamespace

import campaign_run
import pytest
from campaign_run import write_drop

pytest.importorskip("distributed")

from cluster import impatient_program, scheduler, worker, worker_with_another_numpy
from forked import Forked, finished

from edl6dof.campaign.design.plan import load_plan
from edl6dof.campaign.engines import Dask, dask_engine


def begun(folder, campaign, parts=1):
    """Wait until some parts are in place."""
    end = time.monotonic() + 120.0
    while len(list((folder / "runs/drops/parts").glob("0*.parquet"))) < parts and campaign.returncode is None:
        assert time.monotonic() < end
        time.sleep(0.01)


def test_scheduler_and_workers_started_by_hand(tmp_path, undisturbed):
    """One worker is killed on the way; its cases go to the other."""
    file = write_drop(tmp_path)
    with scheduler(tmp_path) as (address, _), worker(address, tmp_path) as first, worker(address, tmp_path):
        campaign = Forked("campaign", file, "--engine", "dask", "--cluster", address, "-q", cwd=tmp_path)
        begun(tmp_path, campaign)
        first.send_signal(signal.SIGKILL)
        _, err = campaign.communicate(timeout=200)
        assert campaign.returncode == 0, err
    assert (tmp_path / "runs/drops/cases.parquet").read_bytes() == undisturbed


@pytest.mark.exact_start  # which the processes that dask starts fly from
def test_cluster_of_its_own(tmp_path, undisturbed):
    """With one worker: several are the same to a campaign, whoever started them."""
    status, _, err = campaign_run.finished(
        "campaign", write_drop(tmp_path), "--engine", "dask", "--workers", "1", "-q", cwd=tmp_path
    )
    assert status == 0, err
    assert (tmp_path / "runs/drops/cases.parquet").read_bytes() == undisturbed


def test_no_scheduler_there(tmp_path):
    words = ("--engine", "dask", "--cluster", "tcp://127.0.0.1:9", "-q")
    campaign = Forked("campaign", write_drop(tmp_path), *words, cwd=tmp_path, main=impatient_program)
    _, err = campaign.communicate(timeout=60)
    assert campaign.returncode == 2 and "Traceback" not in err and "127.0.0.1:9" in err


def test_all_workers_are_killed_and_another_joins(tmp_path, undisturbed):
    file = write_drop(tmp_path)
    with scheduler(tmp_path) as (address, _):
        with worker(address, tmp_path) as first, worker(address, tmp_path) as second:
            campaign = Forked("campaign", file, "--engine", "dask", "--cluster", address, "-q", cwd=tmp_path)
            begun(tmp_path, campaign)
            first.send_signal(signal.SIGKILL)
            second.send_signal(signal.SIGKILL)
        with worker(address, tmp_path):
            _, err = campaign.communicate(timeout=200)
    assert campaign.returncode == 0, err
    assert (tmp_path / "runs/drops/cases.parquet").read_bytes() == undisturbed


def test_no_worker_is_left(tmp_path, undisturbed):
    """A message within the time that the program waits for one, and another engine goes on."""
    file = write_drop(tmp_path)
    with scheduler(tmp_path) as (address, _), worker(address, tmp_path) as only:
        words = ("campaign", file, "--engine", "dask", "--cluster", address, "-q")
        campaign = Forked(*words, cwd=tmp_path, main=impatient_program)
        begun(tmp_path, campaign)
        only.send_signal(signal.SIGKILL)
        _, err = campaign.communicate(timeout=60)
    assert campaign.returncode == 2 and "no worker of the cluster has been there for 3 s" in err, err
    assert "go on with: edl6dof campaign runs/drops --resume" in err and "Traceback" not in err
    assert finished("campaign", "runs/drops", "--resume", "-q", cwd=tmp_path)[0] == 0
    assert (tmp_path / "runs/drops/cases.parquet").read_bytes() == undisturbed


def test_scheduler_is_killed(tmp_path, undisturbed):
    file = write_drop(tmp_path)
    with scheduler(tmp_path) as (address, killed), worker(address, tmp_path):
        campaign = Forked("campaign", file, "--engine", "dask", "--cluster", address, "-q", cwd=tmp_path)
        begun(tmp_path, campaign)
        killed.send_signal(signal.SIGKILL)
        _, err = campaign.communicate(timeout=120)
    assert (
        campaign.returncode == 2
        and "go on with: edl6dof campaign runs/drops --resume" in err
        and "Traceback" not in err
    ), err
    assert finished("campaign", "runs/drops", "--resume", "-q", cwd=tmp_path)[0] == 0
    assert (tmp_path / "runs/drops/cases.parquet").read_bytes() == undisturbed


class InterruptedOnce:
    """A task of distributed whose wait is cancelled once, as a worker dies in that moment."""

    status = "pending"

    def __init__(self, rows):
        self.answers = [UnboundLocalError("result"), TimeoutError(), rows]

    def result(self, timeout):
        if isinstance(answer := self.answers.pop(0), Exception):
            raise answer
        return answer


def test_a_wait_that_is_cancelled_begins_again():
    """``distributed.utils.sync`` fails with an ``UnboundLocalError`` then, which ended the program."""
    client = SimpleNamespace(nthreads=lambda: {"tcp://127.0.0.1:1": 1})
    assert Dask(client)._result(InterruptedOnce([{"case": 0}])) == [{"case": 0}]


def test_worker_that_is_no_copy_is_refused(tmp_path):
    """The message names the worker, and each item in which it differs."""
    file = write_drop(tmp_path)
    with scheduler(tmp_path) as (address, _), worker(address, tmp_path, worker_with_another_numpy):
        words = ("campaign", file, "--engine", "dask", "--cluster", address, "-q")
        status, _, err = finished(*words, cwd=tmp_path)
    assert status == 2 and "Traceback" not in err, err
    assert re.search(
        r"worker tcp://127.0.0.1:\d+ is no copy of this program: numpy: was \S+, is 0.7; ", err
    ), err


class Immediate:
    """A client that flies each task at once; keeps the arguments of the tasks."""

    def __init__(self):
        self.sent = []

    def submit(self, work, *given, pure):
        self.sent.append((work.__name__, given))
        values = [one.value if isinstance(one, SimpleNamespace) else one for one in given]
        value = work(*values)
        return SimpleNamespace(value=value, result=lambda timeout: value)

    def nthreads(self):
        return {"tcp://127.0.0.1:1": 1}


def test_plan_is_sent_once_and_not_with_every_task(tmp_path):
    """Copies of its text in every task stayed in the memory of scheduler and workers: 14 kB a flight."""
    plan, client = load_plan(write_drop(tmp_path), cases=30), Immediate()
    rows = list(Dask(client).rows(plan, [(0, 30)]))
    assert [row["case"] for row in rows] == list(range(30))
    with_text = [name for name, given in client.sent if plan.text in given]
    assert with_text == ["_ordered"] and [name for name, _ in client.sent].count("fly_range") == 3


def profiles() -> bool:
    import dask

    return dask.config.get("distributed.worker.profile.enabled")


@pytest.mark.exact_start
def test_workers_keep_no_profile():
    """They grew by 20 kB with every flight."""
    with dask_engine(None, 1) as engine:
        assert list(engine.client.run(profiles).values()) == [False]
