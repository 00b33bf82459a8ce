"""Type what the documents tell to type, as their reader would: every shell command and all Python of
README.md and docs/, in document order, in a fresh folder for each page.

    python tools/run_docs.py                          # all pages: an hour of one core
    python tools/run_docs.py --page docs/python.md    # one of them; --show prints what they print
    python tools/run_docs.py --list                   # what would be run, and what not, and why

``tools/docs_commands.py`` says which remarks in a page change what is run.
"""

from __future__ import annotations

import argparse
import os
import resource
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from docs_commands import ROOT, Step, files, pages, steps

#: Longest time for one command, s.
LIMIT_S = 3600.0


@dataclass(frozen=True)
class Done:
    """A step that was run."""

    step: Step
    status: int
    cpu_s: float
    output: str

    @property
    def right(self) -> bool:
        """Whether it ended as its page says."""
        return self.status in self.step.statuses


def run_page(page: str, show: bool, since: int = 1) -> list[Done]:
    """Run the steps of a page, from a line on, in a folder of their own."""
    text = (ROOT / page).read_text(encoding="utf-8")
    wanted = [step for step in steps(page, text) if not step.reason and step.line >= since]
    if not wanted:
        return []
    with TemporaryDirectory(prefix="edl6dof-docs-") as place:
        folder = Path(place)
        for name, content in files(text).items():
            (folder / name).write_text(content, encoding="utf-8")
        for name in ("tools", "examples", "scenarios", "vehicles", "docs", "tests"):
            (folder / name).symlink_to(ROOT / name)  # a reader's checkout
        return [_told(run(step, folder), show) for step in wanted]


def run(step: Step, folder: Path) -> Done:
    """Run a step in a folder, without a window to be opened."""
    environment = {
        name: value for name, value in os.environ.items() if name not in ("DISPLAY", "WAYLAND_DISPLAY")
    }
    environment["PATH"] = os.pathsep.join([str(Path(sys.executable).parent), environment["PATH"]])
    environment["MPLBACKEND"] = "Agg"
    command = [sys.executable, "-c", step.run] if step.python else ["bash", "-c", step.run]
    before = _cpu_s()
    try:
        done = subprocess.run(
            command, cwd=folder, env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT, text=True, errors="replace", timeout=LIMIT_S,
        )  # fmt: skip
    except subprocess.TimeoutExpired:
        return Done(step, 124, _cpu_s() - before, f"still running after {LIMIT_S:g} s")
    return Done(step, done.returncode, _cpu_s() - before, done.stdout)


def _cpu_s() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def _told(done: Done, show: bool) -> Done:
    mark = "" if done.right else f"  <- expected {' or '.join(map(str, done.step.statuses))}"
    print(f"{_place(done.step)} {done.status:>3} {done.cpu_s:7.1f} s  {_words(done.step)}{mark}", flush=True)
    if show or not done.right:
        print(
            "".join(f"    | {line}\n" for line in done.output.splitlines()[None if show else -15 :]),
            flush=True,
        )
    return done


def _place(step: Step) -> str:
    return f"{step.page}:{step.line:<4}"


def _words(step: Step) -> str:
    if step.python:
        return step.shown if step.reason == "" else "Python"
    return step.run


def main() -> int:
    """Run the pages asked for; returns the exit status."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument(
        "--page", action="append", help="page, such as docs/python.md; repeatable; all if not given"
    )
    parser.add_argument("--since", type=int, default=1, metavar="LINE", help="line of each page to begin at")
    parser.add_argument("--show", action="store_true", help="print what the commands print")
    parser.add_argument("--list", action="store_true", help="run nothing; print what would be run")
    wanted = parser.parse_args()
    chosen = wanted.page or pages()
    if wanted.list:
        for page in chosen:
            for step in steps(page, (ROOT / page).read_text(encoding="utf-8")):
                reason = f"NOT RUN ({step.reason}): " if step.reason else ""
                print(f"{_place(step)} {reason}{_words(step)}")
        return 0
    done = [each for page in chosen for each in run_page(page, wanted.show, wanted.since)]
    wrong = [each for each in done if not each.right]
    cpu_s = sum(each.cpu_s for each in done)
    print(f"{len(done)} commands, {cpu_s:.0f} s of CPU, {len(wrong)} not as they should")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
