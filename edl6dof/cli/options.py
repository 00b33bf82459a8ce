"""Options that several commands take, and the loading of plugins, which comes before anything else."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

Sets = Annotated[
    list[str] | None,
    typer.Option(
        "--set", metavar="PATH=VALUE", help=("Change one parameter (edl6dof params lists them); repeatable.")
    ),
]


def load_plugins(*operands: str | Path | None) -> None:
    """Load the plugins of what is to be flown and of the environment, before anything is imported that they
    must join.
    """
    from edl6dof.config.plugin_scan import files_from_environment, files_naming_plugins

    given = [operand for operand in operands if operand is not None]
    if files_from_environment() or any(file for operand in given for file in files_naming_plugins(operand)):
        from edl6dof.plugins import activate

        activate(given)
