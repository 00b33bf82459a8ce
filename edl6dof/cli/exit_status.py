"""Exit statuses of commands, and the messages of commands that fail."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from traceback import extract_tb

from edl6dof.config.errors import ConfigError, refusal

#: The flight, or what was to be shown by flights, is not within its limits.
NOT_WITHIN_LIMITS = 1
#: What was given cannot be used.
BAD_INPUT = 2
#: Something that the command needs is not on this machine (EX_UNAVAILABLE of sysexits.h).
UNAVAILABLE = 69
#: The program itself has a defect (EX_SOFTWARE of sysexits.h).
DEFECT = 70
#: Ctrl-C.
INTERRUPTED = 130
#: Whoever read the output has stopped reading it.
BROKEN_PIPE = 141


def refuse(message: str) -> int:
    """Say in one line on standard error why; returns the exit status of bad input."""
    print(" ".join(message.split()), file=sys.stderr)
    return BAD_INPUT


@contextmanager
def refusing_damage(*folders: Path) -> Iterator[None]:
    """The one place that turns whatever goes wrong while results are read and shown into one line.

    Hashes and types of the files are checked where they are read; a folder made up to pass those checks ends
    here.

    Raises:
        ConfigError: with the place in this program that could not go on.
    """
    from edl6dof.runs.files import needing_channels

    try:
        with needing_channels(*folders):
            yield
    except ConfigError:
        raise
    except Exception as error:
        place = extract_tb(error.__traceback__)[-1]
        where = f"{Path(place.filename).name}:{place.lineno}"
        names = ", ".join(map(str, folders))
        words = f"holds what no result of edl6dof holds ({type(error).__name__}: {error}; {where})"
        raise refusal(names, words) from error
