"""Campaigns and flights that are killed at a random moment; the next attempt gives what an undisturbed one
gives, byte for byte, and nothing of the killed one stays behind.
"""

from __future__ import annotations

import os
import random
import signal
import subprocess
import time
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

from attempt import Ended
from command import PROGRAM, ROOT

#: How each story begins, how it goes on after a kill, and the files that must be those of an undisturbed one.
STORIES: dict[str, tuple[list[str], list[str], tuple[str, ...]]] = {
    "campaign": (
        ["campaign", "tianwen1_mc", "-n", "400", "--set", "simulation.time_limit_s=3", "-q", "--out", "out"],
        ["campaign", "--resume", "out", "-q"],
        ("cases.parquet",),
    ),
    "flight": (
        ["fly", "tianwen1", "--no-replay", "--save-state", "100", "-q", "--out", "out"],
        ["fly", "tianwen1", "--no-replay", "--save-state", "100", "-q", "--out", "out"],
        ("telemetry.parquet", "events.json", "scenario.yaml"),
    ),
    "replacement": (
        ["fly", "msl", "--no-replay", "-q", "--out", "out", "--force"],
        ["fly", "msl", "--no-replay", "-q", "--out", "out", "--force"],
        ("telemetry.parquet", "events.json", "scenario.yaml"),
    ),
}


def attempt(number: int, seed: int, home: Path) -> Iterator[Ended]:
    """One story, killed once or twice at moments spread over the time that it takes undisturbed."""
    draw = random.Random(f"kills/{seed}/{number}")
    story = list(STORIES)[number % len(STORIES)]
    begin, again, files = STORIES[story]
    length, whole = undisturbed(story)
    if story == "replacement":
        yield from _flown(["fly", "tianwen1", "--no-replay", "-q", "--out", "out"], home)
    killed = _killed(begin, home, draw.uniform(0.0, 1.05 * length))
    begun = begin if story == "campaign" and not (home / "out" / "campaign.json").exists() else again
    if killed and story == "campaign" and begun is again and draw.random() < 0.5:
        _killed(again, home, draw.uniform(0.0, length))
    if story != "flight" or not (home / "out").exists():
        yield from _flown(begun, home)
    found = {name: (home / "out" / name).read_bytes() for name in files if (home / "out" / name).is_file()}
    left = sorted(set(os.listdir(home)) - {"out", ".settings"}) + sorted(
        name for name in os.listdir(home / "out") if name == "parts" or name.endswith((".part", ".old"))
    )
    differ = [name for name in files if found.get(name) != whole[name]]
    wrong = f"differs: {differ}" if differ else f"left behind: {left}" if left else ""
    how = "killed" if killed else "ended before it was killed"
    yield Ended([f"{story} {how}"], 0, wrong)


@cache
def undisturbed(story: str) -> tuple[float, dict[str, bytes]]:
    """Time (s) that a story takes undisturbed, its machine code being there, and its files."""
    begin, _, files = STORIES[story]
    for _ in range(2):
        with TemporaryDirectory(prefix="undisturbed-") as home:
            began = time.monotonic()
            (done,) = _flown(begin, Path(home))
            assert not done.wrong, done
            length = time.monotonic() - began
            whole = {name: (Path(home) / "out" / name).read_bytes() for name in files}
    return length, whole


def _start(words: list[str], home: Path) -> subprocess.Popen[str]:
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    return subprocess.Popen([*PROGRAM, *words], cwd=home, env=environment, **pipes)


def _killed(words: list[str], home: Path, after: float) -> bool:
    """Start a command and kill it; whether it was still alive."""
    process = _start(words, home)
    try:
        process.communicate(timeout=after)
    except subprocess.TimeoutExpired:
        process.send_signal(signal.SIGKILL)
        process.communicate()
    return process.returncode == -signal.SIGKILL


def _flown(words: list[str], home: Path) -> Iterator[Ended]:
    """Run a command to its end."""
    process = _start(words, home)
    _, err = process.communicate(timeout=300)
    bad = "Traceback" in err or process.returncode not in (0, 1)
    yield Ended(words, process.returncode, f"ended with {process.returncode}: {err[-400:]}" if bad else "")
