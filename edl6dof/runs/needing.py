"""What is made of runs needs some channels; a run of another version may not have them."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from edl6dof.another_version import told, writer
from edl6dof.config.errors import refusal
from edl6dof.config.named import UnknownName
from edl6dof.manifest import MANIFEST


@contextmanager
def needing_channels(*folders: Path) -> Iterator[None]:
    """Say in one line which channel is missing, and what is of another version.

    Raises:
        ConfigError: the runs in the folders lack a channel.
    """
    try:
        yield
    except UnknownName as error:
        names = ", ".join(map(str, folders))
        message = f"no {error.kind} {error.name!r}, which is needed here{other_versions(*folders)}"
        raise refusal(names, f"{message}; plot and export show what there is") from None


def other_versions(*folders: Path) -> str:
    """Which of these results another version wrote, in words to put behind others; empty for none."""
    versions = {folder: version for folder in folders if (version := writer(folder / MANIFEST))}
    if not versions:
        return ""
    if len(folders) == 1:
        return f" ({told(versions[folders[0]])})"
    return f" ({'; '.join(f'{folder}: {told(version)}' for folder, version in versions.items())})"
