"""Declarations of options and arguments, in one line each."""

from __future__ import annotations

from typing import Annotated, Any

import typer


def option(metavar: str, meaning: str, *names: str, **bounds: Any) -> Any:
    """Declare an option with a value; ``names`` where they do not follow from the parameter."""
    return typer.Option(*names, metavar=metavar, help=meaning, **bounds)


def flag(meaning: str, *names: str) -> Any:
    """Declare an option without a value."""
    return typer.Option(*names, help=meaning)


def argument(metavar: str, meaning: str) -> Any:
    """Declare an argument."""
    return typer.Argument(metavar=metavar, help=meaning)


Sets = Annotated[
    list[str] | None,
    option("PATH=VALUE", "Change one parameter (edl6dof params lists them); repeatable.", "--set"),
]
