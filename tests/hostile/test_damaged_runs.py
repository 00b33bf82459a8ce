"""Damaged and made-up run folders: every viewer says what is wrong in one line, or shows exactly what was
written.
"""

from __future__ import annotations

import json
import random
import shutil
from itertools import product
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from command import SHORT, VIEWERS, refused, viewing
from in_process import called

from edl6dof.manifest import MANIFEST, seal

FILES = (MANIFEST, "summary.json", "events.json", "scenario.yaml", "telemetry.parquet")
#: Files whose hash is asked for as that of the others is, and viewers that read as ``report`` and ``csv`` do.
ALIKE = ("summary.json", "events.json", "scenario.yaml", "compare", "mat", "nesc")


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


@pytest.mark.parametrize(
    ("name", "places"),
    [pytest.param(name, 2, marks=pytest.mark.long if name in ALIKE else ()) for name in FILES]
    + [pytest.param(name, 6, marks=pytest.mark.long) for name in FILES],
)
def test_a_flipped_bit_anywhere_is_noticed_or_changes_nothing(name, places, run, flown):
    """Some places in each file, seeded; the telemetry is compared value by value where it is still
    shown.
    """
    draw = random.Random(name)
    original = (run / name).read_bytes()
    true = called("export", flown, "-", "--format", "csv").stdout
    noticed = 0
    for _ in range(places):
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
    assert noticed >= (places if name != MANIFEST else places // 2)


def shared_out(cases) -> list:
    """Each viewer with every fourth of the cases, the next with others; the rest of them is long."""
    shares = []
    for place, viewer in enumerate(VIEWERS):
        own = [case for number, case in enumerate(cases) if (number + place) % 4 == 0]
        rest = [case for case in cases if case not in own]
        shares += [
            pytest.param(viewer, own, id=viewer, marks=pytest.mark.long if viewer in ALIKE else ()),
            pytest.param(viewer, rest, id=f"{viewer}-rest", marks=pytest.mark.long),
        ]
    return shares


WRECKS = {
    "empty": lambda path: path.write_bytes(b""),
    "cut": lambda path: path.write_bytes(path.read_bytes()[: path.stat().st_size // 2]),
    "noise": lambda path: path.write_bytes(random.Random(1).randbytes(3000)),
    "text": lambda path: path.write_bytes(b'[1, 2, {"a": null}]'),
    "gone": lambda path: path.unlink(),
    "folder": lambda path: (path.unlink(), path.mkdir()),
    "loop": lambda path: (path.unlink(), path.symlink_to(path)),
}


@pytest.mark.parametrize(("viewer", "wrecks"), shared_out(WRECKS))
def test_wrecked_file_is_refused_in_one_line(viewer, wrecks, flown, tmp_path):
    for wreck, name in product(wrecks, FILES):
        run = Path(shutil.copytree(flown, tmp_path / f"{wreck}-{name}"))
        WRECKS[wreck](run / name)
        done = outcome(viewer, run, tmp_path / f"out-{wreck}-{name}")
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


@pytest.mark.parametrize(("viewer", "lies"), shared_out(LIES))
def test_made_up_contents_are_refused_in_one_line(viewer, lies, flown, tmp_path):
    for number, lie in enumerate(lies):
        run = Path(shutil.copytree(flown, tmp_path / f"{number}"))
        made_up(run, *LIES[lie])
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


@pytest.mark.parametrize(("viewer", "scenarios"), shared_out(SCENARIOS))
def test_made_up_scenarios_are_refused_in_one_line(viewer, scenarios, flown, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for number, name in enumerate(scenarios):
        run = Path(shutil.copytree(flown, tmp_path / f"{number}"))
        (run / "scenario.yaml").write_text(SCENARIOS[name]((run / "scenario.yaml").read_text()))
        seal(run, "flight")
        outcome(viewer, run, tmp_path / f"out{number}")
    assert not (tmp_path / "ran").exists()


def with_times(table, t_s: object):
    """The table with one and the same time in every row."""
    return table.set_column(0, "t_s", pa.array([t_s] * len(table)))


TABLES = {
    "no row": lambda table: table.slice(0, 0),
    "one row": lambda table: table.slice(0, 1),
    "no time": lambda table: table.drop_columns(["t_s"]),
    "no truth": lambda table: table.drop_columns(
        [name for name in table.column_names if name.startswith("truth.")]
    ),
    "time is text": lambda table: with_times(table, "x"),
    "time is no number": lambda table: with_times(table, float("nan")),
    "time is huge": lambda table: with_times(table, 1e308),
}


@pytest.mark.parametrize(("viewer", "tables"), shared_out(TABLES))
def test_made_up_telemetry_is_refused_in_one_line(viewer, tables, flown, tmp_path):
    whole = pq.read_table(flown / "telemetry.parquet")
    for number, name in enumerate(tables):
        run = Path(shutil.copytree(flown, tmp_path / f"{number}"))
        pq.write_table(TABLES[name](whole), run / "telemetry.parquet")
        seal(run, "flight")
        outcome(viewer, run, tmp_path / f"out{number}")
