"""Completion of command lines by the shell, which ``edl6dof --install-completion`` installs."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from contextlib import suppress
from pathlib import Path

import typer

from edl6dof.config.errors import ConfigError


def scenarios(incomplete: str) -> list[str]:
    """Names of shipped scenarios, and YAML files of the current folder."""
    from edl6dof.config.document.locate import shipped_names

    return _beginning(incomplete, [*shipped_names("scenarios"), *yaml_files(incomplete)])


def yaml_files(incomplete: str) -> list[str]:
    """YAML files of the current folder."""
    return _beginning(incomplete, map(str, Path().glob("*.yaml")))


def paths(ctx: typer.Context, incomplete: str) -> list[str]:
    """Dotted paths of the parameters of the scenario on the command line; of any scenario without one."""
    from edl6dof.config.parameter_table import rows, values
    from edl6dof.scenario.loading import load_scenario
    from edl6dof.scenario.schema import Scenario

    if given := _first_argument(ctx, "scenario"):
        with suppress(ConfigError):
            loaded = load_scenario(given)
            return _beginning(incomplete, (one.row.path for one in values(loaded.scenario, loaded.document)))
    return _beginning(incomplete, (row.path.partition("[")[0] for row in rows(Scenario)))


def assignments(ctx: typer.Context, incomplete: str) -> list[str]:
    """Dotted paths as of :func:`paths`, each with an equals sign, after which the value is typed."""
    return [f"{path}=" for path in paths(ctx, incomplete)]


def channels(ctx: typer.Context, incomplete: str) -> list[str]:
    """Channels of the run on the command line."""
    from edl6dof.runs.run import Run

    with suppress(ConfigError):
        return _beginning(incomplete, Run(Path(_first_argument(ctx, "run"))))
    return []


#: What completes an argument or an option, by the word that stands for it in the help.
COMPLETIONS: dict[str, Callable[..., list[str]]] = {
    "SCENARIO": scenarios,
    "REQUIREMENTS": yaml_files,
    "PATH": paths,
    "PATH=VALUE": assignments,
    "CHANNEL": channels,
    "RUN|CHANNEL": channels,
}


def _first_argument(ctx: typer.Context, name: str) -> str:
    """The first argument on the command line; empty without one. While an option is completed, the parser
    leaves it in ``ctx.args``.
    """
    return str(ctx.params.get(name) or next(iter(ctx.args), ""))


def _beginning(incomplete: str, words: Iterable[str]) -> list[str]:
    return sorted({word for word in words if word.startswith(incomplete)})
