"""Damaged files of every kind: each reader refuses them in words, or shows exactly what was written; tables
and terrain, which nobody has sealed, are refused or flown to a named end.
"""

from __future__ import annotations

import atexit
import json
import random
import shutil
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from tempfile import mkdtemp

import numpy as np
from attack_lines import DAVEML, ROOT, TABLES
from attempt import Ended, ended
from command import SHORT, finished

from edl6dof.manifest import MANIFEST

RUN = (MANIFEST, "summary.json", "events.json", "scenario.yaml", "telemetry.parquet", "state.npz")
CAMPAIGN = ("campaign.json", "campaign.yaml", "cases.parquet", "summary.json")

Damage = Callable[[random.Random, bytes], bytes]


def _bit(draw: random.Random, content: bytes) -> bytes:
    place = draw.randrange(len(content))
    return content[:place] + bytes([content[place] ^ 1 << draw.randrange(8)]) + content[place + 1 :]


def _span(draw: random.Random, content: bytes) -> tuple[int, int]:
    first = draw.randrange(len(content))
    return first, min(len(content), first + draw.choice((1, 7, 512, 4096)))


def _zeros(draw: random.Random, content: bytes) -> bytes:
    """A block that was never written."""
    first, last = _span(draw, content)
    return content[:first] + bytes(last - first) + content[last:]


def _noise(draw: random.Random, content: bytes) -> bytes:
    first, last = _span(draw, content)
    return content[:first] + draw.randbytes(last - first) + content[last:]


def _lost(draw: random.Random, content: bytes) -> bytes:
    first, last = _span(draw, content)
    return content[:first] + content[last:]


def _doubled(draw: random.Random, content: bytes) -> bytes:
    first, last = _span(draw, content)
    return content[:last] + content[first:]


def _digit(draw: random.Random, content: bytes) -> bytes:
    """A digit that is another one, or a number cut in two."""
    places = [k for k, byte in enumerate(content[:200_000]) if 48 <= byte <= 57] or [0]
    place = draw.choice(places)
    return content[:place] + draw.choice((b"9", b"0", b"-", b".", b"e", b" ", b"\xff")) + content[place + 1 :]


DAMAGES: tuple[Damage, ...] = (
    *(_bit, _bit, _zeros, _noise, _lost, _doubled, _digit),
    lambda draw, content: content[: draw.randrange(len(content))],
    lambda draw, content: content + draw.randbytes(40),
    lambda draw, content: b"",
)


@cache
def whole() -> Path:
    """A run with a saved state, a campaign, and the flights that follow from them."""
    place = Path(mkdtemp(prefix="whole-"))
    atexit.register(shutil.rmtree, place, ignore_errors=True)
    for words in (
        ("fly", *SHORT, "--save-state", "2", "--no-replay", "-q", "--out", "run"),
        ("fly", "--from", "run/state.npz", "--no-replay", "-q", "--out", "later"),
        ("campaign", "tianwen1_mc", "-n", "60", *SHORT[1:], "-q", "--out", "campaign"),
    ):
        assert finished(*words, cwd=place).returncode in (0, 1)
    return place


def attempt(number: int, seed: int, home: Path) -> Iterator[Ended]:
    """One damaged file."""
    draw = random.Random(f"damage/{seed}/{number}")
    kind = (_run, _state, _campaign, _table, _grid, _map)[number % 6]
    yield from kind(draw, home)


def _damage(draw: random.Random, path: Path) -> None:
    content = path.read_bytes()
    while (changed := draw.choice(DAMAGES)(draw, content)) == content:
        pass
    path.write_bytes(changed)


def _same(done: Ended, here: Path, there: Path) -> Ended:
    """What is not refused must be what was written."""
    if done.wrong or done.status == 2 or here.read_bytes() == there.read_bytes():
        return done
    return done._replace(wrong="shows something else without a word")


def _run(draw: random.Random, home: Path) -> Iterator[Ended]:
    shutil.copytree(whole() / "run", home / "run")
    name = draw.choice(RUN[:-1])
    _damage(draw, home / "run" / name)
    _table_of(whole() / "run", home / "true.csv")
    yield _same(_table_of(home / "run", home / "x.csv"), home / "x.csv", home / "true.csv")
    report = ended(["report", "run", "--out", "r.html"], home)
    unseen = "a damaged file was not noticed" if report.status == 0 and name != MANIFEST else ""
    yield report._replace(wrong=report.wrong or unseen)
    yield ended(["compare", "run", str(whole() / "run"), "--out", "c.html"], home)


