"""The program in a process of its own, forked from one that has loaded it: it ends in every way in which a
process can, and starts in no time.
"""

from __future__ import annotations

import multiprocessing
import os
import resource
import shutil
import sys
import tempfile
from collections.abc import Callable
from multiprocessing import forkserver
from multiprocessing.context import ForkServerContext
from pathlib import Path
from unittest.mock import patch

import nudged

from edl6dof import cli


class Forked:
    """A started program: what there is of :class:`subprocess.Popen` that the tests ask for."""

    def __init__(self, *words: str, cwd: Path, main: Callable[[], None] = cli.main):
        self._folder = Path(tempfile.mkdtemp())
        self._said = [self._folder / name for name in ("out", "err")]
        # it dies with the tests, whatever they left it doing
        self._process = _server().Process(
            target=_run, args=(main, words, cwd, self._said, nudged.nudged_by), daemon=True
        )
        self._process.start()

    @property
    def returncode(self) -> int | None:
        """Exit status, or the signal that ended it, negative."""
        return self._process.exitcode

    def send_signal(self, number: int) -> None:
        """Send a signal."""
        assert self._process.pid
        os.kill(self._process.pid, number)

    def kill(self) -> None:
        """End it, whatever it does."""
        self._process.kill()

    def wait(self, timeout: float) -> int | None:
        """Exit status."""
        self._process.join(timeout)
        assert self.returncode is not None, f"not over after {timeout:g} s"
        return self.returncode

    def communicate(self, timeout: float) -> tuple[str, str]:
        """Standard output and standard error of a program that ends within a time."""
        self.wait(timeout)
        said = self.said()
        shutil.rmtree(self._folder, ignore_errors=True)
        return said

    def said(self) -> tuple[str, str]:
        """Standard output and standard error until now."""
        out, err = (path.read_text() if path.exists() else "" for path in self._said)
        return out, err


def finished(*words: str, cwd: Path, main: Callable[[], None] = cli.main) -> tuple[int, str, str]:
    """Run the program to its end: status, stdout, stderr."""
    process = Forked(*words, cwd=cwd, main=main)
    out, err = process.communicate(timeout=300)
    return process.returncode or 0, out, err


def program_with_small_files() -> None:
    """The program, which may write no file beyond 64 KiB."""
    resource.setrlimit(resource.RLIMIT_FSIZE, (65536, 65536))
    cli.main()


def _server() -> ForkServerContext:
    """Where processes are forked; it is started for the first of them."""
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(["loaded"])
    with patch.dict(os.environ, PYTHONPATH=os.pathsep.join(sys.path)):
        forkserver.ensure_running()
    return context


def _run(main: Callable[[], None], words: tuple[str, ...], cwd: Path, said: list[Path], by: float) -> None:
    if by:
        nudged.nudge_initial_states(by)
    for name in ("COLUMNS", "FORCE_COLOR", "TERM"):
        os.environ.pop(name, None)
    os.chdir(cwd)
    for number, path in enumerate(said, start=1):
        os.dup2(os.open(path, os.O_WRONLY | os.O_CREAT), number)
    sys.argv = ["edl6dof", *words]
    main()
