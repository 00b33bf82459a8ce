"""A folder with a plugin that nobody has accepted: where it is named, where its file lies, and whether the
folder has the manifest of a result, in every combination, each given to every command.
"""

from __future__ import annotations

import py_compile
import sys
from collections.abc import Callable, Iterator
from itertools import product
from pathlib import Path

from attempt import Ended, ended
from command import finished
from test_received_folders import LAW

from edl6dof.manifest import seal

_BODY = "name: theirs\nplugins: [{}]\nflight_software: {{guidance: {{entry: {{law: mine}}}}}}\n"
NAMED = _BODY + "extends: tianwen1\n"


def _itself(folder: Path, law: str) -> None:
    (folder / "scenario.yaml").write_text(NAMED.format(law))


def _below(folder: Path, law: str) -> None:
    (folder / "base").mkdir()
    (folder / "base" / "mission.yaml").write_text(NAMED.format(f"../{law}"))
    (folder / "scenario.yaml").write_text("extends: base/mission.yaml\nname: theirs\n")


def _above(folder: Path, law: str) -> None:
    (folder.parent / "mission.yaml").write_text(NAMED.format(folder / law))
    (folder / "scenario.yaml").write_text("extends: ../mission.yaml\nname: theirs\n")


def _twice_extended(folder: Path, law: str) -> None:
    _below(folder, law)
    (folder / "scenario.yaml").rename(folder / "middle.yaml")
    (folder / "scenario.yaml").write_text("extends: middle.yaml\nname: theirs\n")


def _quoted(folder: Path, law: str) -> None:
    """As no search for a line ``plugins:`` finds it."""
    _itself(folder, law)
    text = (folder / "scenario.yaml").read_text()
    (folder / "scenario.yaml").write_text(text.replace("plugins:", '? "plugins"\n:'))


def _file(folder: Path) -> str:
    (folder / "law.py").write_text(LAW)
    return "law.py"


def _link(folder: Path) -> str:
    (folder.parent / "elsewhere.py").write_text(LAW)
    (folder / "law.py").symlink_to(folder.parent / "elsewhere.py")
    return "law.py"


def _outside(folder: Path) -> str:
    (folder.parent / "outside.py").write_text(LAW)
    return "../outside.py"


def _with_byte_code(folder: Path) -> str:
    """Byte code that Python would load without a look at the source."""
    (folder / "__pycache__").mkdir()
    compiled = folder / "__pycache__" / f"law.{sys.implementation.cache_tag}.pyc"
    mode = py_compile.PycInvalidationMode.UNCHECKED_HASH
    py_compile.compile(str(folder / _file(folder)), str(compiled), invalidation_mode=mode)
    return "law.py"


Laid = Callable[[Path, str], None]
FOLDERS = list(
    product(
        (_itself, _below, _above, _twice_extended, _quoted),
        (_file, _link, _outside, _with_byte_code),
        (False, True),
    )
)
COMMANDS = (
    ("check", "received/scenario.yaml"),
    ("fly", "received/scenario.yaml", "-q", "--no-replay", "--out", "out"),
    ("fly", "received", "-q", "--no-replay", "--out", "out"),
    ("campaign", "received/scenario.yaml", "-n", "2", "-q", "--out", "out"),
    ("campaign", "received", "--resume", "-q"),
    ("refly", "received", "0", "--out", "out"),
    ("faults", "received/scenario.yaml", "--out", "out"),
    ("design", "landing", "received/scenario.yaml", "--out", "out"),
    ("covariance", "received/scenario.yaml", "--out", "out"),
    ("report", "received", "--out", "out.html"),
    ("export", "received", "out.csv", "--format", "csv"),
    ("trust", "received/law.py"),
)


def attempt(number: int, seed: int, home: Path) -> Iterator[Ended]:
    """One folder: every command refuses it and runs nothing; after consent, a check runs the law."""
    named, lies, sealed = FOLDERS[number % len(FOLDERS)]
    called = f"({named.__name__} {lies.__name__}{' sealed' if sealed else ''})"
    folder = home / "received"
    folder.mkdir()
    law = lies(folder)
    named(folder, law)
    if sealed:
        seal(folder, "flight")
    for words in COMMANDS:
        done = ended(list(words), home)
        ran = "code ran without consent" if list(home.rglob("RAN")) else ""
        passed = f"passed: {done.stdout[:200]}" if done.status != 2 and words[0] != "trust" else ""
        misspelt = "no such command" if "Usage:" in done.stderr else ""
        yield done._replace(words=[*words, called], wrong=ran or done.wrong or passed or misspelt)
    if named is _quoted:
        return  # its plugin is not found, so it is refused even after consent
    finished("trust", folder / law, "--yes", cwd=home)
    done = finished("check", "received/scenario.yaml", cwd=home)
    wrong = "" if done.returncode == 0 and list(home.rglob("RAN")) else f"after consent: {done.stderr[-300:]}"
    yield Ended(["check after consent", called], done.returncode, wrong)
