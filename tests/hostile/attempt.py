"""How one command of an attack ended, and what is wrong with that."""

from __future__ import annotations

import json
import time
from functools import cache
from pathlib import Path
from typing import NamedTuple

from in_process import called

#: Seconds that a command may last.
SECONDS = 60.0
#: Exit statuses that an input may bring about: done, not within limits, refused.
ALLOWED = (0, 1, 2)


class Ended(NamedTuple):
    """A command's words, exit status and output, and what is wrong with how it ended (empty: nothing)."""

    words: list[str]
    status: int
    wrong: str
    stdout: str = ""
    stderr: str = ""


def ended(words: list[str], folder: Path) -> Ended:
    """Run a command in this process; a refused one must say why and leave nothing in ``folder``."""
    before, began = set(folder.iterdir()), time.monotonic()
    try:
        done = called(*words)
    except BaseException as error:  # what the program itself would have let through
        return Ended(words, 70, f"{type(error).__name__}: {error}")
    text, new = done.stdout + done.stderr, set(folder.iterdir()) - before
    wrong = ""
    if done.returncode not in ALLOWED or "Traceback" in text:
        wrong = f"ended with {done.returncode}: {text[-600:]}"
    elif done.returncode == 2 and not done.stderr.strip():
        wrong = "refused without a word"
    elif done.returncode == 2 and new:
        wrong = f"left behind: {new}"
    elif any(not (ch.isprintable() or ch == "\n") for ch in done.stderr):
        wrong = f"control characters: {done.stderr[:200]!r}"
    elif (took := time.monotonic() - began) > SECONDS:
        wrong = f"took {took:.0f} s"
    return Ended(words, done.returncode, wrong, done.stdout, done.stderr)


@cache
def parameters() -> list[str]:
    """Dotted paths of all parameters."""
    return [row["path"] for row in json.loads(called("params", "--json").stdout)]
