"""Each command that a document tells to type is run by ``tools/run_docs.py``, or says why not; what is
run with fewer flights still is a command.
"""

from __future__ import annotations

import re
import shlex
import sys
from pathlib import Path

import pytest
from in_process import PROGRAM

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tools"))
from docs_commands import ROOT, blocks, pages, steps

#: What begins a line that is typed.
TYPED = re.compile(r"(?:\$ )?(?:edl6dof|python3?|pip|mkdocs|dask|cc|\.venv/bin/\S+) \S")


def text_of(page):
    return (ROOT / page).read_text(encoding="utf-8")


def unseen(text):
    """Lines that are typed, where the tool does not look: in a block of no language, or indented."""
    found = [line for block in blocks(text) if block.language == "" for line in block.lines]
    fenced = {number for block in blocks(text) for number in range(block.line, block.line + len(block.lines))}
    found += [
        line[4:]
        for number, line in enumerate(text.splitlines(), 1)
        if number not in fenced and line.startswith("    ")
    ]
    return [line for line in found if TYPED.match(line)]


def stale(text):
    """Remarks that are of no command: their text stands in none of their block."""
    return [
        remark[0]
        for block in blocks(text)
        for remark in block.remarks
        if block.language not in ("sh", "python")
        or not remark["rest"]
        or remark["text"]
        and not any(remark["text"] in re.sub(r"\s+#.*", "", line) for line in block.lines)
    ]


def parsed(command):
    """Parse a command line as the program does, without doing what it says; its error is raised."""
    words = shlex.split(re.sub(r" > \S+$", "", command))[1:]
    group, context = PROGRAM, PROGRAM.make_context("edl6dof", list(words))
    while hasattr(group, "commands"):
        name, words = words[0], words[1:]
        group = group.commands[name]
        context = group.make_context(name, list(words), parent=context)
    return context


@pytest.mark.parametrize("page", pages())
def test_every_command_of_a_page_is_run_or_says_why_not(page):
    text = text_of(page)
    assert unseen(text) == [] and stale(text) == []
    for step in steps(page, text):
        if not step.python and step.run.startswith("edl6dof "):
            parsed(step.run)
        else:
            assert step.python or step.reason or TYPED.match(step.run), step.run


def begun_twice(page, text):
    """Folders in which a page begins two campaigns; the second would be refused."""
    begun = [
        str(found.params["out"] or (found.info_name, found.params["scenario"]))
        for step in steps(page, text)
        if not step.python and step.shown.startswith(("edl6dof campaign", "edl6dof faults"))
        if not (found := parsed(step.shown)).params["resume"]
    ]
    return [folder for folder in begun if begun.count(folder) > 1]


@pytest.mark.parametrize("page", pages())
def test_no_page_begins_two_campaigns_in_a_folder(page):
    assert begun_twice(page, text_of(page)) == []


def test_there_is_something_to_run():
    found = [step for page in pages() for step in steps(page, text_of(page))]
    run = [step for step in found if not step.reason]
    assert len(run) > 150 and len(run) > 0.85 * len(found)


PAGE = """
<!-- before: edl6dof fly msl -->
<!-- run with: `-n 1000` => `-n 4` -->
<!-- not run: `dask`: needs a cluster -->
<!-- or status 1: `faults`: not all land -->
```sh
edl6dof campaign a_mc -n 1000        # many
edl6dof campaign a_mc --engine dask
edl6dof faults a --set 'x=[1]'  # '#' begins a remark
edl6dof replay runs/a
edl6dof fly genesis  # exit status 1: as flown
```

<!-- not run: no program -->
```python
x = y
```

```python
a = 1
```
then
```python
b = a
```
"""


def test_remarks_say_what_is_run():
    found = steps("p.md", PAGE)
    assert [(step.run, step.reason, step.statuses) for step in found if not step.python] == [
        ("edl6dof fly msl", "", (0,)),
        ("edl6dof campaign a_mc -n 4", "", (0,)),
        ("edl6dof campaign a_mc --engine dask", "needs a cluster", (0,)),
        ("edl6dof faults a --set 'x=[1]'", "", (0, 1)),
        ("edl6dof replay runs/a --html replay.html --force", "", (0,)),
        ("edl6dof fly genesis", "", (1,)),
    ]
    assert [(step.line, step.run.strip().split("\n")[0], step.reason) for step in found if step.python] == [
        (16, "x = y", "no program"),
        (24, "a = 1", ""),
    ]
    assert found[-1].run.splitlines()[23] == "b = a", "an error has its line"


def test_what_the_tool_does_not_see_is_found():
    assert unseen("x\n\n    edl6dof fly tianwen1\n") == ["edl6dof fly tianwen1"]
    assert unseen("```\npython tools/x.py\n```\n") == ["python tools/x.py"]
    assert unseen("```sh\nedl6dof fly a\n```\n") == []
    assert stale("<!-- not run: `msl`: slow -->\n```sh\nedl6dof fly a\n```\n")
    assert (
        begun_twice("p.md", "```sh\nedl6dof campaign a\nedl6dof campaign a -n 4\n```\n")
        == ["('campaign', 'a')"] * 2
    )
    with pytest.raises(Exception, match="--colour"):
        parsed("edl6dof fly a --colour")
