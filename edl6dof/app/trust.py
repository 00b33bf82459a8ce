"""``edl6dof trust``: show the source of plugins and record the user's consent to run it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from edl6dof.app.exit_status import NOT_WITHIN_LIMITS
from edl6dof.config.accepted import accept, accepted_file, is_accepted
from edl6dof.config.document.locate import shown
from edl6dof.config.errors import refusal
from edl6dof.plugins import named_by, plugin_content, source_text


def run_trust(files: Sequence[str], yes: bool) -> int:
    """Show each plugin and ask whether it may run; what is shown is what is accepted."""
    for path in [path for file in files for path in _plugins(file)]:
        try:
            content = plugin_content(path)
            source = source_text(content)
        except OSError as error:
            raise refusal(shown(path), f"cannot be read: {error.strerror or error}") from error
        except UnicodeDecodeError as error:
            raise refusal(shown(path), "is not text in UTF-8") from error
        if is_accepted(content):
            print(f"{shown(path)}: accepted before")
            continue
        print(_printable(source))
        if not yes and not _consent(path):
            print(f"{shown(path)}: not accepted")
            return NOT_WITHIN_LIMITS
        try:
            accept(path, content)
        except OSError as error:
            raise refusal(shown(accepted_file()), f"cannot be written: {error.strerror or error}") from error
        print(f"{shown(path)}: accepted")
    return 0


def _plugins(file: str) -> list[Path]:
    if file.endswith(".py"):
        return [Path(file).absolute()]
    if found := list(named_by(file)):
        return found
    raise refusal(file, "names no plugins; give a plugin (.py) or a scenario that names some")


def _consent(path: Path) -> bool:
    try:
        answer = input(f"Run {shown(path)} with your rights? [y/N] ")
    except EOFError:
        return False
    return answer.strip().lower() in ("y", "yes")


def _printable(source: str) -> str:
    """Source text for a terminal: lines as Python counts them, and control characters, which could hide some,
    as escapes.
    """
    text = source.replace("\r\n", "\n").replace("\r", "\n")
    return "".join(
        one if one.isprintable() or one in "\n\t" else one.encode("unicode_escape").decode() for one in text
    )
