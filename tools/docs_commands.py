"""What the documents tell a reader to type: shell commands and Python of their code blocks, and the remarks
above a block on how ``tools/run_docs.py`` runs it.  A remark is an HTML comment, which no reader sees:

    <!-- before: COMMAND -->                a command that runs first: what an earlier page has made
    <!-- not run: WHY -->                   nothing of the block can run by itself
    <!-- not run: `TEXT`: WHY -->           nor can the commands that contain TEXT
    <!-- run with: `TEXT` => `OTHER` -->    less of the same, where all of it takes long, or opens a window
    <!-- or status 1: `TEXT`: WHY -->       the commands that contain TEXT may say that a limit is not kept

A command whose own remark is ``# exit status 1`` has to.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field, replace
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
_REMARK = re.compile(
    r"<!-- (?P<kind>before|not run|run with|or status 1): (?:`(?P<text>[^`]+)`(?:: | => )?)?(?P<rest>.*?) -->"
)


@dataclass(frozen=True)
class Step:
    """A shell command, or the Python of a page: what stands there, and what of it is run."""

    page: str
    line: int
    shown: str
    run: str
    reason: str = ""  #: why it is not run; empty where it is
    python: bool = False
    statuses: tuple[int, ...] = (0,)  #: exit statuses that are right


@dataclass
class Block:
    """A fenced block: language, lines, the line of the first of them, and the remarks above it."""

    language: str
    line: int
    lines: list[str] = field(default_factory=list)
    remarks: list[re.Match[str]] = field(default_factory=list)


def pages() -> list[str]:
    """Every page with commands for its reader, the README first."""
    return ["README.md", *sorted(str(path.relative_to(ROOT)) for path in (ROOT / "docs").rglob("*.md"))]


def blocks(text: str) -> list[Block]:
    """Fenced blocks of a page."""
    found: list[Block] = []
    remarks: list[re.Match[str]] = []
    inside = False
    for number, line in enumerate(text.splitlines(), 1):
        if line.lstrip().startswith("```"):
            inside = not inside
            if inside:
                found.append(Block(line.strip().strip("`"), number + 1, [], remarks))
                remarks = []
        elif inside:
            found[-1].lines.append(line)
        elif remark := _REMARK.fullmatch(line.strip()):
            remarks = [*remarks, remark]
        elif line.strip() and not line.startswith("<!--"):
            remarks = []
    return found


def steps(page: str, text: str) -> list[Step]:
    """Steps of a page in their order; its Python blocks are one program, which runs where the last of them
    stands.
    """
    found: list[Step] = []
    for block in blocks(text):
        if block.language == "sh":
            found += _of_shell(page, block)
        elif block.language == "python":
            found.append(_of_python(page, block))
    whole = [step for step in found if step.python and not step.reason]
    if not whole:
        return found
    lines: list[str] = []
    for step in whole:
        lines += [""] * (step.line - 1 - len(lines)) + step.run.splitlines()
    last = whole[-1]
    program = Step(page, last.line, "the Python of the page", "\n".join(lines), python=True)
    return [program if step is last else step for step in found if step is last or step not in whole]


def _of_shell(page: str, block: Block) -> list[Step]:
    first = [
        Step(page, block.line, remark["rest"], remark["rest"])
        for remark in block.remarks
        if remark["kind"] == "before"
    ]
    return first + [
        _remarked(Step(page, number, command, command, statuses=_told(line)), block)
        for number, line in enumerate(block.lines, block.line)
        if (command := re.sub(r"(^|\s{2,})#.*| # .*", "", line).strip())
    ]


def _told(line: str) -> tuple[int, ...]:
    return (1,) if "# exit status 1" in line else (0,)


def _of_python(page: str, block: Block) -> Step:
    code = "\n".join(block.lines)
    return _remarked(Step(page, block.line, code, code, python=True), block)


def _remarked(step: Step, block: Block) -> Step:
    run, reason, statuses = step.shown, "", step.statuses
    for remark in block.remarks:
        if remark["text"] is not None and remark["text"] not in step.shown:
            continue
        if remark["kind"] == "not run":
            reason = remark["rest"]
        elif remark["kind"] == "run with":
            run = run.replace(remark["text"], remark["rest"].strip("`"))
        elif remark["kind"] == "or status 1":
            statuses = (0, 1)
    return replace(step, run=_without_window(run), reason=reason, statuses=statuses)


def _without_window(command: str) -> str:
    """A replay that would open a window or a browser, as a file."""
    wants_file = any(option in command for option in ("--html", "--screenshot", "--video"))
    if not command.startswith("edl6dof replay ") or wants_file:
        return command
    return f"{command} --html replay.html --force"


def files(text: str) -> dict[str, str]:
    """Blocks of a page that begin with the name of a file, by that name."""
    return dict(re.findall(r"(?ms)^```(?:yaml|python)\n# (\S+\.(?:yaml|py))\n(.*?)^```$", text))
