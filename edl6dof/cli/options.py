"""How commands declare arguments and options, and those that several commands have."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from edl6dof.cli.completion import COMPLETIONS


def option(metavar: str, meaning: str, *names: str, **bounds: Any) -> Any:
    """Declare an option with a value; ``names`` where they do not follow from the parameter."""
    return typer.Option(
        *names, metavar=metavar, help=meaning, autocompletion=COMPLETIONS.get(metavar), **bounds
    )


def flag(meaning: str, *names: str) -> Any:
    """Declare an option without a value."""
    return typer.Option(*names, help=meaning)


def argument(metavar: str, meaning: str) -> Any:
    """Declare an argument."""
    return typer.Argument(metavar=metavar, help=meaning, autocompletion=COMPLETIONS.get(metavar))


Sets = Annotated[
    list[str] | None,
    option("PATH=VALUE", "Change one parameter (edl6dof params lists them); repeatable.", "--set"),
]
Scenario = Annotated[str, argument("SCENARIO", "Scenario file, or the name of a shipped one.")]
Requirements = Annotated[
    Path | None,
    argument("REQUIREMENTS", "YAML file of requirements; every limit of the scenario if not given."),
]
Workers = Annotated[int | None, option("N", "Threads; all cores if not given.", "--workers", min=1, max=1024)]
