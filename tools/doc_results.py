"""Measured results in the documents: which are out of date, and how to renew them.

    python tools/doc_results.py                # list the results; exit status 1 if any is out of date
    python tools/doc_results.py --renew TEXT   # run the commands that contain TEXT ('': all out of date)
    python tools/doc_results.py --stamp TEXT   # mark results as current: their numbers were renewed by hand

A result stands below a remark that names the command, the golden flights it depends on, and a hash of them:

    <!-- measured by `edl6dof figures tianwen1 | head -36` on tianwen1 0a1b2c3d -->

The hash is that of the telemetry and figures of these flights (``edl6dof/data/golden``): it changes when the
code flies differently, and not when a function moves to another file.  ``--renew`` replaces what follows by
the output of the command: a block of the language ``text``, or Markdown from ``<!-- markdown -->`` to
``<!-- /measured -->``.  Other results are renewed by hand; pictures are made by ``tools/pictures.py``.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parents[1]
_GOLDEN = ROOT / "edl6dof" / "data" / "golden" / "hashes.json"
_REMARK = re.compile(
    r"<!-- measured by `(?P<command>[^`]+)` "
    r"on (?P<flights>\w[\w/]*(?:, \w[\w/]*)*) (?P<hash>[0-9a-f]{8}) -->\n"
    r"(?:(?P<open>```text\n|<!-- markdown -->\n).*?(?P<close>^```\n|^<!-- /measured -->\n))?",
    flags=re.DOTALL | re.MULTILINE,
)


class Result(NamedTuple):
    """A result of a page: where it stands, how it was measured, and whether it is current."""

    page: str
    line: int
    command: str
    flights: str
    current: bool
    generated: bool


def golden_hashes() -> dict[str, dict[str, str]]:
    """Hashes of each golden flight, by its name, without those of the parameters on board."""
    found: dict[str, dict[str, str]] = json.loads(_GOLDEN.read_text(encoding="utf-8"))
    return {
        name: {key: value for key, value in parts.items() if not key.startswith("onboard.")}
        for name, parts in found.items()
    }


def flights_hash(names: str) -> str:
    """Hash of golden flights, named with commas between them, or ``all``.

    Raises:
        KeyError: a name is no golden flight.
    """
    golden = golden_hashes()
    chosen = golden if names == "all" else {name: golden[name] for name in names.split(", ")}
    return hashlib.sha256(json.dumps(chosen, sort_keys=True).encode()).hexdigest()[:8]


def pages() -> list[Path]:
    """Every page of the documents, the README first."""
    return [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]


def results(page: str, text: str) -> list[Result]:
    """Results of a page in their order."""
    return [
        Result(
            page,
            text.count("\n", 0, match.start()) + 1,
            match["command"],
            match["flights"],
            match["hash"] == flights_hash(match["flights"]),
            match["open"] is not None,
        )
        for match in _REMARK.finditer(text)
    ]


def renewed(text: str, chosen: str, run: Callable[[str], str] | None) -> str:
    """A page with the results whose command contains ``chosen`` renewed; an empty text chooses those that are
    out of date.  Without ``run`` the hashes alone change.
    """

    def renew(match: re.Match[str]) -> str:
        new = flights_hash(match["flights"])
        if chosen not in match["command"] or not chosen and match["hash"] == new:
            return match[0]
        if run is None:
            return match[0].replace(f" {match['hash']} -->", f" {new} -->", 1)
        if match["open"] is None:
            return match[0]
        remark = match[0].splitlines(keepends=True)[0].replace(f" {match['hash']} -->", f" {new} -->")
        return f"{remark}{match['open']}{run(match['command'])}\n{match['close']}"

    return _REMARK.sub(renew, text)


def output_of(command: str) -> str:
    """What a command prints to standard output, 100 columns wide, in a folder with the tools and no runs."""
    environment = os.environ | {"COLUMNS": "100", "NO_COLOR": "1", "PYTHONPATH": str(ROOT)}
    environment["PATH"] = f"{Path(sys.executable).parent}{os.pathsep}{environment['PATH']}"
    print(f"$ {command}", file=sys.stderr, flush=True)
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "tools").symlink_to(ROOT / "tools")
        done = subprocess.run(
            ["bash", "-c", command], cwd=folder, env=environment, stdout=subprocess.PIPE, text=True
        )
    if not done.stdout.strip():
        sys.exit(f"{command}: printed nothing (exit status {done.returncode})")
    lines = [line.rstrip() for line in done.stdout.splitlines()]
    return re.sub(r"\n{3,}", "\n\n", "\n".join(lines)).strip("\n")


def main() -> int:
    """List the results, or renew them."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--renew", metavar="TEXT", help="run the commands that contain TEXT")
    parser.add_argument("--stamp", metavar="TEXT", help="mark the results of these commands as current")
    given = parser.parse_args()
    for path in pages():
        chosen, run = (given.renew, output_of) if given.stamp is None else (given.stamp, None)
        if chosen is not None:
            path.write_text(renewed(path.read_text(encoding="utf-8"), chosen, run), encoding="utf-8")
    found = [
        result
        for path in pages()
        for result in results(str(path.relative_to(ROOT)), path.read_text(encoding="utf-8"))
    ]
    for result in found:
        state = "current" if result.current else "OUT OF DATE"
        by_hand = "" if result.generated else " (by hand)"
        print(f"{result.page}:{result.line}: {state}: {result.command}{by_hand}")
    return 0 if all(result.current for result in found) else 1


if __name__ == "__main__":
    sys.exit(main())
