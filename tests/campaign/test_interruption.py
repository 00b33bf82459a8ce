"""Ctrl-C tells how to go on wherever something is kept, and that nothing was written where nothing was."""

from __future__ import annotations

import builtins
import contextlib
import io
import sys
from pathlib import Path

import in_process
import pytest
from campaign_run import write_drop

from edl6dof.api import campaign as campaign_api
from edl6dof.campaign import executor, run, store
from edl6dof.campaign.design.plan import load_plan
from edl6dof.campaign.store import Store
from edl6dof.cli import campaign_flight

GO_ON = "interrupted; what has flown is kept; go on with: edl6dof campaign runs/drops --resume\n"
NOTHING = "interrupted; nothing was written\n"


def interrupt(*_, **__):
    raise KeyboardInterrupt


def command(*words: str) -> tuple[int, str]:
    """Status and standard error."""
    sys.argv = ["edl6dof", *words]
    err = io.StringIO()
    with (
        contextlib.redirect_stderr(err),
        contextlib.redirect_stdout(io.StringIO()),
        pytest.raises(SystemExit) as end,
    ):
        in_process.main()
    return int(end.value.code or 0), err.getvalue()


@pytest.fixture
def file(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return write_drop(tmp_path)


@pytest.mark.parametrize(
    "owner, name",
    [
        pytest.param(run, "differences", marks=pytest.mark.long),
        (run, "parse_plan"),
        pytest.param(store.Store, "tidy", marks=pytest.mark.long),
        pytest.param(campaign_flight, "count_runs", marks=pytest.mark.long),
        (executor.CaseRunner, "prepared"),
        pytest.param(store.Store, "finish", marks=pytest.mark.long),
    ],
    ids=lambda value: getattr(value, "__name__", value),
)
def test_resume_is_interrupted_anywhere(file, monkeypatch, owner, name):
    run.begin(load_plan(file, cases=60), Store(Path("runs/drops")), None)
    with monkeypatch.context() as patch:
        patch.setattr(owner, name, interrupt)
        assert command("campaign", "runs/drops", "--resume", "-q") == (130, GO_ON)
    assert command("campaign", "runs/drops", "--resume", "-q") == (0, "")


def test_resume_is_interrupted_while_the_program_loads(file, monkeypatch):
    """Also of a campaign that is named by its file and its folder."""
    load = builtins.__import__

    def loading(name, *more, **named):
        return interrupt() if name == "edl6dof.cli.campaign_flight" else load(name, *more, **named)

    monkeypatch.setattr(builtins, "__import__", loading)
    assert command("campaign", "runs/drops", "--resume") == (130, GO_ON)
    status, err = command("campaign", "drops.yaml", "--out", "my runs", "--resume")
    assert status == 130 and err.endswith(
        "go on with: edl6dof campaign drops.yaml --out 'my runs' --resume\n"
    )


@pytest.mark.parametrize(
    "owner, name", [(campaign_api, "load_plan"), (store.Store, "check_new"), (store, "write_sealed")]
)
def test_new_campaign_is_interrupted_before_it_begins(file, monkeypatch, owner, name):
    monkeypatch.setattr(owner, name, interrupt)
    assert command("campaign", file) == (130, NOTHING)
    assert not Path("runs").exists()


def test_new_campaign_is_interrupted_when_it_has_begun(file, monkeypatch):
    monkeypatch.setattr(run, "fly", interrupt)
    assert command("campaign", file) == (130, GO_ON)
    assert Store(Path("runs/drops")).plan_text == load_plan(file).text


def test_replacing_a_campaign_is_interrupted(file, monkeypatch):
    """Before its plan goes, it is as it was; from then on nothing of it counts."""
    assert command("campaign", file, "-n", "10", "-q")[0] == 0
    with monkeypatch.context() as patch:
        patch.setattr(store.Store, "_own", interrupt)
        assert command("campaign", file, "--force") == (130, NOTHING)
    assert Store(Path("runs/drops")).table().num_rows == 10
    with monkeypatch.context() as patch:
        patch.setattr(store, "write_sealed", interrupt)
        words = "interrupted; runs/drops was being begun or replaced; begin it anew with --force\n"
        assert command("campaign", file, "--force") == (130, words)
    assert command("campaign", "runs/drops", "--resume")[0] == 2
    assert command("campaign", file, "-n", "10", "-q", "--force")[0] == 0
