"""The command line.  Heavy imports happen inside the commands, so that ``--help`` is quick."""

from __future__ import annotations

import os
import sys
import traceback
from collections.abc import Callable

from edl6dof.cli.campaigns import campaign, covariance, faults, margins, rare, refly
from edl6dof.cli.designs import design, new
from edl6dof.cli.evidence import calibrate, figures, study, validate, verify
from edl6dof.cli.group import BAD_INPUT, DEFECT, Command, app
from edl6dof.cli.run_outputs import assure, compare, export, plot, replay, report
from edl6dof.cli.scenarios import cache, check, fly, params, scenarios, schema, serve, show, trust, version

#: By the title of their part of the help.
COMMANDS: dict[str, tuple[Callable[..., int | None], ...]] = {
    "Fly": (fly, campaign, refly, faults, covariance, rare, margins),
    "Look at results": (report, assure, replay, plot, compare, export),
    "Scenarios": (scenarios, show, check, params, schema, trust),
    "Compare with references and papers": (verify, validate, figures, calibrate, study),
    "Other": (serve, cache, version),
}
for title, commands in COMMANDS.items():
    for command in commands:
        app.command(cls=Command, rich_help_panel=title)(command)
app.add_typer(new, name="new", rich_help_panel="Scenarios")
app.add_typer(design, name="design", rich_help_panel="Scenarios")


def main() -> None:
    """Run the command line; an exception that no command handles is a defect, with its own exit status."""
    if os.path.lexists(".numba_config.yaml"):
        words = "holds settings of numba for this folder, which edl6dof does not take: start it elsewhere"
        print(f".numba_config.yaml: {words}, or set them as NUMBA_ variables", file=sys.stderr)
        sys.exit(BAD_INPUT)
    # matrices here are small: threads of the linear algebra would wait for each other a hundred times as long
    # as they compute, and the last digits would depend on the number of threads
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    os.environ.setdefault("ARROW_DEFAULT_MEMORY_POOL", "system")  # pyarrow's own pool keeps 9 MB after use
    try:
        app(prog_name="edl6dof")
    except Exception:
        traceback.print_exc()
        words = "this is a defect of the program, not of what you gave it; please report it with these lines"
        print(f"edl6dof: {words}", file=sys.stderr)
        sys.exit(DEFECT)
