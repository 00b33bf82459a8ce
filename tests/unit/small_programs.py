"""Programs in processes of their own that begin with numba loaded.

They are forked from one process that has loaded it and nothing of ours: to load it, and to make it ready to
compile, takes ten times as long as what these programs do.
"""

from __future__ import annotations

import atexit
import json
import os
import socket
import subprocess
import sys
from functools import cache
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[2]

#: Reads requests from its standard input, a socket: the program as JSON and the pipe for what it printed.
SERVER = """
import contextlib, gc, io, json, os, socket, sys, traceback
import numba, numpy, pydantic
numba.njit("f8(f8)")(lambda x: x + x)
gc.freeze()
asked = socket.socket(fileno=0)
while True:
    request, pipes, _, _ = socket.recv_fds(asked, 100_000, 1)
    if not request or os.fork() == 0:
        break
    os.close(pipes[0])
    asked.sendall(b".")
    with contextlib.suppress(ChildProcessError):
        while os.waitpid(-1, os.WNOHANG)[0]:
            pass
if request:
    program, arguments, environment, folder = json.loads(request)
    os.environ.clear()
    os.environ.update(environment)
    numba.config.reload_config()
    os.chdir(folder)
    sys.argv = ["-c", *arguments]
    sys.dont_write_bytecode = True
    status, out, err = 0, io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            exec(program, {"__name__": "__main__"})
        except SystemExit as end:
            status = end.code or 0
        except BaseException:
            status = 1
            traceback.print_exc()
    with open(pipes[0], "w") as pipe:
        json.dump([status, out.getvalue(), err.getvalue()], pipe)
    os._exit(status)  # to take numba apart costs more than the program
else:
    with contextlib.suppress(ChildProcessError):
        while os.wait():
            pass
"""


class Ended(NamedTuple):
    """How a program ended, and what it printed."""

    returncode: int
    stdout: str
    stderr: str


class Running(NamedTuple):
    """A program that runs: the pipe in which it says at its end what it has printed."""

    pipe: int

    def ended(self) -> Ended:
        """Wait for it."""
        with open(self.pipe, encoding="utf-8") as pipe:
            return Ended(*json.loads(pipe.read() or '[-1, "", "it died"]'))


def start(program: str, *arguments: str, cwd: Path, **environment: str) -> Running:
    """Start a program in a folder, from which it can import."""
    request = json.dumps([program, arguments, inherited() | environment, str(cwd)]).encode()
    here, there = os.pipe()
    socket.send_fds(server(), [request], [there])
    os.close(there)
    assert server().recv(1) == b"."
    return Running(here)


def run(program: str, *arguments: str, cwd: Path, **environment: str) -> Ended:
    """Run a program to its end."""
    return start(program, *arguments, cwd=cwd, **environment).ended()


def inherited() -> dict[str, str]:
    """This process's environment without numba's settings and the user's folders."""
    return {key: text for key, text in os.environ.items() if not key.startswith(("NUMBA_", "XDG_"))}


@cache
def server() -> socket.socket:
    """Our end of the line to the process that is forked."""
    here, there = socket.socketpair()
    environment = inherited() | {"PYTHONPATH": str(ROOT)}
    process = subprocess.Popen([sys.executable, "-c", SERVER], stdin=there, env=environment)
    there.close()

    def end() -> None:
        here.shutdown(socket.SHUT_RDWR)  # whoever else may hold a copy of it
        process.wait()

    atexit.register(end)
    return here
