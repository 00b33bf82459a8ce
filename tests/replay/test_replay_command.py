"""``edl6dof replay`` on run folders: what it refuses, what it writes, and that it stays on this machine."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import edl6dof
from edl6dof.api import replays
from edl6dof.api.arguments import naming_options
from edl6dof.api.flight import RecordedFlight
from edl6dof.cli.group import UNAVAILABLE
from edl6dof.cli.run_outputs import replay
from edl6dof.config.errors import ConfigError
from edl6dof.manifest import seal
from edl6dof.replay import viewer
from edl6dof.replay.recording import history, write_replay
from edl6dof.replay.viewer import NoViewer
from edl6dof.report.campaign.campaign_results import Results
from edl6dof.runs.files import distinct_names
from edl6dof.runs.run import write_run


@pytest.fixture(scope="module")
def run(tmp_path_factory) -> Path:
    """The folder of a flight of 20 s, without its replay."""
    folder = tmp_path_factory.mktemp("runs") / "short"
    folder.mkdir()
    write_run(edl6dof.fly("tianwen1", ["simulation.time_limit_s=20"]), folder)
    seal(folder, "flight")
    return folder


def run_replay(*runs: Path, **more: object) -> int:
    """Status of the command."""
    with naming_options():
        return replay(list(runs), **more)


@pytest.fixture
def shown(monkeypatch) -> list[tuple[Path, bytes]]:
    """What would have been opened on the desktop: path and beginning of the file."""
    seen: list[tuple[Path, bytes]] = []
    monkeypatch.setattr(
        viewer, "show", lambda recording: seen.append((recording, recording.read_bytes()[:4]))
    )
    return seen


def test_a_run_without_a_recording_is_drawn_anew_and_leaves_nothing(run, shown):
    assert run_replay(run) == 0
    (path, beginning), before = shown[0], sorted(run.iterdir())
    assert beginning == b"RRF2"
    assert not path.exists()
    assert sorted(run.iterdir()) == before


def test_what_is_drawn_from_the_folder_is_what_was_drawn_from_the_flight(run, tmp_path):
    import subprocess
    import sys

    flight = edl6dof.fly("tianwen1", ["simulation.time_limit_s=20"])
    write_replay([history(flight)], tmp_path / "a.rrd")
    write_replay([history(RecordedFlight(run))], tmp_path / "b.rrd")
    words = [
        sys.executable,
        "-m",
        "rerun",
        "rrd",
        "compare",
        "--unordered",
        str(tmp_path / "a.rrd"),
        str(tmp_path / "b.rrd"),
    ]
    done = subprocess.run(words, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def test_several_runs_get_labels_that_tell_them_apart(run):
    assert distinct_names([run, run.parent / "other"]) == ["short", "other"]
    assert distinct_names([Path("/x/a/run"), Path("/x/b/run")]) == ["a/run", "b/run"]


def test_refusals_name_the_file(run, tmp_path):
    with pytest.raises(ConfigError, match="is no result of edl6dof"):
        run_replay(tmp_path)
    (tmp_path / "there.png").write_bytes(b"mine")
    with pytest.raises(ConfigError, match="exists"):
        run_replay(run, screenshot=tmp_path / "there.png")
    assert (tmp_path / "there.png").read_bytes() == b"mine"


@pytest.mark.parametrize("at_s", [9999.0, pytest.param(-1.0, marks=pytest.mark.long), float("nan")])
def test_a_time_that_is_not_in_the_recording_is_refused_with_what_is(run, tmp_path, at_s):
    with pytest.raises(ConfigError, match=r"--at: .* give a time from 0.00 to 20.00 s"):
        run_replay(run, screenshot=tmp_path / "x.png", at=at_s)
    assert list(tmp_path.iterdir()) == []


def test_a_time_without_a_picture_is_refused(run, shown):
    with pytest.raises(ConfigError, match="--screenshot FILE"):
        run_replay(run, at=5.0)
    assert shown == []


@pytest.fixture(scope="module")
def campaign(tmp_path_factory) -> Path:
    """The folder of a campaign of three flights of 12 s."""
    folder = tmp_path_factory.mktemp("campaign")
    (folder / "three.yaml").write_text(
        "extends: tianwen1\nname: three\nsimulation: {time_limit_s: 12}\n"
        "campaign: {cases: 3, seed: 4, truth: {initial.speed_m_s: {kind: normal, three_sigma: 6.0}}}\n",
        encoding="utf-8",
    )
    edl6dof.campaign(folder / "three.yaml", out=folder / "runs")
    return folder / "runs"


@pytest.fixture
def written(monkeypatch) -> list[tuple]:
    """What would have been written as a recording: the arguments of each call."""
    given: list[tuple] = []
    monkeypatch.setattr(replays, "write_replay", lambda *words: given.append(words))
    return given


def test_a_campaign_says_which_flight_is_followed_and_why(run, campaign, written):
    for runs in ((campaign,), (campaign, run)):
        with replays._recording(runs, ""):
            pass
    (_, _, alone, front, told, _), (_, _, named, beside, other, _) = written
    assert (alone, front) == (["nominal"], "Campaign")
    assert told.followed.startswith("nominal, in which nothing is dispersed")
    assert (named, beside) == (["short"], "Flight")
    assert other.followed == "short, the first run named after the campaign."


def test_a_case_of_a_campaign_is_flown_again_with_the_same_bits(campaign, written):
    with replays._recording((campaign,), "", case=2):
        pass
    ((flights, _, labels, front, told, _),) = written
    assert (labels, front) == (["case 2"], "Flight")
    assert told.followed == "case 2, flown again, identical to its row."
    assert [one.case for one in told.trajectories] == [0, 1, 2]
    own = edl6dof.refly(campaign, 2).telemetry["truth.site_up_m"]
    assert flights[0]["truth.site_up_m"][-1] == own[-1]
    assert told.trajectories[2].places[-1, 2] == np.float32(own[-1])


def test_a_case_that_is_not_there_is_refused_with_those_that_are(run, campaign, written):
    with pytest.raises(ConfigError, match=r"must be 0 \.\. 2 \(got 3\)"):
        run_replay(campaign, case=3)
    with pytest.raises(ConfigError, match="--case: needs the folder of a campaign, named first"):
        run_replay(run, case=3)
    assert written == []


def test_the_worst_cases_are_those_nearest_to_a_limit(campaign):
    found = replays.worst_cases(Results(campaign))
    rows, limits = edl6dof.open_run(campaign).table.to_pylist(), edl6dof.load("tianwen1").scenario.limits
    loads = {row["case"]: row["peak_load_g0"] for row in rows}
    share = max(loads.values()) / limits.entry_load_g0
    (load,) = [one for one in found if one.figure == "peak load of the entry"]
    assert (load.case, load.used) == (max(loads, key=loads.get), pytest.approx(share, rel=1e-12))
    shares = [one.used for one in found]
    assert shares == sorted(shares, reverse=True) and len(found) <= replays.MOST_WORST


def test_a_missing_viewer_is_said_in_one_line(run, tmp_path, monkeypatch, capsys):
    def cannot(*_: object) -> None:
        raise NoViewer("no viewer here")

    monkeypatch.setattr(viewer, "screenshot", cannot)
    assert run_replay(run, screenshot=tmp_path / "x.png") == UNAVAILABLE
    assert capsys.readouterr().err == "no viewer here\n"
    assert list(tmp_path.iterdir()) == []


def test_trajectories_of_a_campaign_are_its_cases_flown_again(tmp_path):
    from edl6dof.api.replays import trajectories
    from edl6dof.campaign.design.plan import plan_of
    from edl6dof.config.document.source import read_document

    text = "extends: tianwen1\nname: three\nsimulation: {time_limit_s: 12}\ncampaign: {cases: 3, seed: 4}\n"
    (tmp_path / "three.yaml").write_text(text, encoding="utf-8")
    plan = plan_of(read_document(tmp_path / "three.yaml"), ())
    found = trajectories(plan, {0, 1, 2})
    assert len(found) == 3
    flight = edl6dof.fly("tianwen1", ["simulation.time_limit_s=12"])
    for one in found:
        assert one.cause != "", "nobody lands in 12 s"
        assert abs(float(one.places[0, 2]) - float(flight.telemetry["truth.site_up_m"][0])) < 5e3
        assert len(one.places) == 7, "a row every two seconds"
