"""The group of all commands, and what they have in common: exit status, version, and no traceback."""

from __future__ import annotations

import os
import re
import sys
from typing import Annotated, Any

import typer
from typer.core import TyperCommand, TyperGroup

from edl6dof.api.errors import naming_options
from edl6dof.cli.exit_status import BAD_INPUT, BROKEN_PIPE, INTERRUPTED
from edl6dof.config.errors import ConfigError


class Command(TyperCommand):
    """A command whose help calls an argument as its reader does: ``RUN``, and not ``{RUN} <list[Path]>``."""

    def collect_usage_pieces(self, ctx: Any) -> list[str]:
        """Return the words behind ``Usage: edl6dof NAME``."""
        pieces = [_called(one) if one.required else f"[{_called(one)}]" for one in self._arguments()]
        return [self.options_metavar or "", *pieces]

    def format_options(self, ctx: Any, formatter: Any) -> None:
        """Write arguments and options, each with what it means."""
        arguments = [(_called(one), getattr(one, "help", "") or "") for one in self._arguments()]
        records = [
            one.get_help_record(ctx) for one in self.get_params(ctx) if one.param_type_name == "option"
        ]
        options = [(names, _in_words(meaning)) for names, meaning in filter(None, records)]
        for title, rows in (("Arguments", arguments), ("Options", options)):
            if rows:
                with formatter.section(title):
                    formatter.write_dl(rows)

    def _arguments(self) -> list[Any]:
        return [one for one in self.params if one.param_type_name == "argument"]


_RANGE = re.compile(r"(?:(?P<low>[\d.]+)<=)?x(?:(?P<sign>[<>])=(?P<bound>[\d.]+))(?=[];])")


def _in_words(meaning: str) -> str:
    """The meaning of an option with its bounds as words: ``1 to 1024`` for ``1<=x<=1024``."""

    def words(found: re.Match[str]) -> str:
        bound = f"{float(found['bound']):g}"
        if found["low"]:
            return f"{float(found['low']):g} to {bound}"
        return f"at {'least' if found['sign'] == '>' else 'most'} {bound}"

    return _RANGE.sub(words, meaning)


def _called(argument: Any) -> str:
    return f"{argument.metavar or argument.name.upper()}{'...' if argument.nargs != 1 else ''}"


class Commands(TyperGroup):
    """All commands: bad input ends with status 2 and one line for each problem, Ctrl-C with 130, never with a
    traceback.
    """

    def invoke(self, ctx: Any) -> Any:
        """Run the command that was asked for; the number that it returns is the exit status."""
        try:
            with naming_options():
                status = super().invoke(ctx)
        except ConfigError as error:
            print(error, file=sys.stderr)
            raise typer.Exit(BAD_INPUT) from None
        except KeyboardInterrupt:
            print("interrupted; nothing was written", file=sys.stderr)
            raise typer.Exit(INTERRUPTED) from None
        except BrokenPipeError:
            sys.stdout = open(os.devnull, "w")  # noqa: SIM115  what is still in the buffer has nowhere to go
            raise typer.Exit(BROKEN_PIPE) from None
        raise typer.Exit(status or 0)


EXIT_STATUS = """Exit status: 0 done, and within all limits; 1 not within limits; 2 bad input; 69 something is
missing on this machine; 70 a defect of the program; 130 interrupted."""

app = typer.Typer(
    cls=Commands,
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    epilog=EXIT_STATUS,
)


def _show_version(wanted: bool) -> None:
    if wanted:
        from edl6dof import __version__

        print(f"edl6dof {__version__}")
        raise typer.Exit


@app.callback()
def options(
    version: Annotated[
        bool, typer.Option("--version", callback=_show_version, is_eager=True, help="Print name and version.")
    ] = False,
) -> None:
    """Six-degree-of-freedom Mars entry, descent and landing."""
