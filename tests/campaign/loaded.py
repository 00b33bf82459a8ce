"""Loads the program and its machine code, for the processes that are forked afterwards."""

import tempfile
from contextlib import suppress
from pathlib import Path

from campaign_run import write_drop
from in_process import PROGRAM

from edl6dof import cli
from edl6dof.campaign.design.plan import load_plan
from edl6dof.campaign.executor import CaseRunner
from edl6dof.cli import campaign_flight  # noqa: F401  what a campaign asks for

cli.app = PROGRAM
with suppress(ImportError):
    from distributed.cli import dask_scheduler, dask_worker  # noqa: F401  for those who have it
with tempfile.TemporaryDirectory() as folder:
    plan = load_plan(write_drop(Path(folder)), cases=1)
CaseRunner(plan.loaded).fly(list(plan.cases()))
