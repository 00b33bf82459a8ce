"""Damaged and made-up run folders: every viewer says what is wrong in one line, or shows exactly what was
written.
"""

from __future__ import annotations

import json
import random
import shutil
from pathlib import Path

import pytest
from command import SHORT, VIEWERS, refused, viewing
from in_process import called

from edl6dof.manifest import MANIFEST, seal

FILES = (MANIFEST, "summary.json", "events.json", "scenario.yaml", "telemetry.parquet")


@pytest.fixture(scope="module")
def flown(tmp_path_factory) -> Path:
    run = tmp_path_factory.mktemp("flown") / "run"
    assert called("fly", *SHORT, "--out", run, "-q", "--no-replay").returncode == 1
    return run


@pytest.fixture
def run(flown, tmp_path) -> Path:
    return Path(shutil.copytree(flown, tmp_path / "run"))


def outcome(viewer: str, run: Path, out: Path):
    """How a viewer ends; nothing half-written stays behind when it refuses."""
    before = set(run.parent.iterdir())
    done = called(*viewing(viewer, run, out))
    if done.returncode != 0:
        assert refused(done), done.stderr
        assert set(run.parent.iterdir()) == before
    return done


@pytest.mark.parametrize("name", FILES)
def test_a_flipped_bit_anywhere_is_noticed_or_changes_nothing(name, run, flown):
    """Six places in each file, seeded; the telemetry is compared value by value where it is still
    shown.
    """
    draw = random.Random(name)
    original = (run / name).read_bytes()
    true = called("export", flown, "-", "--format", "csv").stdout
    noticed = 0
    for _ in range(6):
        content = bytearray(original)
        content[draw.randrange(len(content))] ^= 1 << draw.randrange(8)
        (run / name).write_bytes(content)
        shown = outcome("csv", run, run.parent / "x")
        table = called("export", run, "-", "--format", "csv")
        report = outcome("report", run, run.parent / "r")
        noticed += report.returncode == 2
        if shown.returncode == 0:
            assert table.stdout == true
            (run.parent / "x.csv").unlink()
        if report.returncode == 0:
            assert name == MANIFEST, "a whole file is needed for what is shown"
            (run.parent / "r.html").unlink()
    assert noticed >= (6 if name != MANIFEST else 3)


WRECKS = {
    "empty": lambda path: path.write_bytes(b""),
    "cut": lambda path: path.write_bytes(path.read_bytes()[: path.stat().st_size // 2]),
    "noise": lambda path: path.write_bytes(random.Random(1).randbytes(3000)),
    "text": lambda path: path.write_bytes(b'[1, 2, {"a": null}]'),
    "gone": lambda path: path.unlink(),
    "folder": lambda path: (path.unlink(), path.mkdir()),
    "loop": lambda path: (path.unlink(), path.symlink_to(path)),
}


@pytest.mark.parametrize(
    ("wreck", "viewer"),
    [
        pytest.param(wreck, viewer, marks=[] if (number + place) % 3 == 0 else pytest.mark.long)
        for number, wreck in enumerate(WRECKS)
        for place, viewer in enumerate(VIEWERS)
    ],
)
def test_wrecked_file_is_refused_in_one_line(viewer, wreck, flown, tmp_path):
    for name in FILES:
        run = Path(shutil.copytree(flown, tmp_path / name))
        WRECKS[wreck](run / name)
        done = outcome(viewer, run, tmp_path / f"out-{name}")
        # a list of the channels, and tables of telemetry alone, do not ask for the timeline or the summary
        if done.returncode == 0:
            assert name in ("summary.json", "events.json", "scenario.yaml") and wreck not in (
                "gone",
                "folder",
                "loop",
            )
        else:
            assert str(run) in done.stderr


def made_up(run: Path, name: str, change) -> None:
    """Change a JSON file and seal the folder again: hashes and marker are right."""
    content = json.loads((run / name).read_text())
    (run / name).write_text(json.dumps(change(content)))
    seal(run, "flight")


def put(*path, value):
    def change(content):
        inside = content
        for key in path[:-1]:
            inside = inside[key]
        inside[path[-1]] = value
        return content

    return change


def drop(*path):
    def change(content):
        inside = content
        for key in path[:-1]:
            inside = inside[key]
        del inside[path[-1]]
        return content

    return change


LIES = {
    "summary is a list": ("summary.json", lambda _: []),
    "no name": ("summary.json", drop("name")),
    "name is a number": ("summary.json", put("name", value=3)),
    "figures are text": ("summary.json", put("figures", value={"touchdown_s": "soon"})),
    "limits are no list": ("summary.json", put("limits", value={"a": 1})),
    "time is huge": ("summary.json", put("time_s", value="1e999")),
    "events are a mapping": ("events.json", lambda _: {"a": 1}),
    "no events": ("events.json", lambda _: []),
    "event without time": ("events.json", drop(0, "t_s")),
    "event of text": ("events.json", put(0, value="boo")),
}


@pytest.mark.parametrize("viewer", VIEWERS)
def test_made_up_contents_are_refused_in_one_line(viewer, flown, tmp_path):
    for number, (name, change) in enumerate(LIES.values()):
        run = Path(shutil.copytree(flown, tmp_path / f"{number}"))
        made_up(run, name, change)
        outcome(viewer, run, tmp_path / f"out{number}")


SCENARIOS = {
    "no mission": lambda text: text.replace("\nmission:", "\nmissing:"),
    "a list": lambda text: "- a\n- b\n",
    "one word": lambda text: "boo\n",
    "deep": lambda text: "a: " + "[" * 3000 + "]" * 3000 + "\n",
    "vehicle is a number": lambda text: text.replace("\nvehicle:", "\nvehicle: 3\nother:"),
    "binary": lambda text: "\x00\x01",
    "a python object": lambda text: text + "\nx: !!python/object/apply:os.system ['touch ran']\n",
}


@pytest.mark.parametrize("viewer", VIEWERS)
def test_made_up_scenarios_are_refused_in_one_line(viewer, flown, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for number, change in enumerate(SCENARIOS.values()):
        run = Path(shutil.copytree(flown, tmp_path / f"{number}"))
        (run / "scenario.yaml").write_text(change((run / "scenario.yaml").read_text()))
        seal(run, "flight")
        outcome(viewer, run, tmp_path / f"out{number}")
    assert not (tmp_path / "ran").exists()


@pytest.mark.parametrize("viewer", VIEWERS)
def test_made_up_telemetry_is_refused_in_one_line(viewer, flown, tmp_path):
    import pyarrow as pa
    import pyarrow.parquet as pq

    table = pq.read_table(flown / "telemetry.parquet")
    lies = (
        table.slice(0, 0),
        table.slice(0, 1),
        table.drop_columns(["t_s"]),
        table.drop_columns([name for name in table.column_names if name.startswith("truth.")]),
        table.set_column(0, "t_s", pa.array(["x"] * len(table))),
        table.set_column(0, "t_s", pa.array([float("nan")] * len(table))),
        table.set_column(0, "t_s", pa.array([1e308] * len(table))),
    )
    for number, lie in enumerate(lies):
        run = Path(shutil.copytree(flown, tmp_path / f"{number}"))
        pq.write_table(lie, run / "telemetry.parquet")
        seal(run, "flight")
        outcome(viewer, run, tmp_path / f"out{number}")
