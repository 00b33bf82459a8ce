"""The program in this process, which is much quicker than in one of its own."""

from __future__ import annotations

import io
import subprocess
import sys
from contextlib import chdir, redirect_stderr, redirect_stdout
from pathlib import Path
from unittest.mock import patch

from typer.main import get_command

from edl6dof import cli

#: Put together once in a process: again for every call, it takes longer than most of what is asked for.
PROGRAM = get_command(cli.app)


def called(*words: object, cwd: Path | str = ".") -> subprocess.CompletedProcess[str]:
    """Run the program; a traceback that it would print is in its stderr too."""
    out, err, argv = io.StringIO(), io.StringIO(), sys.argv
    sys.argv = ["edl6dof", *map(str, words)]
    try:
        with chdir(cwd), redirect_stdout(out), redirect_stderr(err), patch.object(cli, "app", PROGRAM):
            cli.main()
        status = 0
    except SystemExit as end:
        status = int(end.code or 0)
    finally:
        sys.argv = argv
    return subprocess.CompletedProcess(list(words), status, out.getvalue(), err.getvalue())
