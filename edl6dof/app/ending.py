"""How a command ends when it cannot do its work."""

from __future__ import annotations

import sys

BAD_INPUT = 2
INTERRUPTED = 130


def refuse(message: str) -> int:
    """Say in one line on standard error why; returns the exit status of bad input."""
    print(" ".join(message.split()), file=sys.stderr)
    return BAD_INPUT
