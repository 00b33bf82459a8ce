"""A Dask cluster gives the same table, even when a worker is killed; nothing listens beyond this machine."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import time
from contextlib import contextmanager

import pytest
from campaign_run import ROOT, finished, program, write_drop

pytest.importorskip("distributed")


@contextmanager
def process(*words, cwd):
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    options = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, "text": True}
    started = subprocess.Popen([sys.executable, "-m", "distributed.cli." + words[0], *words[1:]], cwd=cwd, env=environment, **options)
    try:
        yield started
    finally:
        started.kill()
        started.communicate(timeout=30)


@contextmanager
def scheduler(cwd):
    """A scheduler started by hand, as the README says, on a free port."""
    with process("dask_scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard", "--no-show", cwd=cwd) as started:
        for line in started.stdout:
            if found := re.search(r"tcp://127\.0\.0\.1:\d+", line):
                yield found[0]
                return


def worker(address, cwd):
    return process("dask_worker", address, "--nthreads", "1", "--no-nanny", "--no-dashboard", "--host", "127.0.0.1", cwd=cwd)


def test_scheduler_and_workers_started_by_hand(tmp_path, undisturbed):
    """One worker is killed on the way; its cases go to the other."""
    file = write_drop(tmp_path)
    with scheduler(tmp_path) as address, worker(address, tmp_path) as first, worker(address, tmp_path):
        campaign = program("campaign", file, "--engine", "dask", "--cluster", address, "-q", cwd=tmp_path)
        end = time.monotonic() + 120.0
        while not list((tmp_path / "runs/drops/parts").glob("0*.parquet")) and campaign.poll() is None:
            assert time.monotonic() < end
            time.sleep(0.01)
        first.send_signal(signal.SIGKILL)
        _, err = campaign.communicate(timeout=200)
        assert campaign.returncode == 0, err
    assert (tmp_path / "runs/drops/cases.parquet").read_bytes() == undisturbed


def test_cluster_of_its_own(tmp_path, undisturbed):
    status, _, err = finished("campaign", write_drop(tmp_path), "--engine", "dask", "--workers", "2", "-q", cwd=tmp_path)
    assert status == 0, err
    assert (tmp_path / "runs/drops/cases.parquet").read_bytes() == undisturbed


def test_no_scheduler_there(tmp_path):
    words = ("--engine", "dask", "--cluster", "tcp://127.0.0.1:9", "-q")
    status, out, err = finished("campaign", write_drop(tmp_path), *words, cwd=tmp_path)
    assert status == 2 and "Traceback" not in err and "127.0.0.1:9" in err


def test_worker_with_other_sources_is_refused():
    from edl6dof.campaign.engines import fly_range

    with pytest.raises(OSError, match="other sources"):
        fly_range("", "another hash", 0, 1)
