"""``edl6dof cache``: the machine code that is kept on this machine."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from shutil import rmtree
from typing import Annotated

from edl6dof.cli.group import flag


def cache(
    clear: Annotated[bool, flag("Remove the code of this installation.", "--clear")] = False,
    everything: Annotated[
        bool, flag("With --clear: that of other installations and versions, too.", "--all")
    ] = False,
) -> int:
    """Show the machine code on this machine, or clear it.

    It is compiled by the first flight of an installation, and named by a hash of its sources: it is never
    stale. Code that was not used for 30 days goes by itself.
    """
    from edl6dof.cli.exit_status import refuse
    from edl6dof.config.wording import counted
    from edl6dof.kernels.cache import folder

    if everything and not clear:
        return refuse("--all: is of --clear")
    if (own := folder()) is None:
        print("none is kept")
        return 0
    others = [one for one in own.parent.iterdir() if one.is_dir() and one != own]
    print(f"{own.parent}\n  this installation: {_size([own])}\n  others: {_size(others)}")
    if clear:
        removed = [own, *others] if everything else [own]
        for place in removed:
            rmtree(place, ignore_errors=True)
        print(f"removed: {counted(len(removed), 'folder')}")
    return 0


def _size(places: Sequence[Path]) -> str:
    """Say how large folders are."""
    sizes = [file.stat().st_size for place in places for file in place.iterdir() if file.is_file()]
    return f"{sum(sizes) / 1e6:.1f} MB in {len(sizes):,} files"
