"""The group of all commands: help, examples, exit statuses and their messages."""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from traceback import extract_tb
from typing import Annotated, Any

import typer
from typer.core import TyperCommand, TyperGroup

from edl6dof.api.arguments import naming_options
from edl6dof.config.errors import ConfigError, refusal

#: Exit statuses; 69 and 70 are those of sysexits.h, 130 is that of Ctrl-C.
NOT_WITHIN_LIMITS, BAD_INPUT, UNAVAILABLE, DEFECT, INTERRUPTED = 1, 2, 69, 70, 130
#: The reader of the output has closed it.
BROKEN_PIPE = 141


class Command(TyperCommand):
    """A command whose docstring ends with examples, which its help shows below the options; the help shows an
    argument as ``RUN``, and not as ``{RUN} <list[Path]>``.
    """

    def __init__(self, name: str, *, help: str, **about: Any):
        words, _, examples = help.partition("\n\nedl6dof ")
        lines = f"edl6dof {examples}".split("\n")
        below = "\n".join(["\b", "Examples:", *(f"  {line}" for line in lines)])
        super().__init__(name, help=words, **{**about, "epilog": below})

    def collect_usage_pieces(self, ctx: Any) -> list[str]:
        """Return the words behind ``Usage: edl6dof NAME``."""
        pieces = [_called(one) if one.required else f"[{_called(one)}]" for one in self._arguments()]
        return [self.options_metavar or "", *pieces]

    def format_options(self, ctx: Any, formatter: Any) -> None:
        """Write arguments and options, each with its meaning."""
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
        return [
            one
            for one in self.params
            if one.param_type_name == "argument" and not getattr(one, "hidden", False)
        ]


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
    """Group of all commands; bad input ends with status 2 and a line for each problem, Ctrl-C with 130."""

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """Write the commands under the titles that they are declared with."""
        titled: dict[str, list[tuple[str, str]]] = {}
        width = max(map(len, self.commands))
        for name, command in self.commands.items():
            line = f"{name:<{width}}", command.get_short_help_str(formatter.width - width - 6)
            titled.setdefault(getattr(command, "rich_help_panel", None) or "Commands", []).append(line)
        for title, lines in titled.items():
            with formatter.section(title):
                formatter.write_dl(lines)

    def invoke(self, ctx: Any) -> Any:
        """Run the given command; the number that it returns is the exit status."""
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


def refuse(message: str) -> int:
    """Print a reason in one line on standard error; return the exit status of bad input."""
    print(" ".join(message.split()), file=sys.stderr)
    return BAD_INPUT


def check_target(path: Path | None, suffixes: Sequence[str], force: bool) -> None:
    """Check before anything is computed that a file, if one is named, has a known form and can be written.

    Raises:
        ConfigError: the file has another form, or exists.
    """
    from edl6dof.runs.files import refuse_existing_file

    if path is None:
        return
    if path.suffix not in suffixes:
        raise refusal(path, f"must end in {', '.join(suffixes)}")
    refuse_existing_file(path, force)


def write_file(out: Path | None, force: bool, write: Callable[[Path], object]) -> None:
    """Write the file that an option names, if it names one, and print its path."""
    from edl6dof.runs.files import atomic_file

    if out is not None:
        with atomic_file(out, force) as partial:
            write(partial)
        print(out)


@contextmanager
def refusing_damage(*folders: Path) -> Iterator[None]:
    """Turn any error while results are read and shown into one line.

    Files are checked when they are read; this covers a folder that was forged to pass those checks.

    Raises:
        ConfigError: names the line of this program that failed.
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


EXIT_STATUS = """Exit status: 0 done, and within all limits; 1 not within limits; 2 bad input; 69 something is
missing on this machine; 70 a defect of the program; 130 interrupted."""

app = typer.Typer(
    cls=Commands,
    no_args_is_help=True,
    context_settings={"help_option_names": ["-h", "--help"]},
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