def _table_of(run: Path, out: Path) -> Ended:
    return ended(["export", str(run), str(out), "--format", "csv"], out.parent)


def _state(draw: random.Random, home: Path) -> Iterator[Ended]:
    """A state is refused, or the flight from it is the one from the whole state."""
    shutil.copy(whole() / "run" / "state.npz", home / "state.npz")
    _damage(draw, home / "state.npz")
    done = ended(["fly", "--from", "state.npz", "--no-replay", "-q", "--out", "later"], home)
    yield _same(done, home / "later" / "telemetry.parquet", whole() / "later" / "telemetry.parquet")


def _campaign(draw: random.Random, home: Path) -> Iterator[Ended]:
    shutil.copytree(whole() / "campaign", home / "campaign")
    _damage(draw, home / "campaign" / draw.choice(CAMPAIGN))
    yield ended(["report", "campaign", "--out", "r.html"], home)
    yield ended(["refly", "campaign", "3", "--no-replay", "--out", "again"], home)
    done = ended(["campaign", "--resume", "campaign", "-q"], home)
    table = "campaign/cases.parquet"
    yield _same(done, home / table, whole() / table)


def _table(draw: random.Random, home: Path) -> Iterator[Ended]:
    key, source = draw.choice([*TABLES.items(), *(("vehicle.daveml", one) for one in DAVEML)])
    name = home / Path(source).name
    shutil.copy(ROOT / source, name)
    _damage(draw, name)
    if key != "vehicle.daveml":
        yield from _flown("tianwen1", f"{key}={name}", home)
        return
    model = name.name.split("_")[0]
    rest = [str(ROOT / one) for one in DAVEML if model in one and not one.endswith(name.name)]
    case = "nesc/case02" if model == "brick" else "nesc/case01"
    yield from _flown(case, f"vehicle.daveml={json.dumps([str(name), *rest])}", home)


def _grid(draw: random.Random, home: Path) -> Iterator[Ended]:
    """A terrain model as an ASCII grid."""
    z = np.round(np.random.default_rng(1).normal(-4000.0, 3.0, (61, 61)), 2)
    head = "ncols 61\nnrows 61\nxllcorner -915\nyllcorner -915\ncellsize 30\nNODATA_value -9999\n"
    (home / "site.asc").write_text(head + "\n".join(" ".join(map(str, row)) for row in z.tolist()) + "\n")
    if draw.random() < 0.5:
        _damage(draw, home / "site.asc")
    else:
        other = draw.choice(("nan", "inf", "-1", "0", "1e-320", "1e308", "61.5", "1e9", "٦١", "0x3d", ""))
        lines = (home / "site.asc").read_text().splitlines()
        line = draw.randrange(7)
        lines[line] = f"{lines[line].split()[0]} {other}"
        (home / "site.asc").write_text("\n".join(lines) + "\n")
    yield from _flown("tianwen1", f"terrain.landing_area.dtm.file={home / 'site.asc'}", home)


def _map(draw: random.Random, home: Path) -> Iterator[Ended]:
    """A map of heights (``.npy``) or what says which planet it is of; damaged mostly in its head."""
    areoid = ROOT / "edl6dof/data/areoid/mars_gmm3_degree12"
    for suffix in (".npy", ".yaml"):
        shutil.copy(areoid.with_suffix(suffix), home / f"map{suffix}")
    file = home / draw.choice(("map.npy", "map.npy", "map.yaml"))
    if file.suffix == ".npy" and draw.random() < 0.6:
        content = file.read_bytes()
        file.write_bytes(draw.choice(DAMAGES)(draw, content[:128]) + content[128:])
    else:
        _damage(draw, file)
    yield from _flown("tianwen1", f"planet.areoid={home / 'map.npy'}", home)


def _flown(scenario: str, change: str, home: Path) -> Iterator[Ended]:
    """A check, and a flight of what it lets pass."""
    checked = ended(["check", scenario, "--set", change], home)
    yield checked
    if checked.status == 0:
        words = ["fly", scenario, "--set", change, "--set", "simulation.time_limit_s=2"]
        flown = ended([*words, "--no-replay", "-q", "--out", "out"], home)
        refused = "check passed what fly refuses" if flown.status == 2 else ""
        yield flown._replace(wrong=flown.wrong or refused)
