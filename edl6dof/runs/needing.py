"""Channels that plots and reports need of runs.

Every command imports this before it knows which plugins to load: it must import no family.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from edl6dof.config.errors import UnknownName, refusal


@contextmanager
def needing_channels(*folders: Path) -> Iterator[None]:
    """Turn a channel that the runs in the folders lack into one line.

    Raises:
        ConfigError: the runs lack a channel.
    """
    try:
        yield
    except UnknownName as error:
        words = f"no {error.kind} {error.name!r}, which is needed here; plot and export show what there is"
        raise refusal(", ".join(map(str, folders)), words) from None
