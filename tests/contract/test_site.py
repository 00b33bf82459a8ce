"""The documentation site: navigation, links, command lines and public names, checked without building it."""

from __future__ import annotations

import inspect
import re
import shlex
import sys
from pathlib import Path

import pytest
import typer
import yaml

import edl6dof
from edl6dof.cli import app

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
PAGES = sorted(DOCS.rglob("*.md"))
SOURCES = (ROOT / "README.md", ROOT / "CONTRIBUTING.md", *PAGES)

sys.path.insert(0, str(ROOT / "tools"))
from docs_reference import commands, pages  # noqa: E402
from docs_site import COPIES  # noqa: E402

COMMANDS = dict(commands(typer.main.get_command(app)))
#: Words that stand for a number in a command line.
NUMBERS = {"N": "3", "T": "3", "CASE": "3", "S": "3", "DEG": "3", "M": "3"}


def navigated(entries):
    """Pages of a navigation."""
    for entry in entries:
        for found in [entry] if isinstance(entry, str) else entry.values():
            yield from [found] if isinstance(found, str) else navigated(found)


def test_every_page_is_in_the_navigation_once():
    listed = list(navigated(yaml.safe_load((ROOT / "mkdocs.yml").read_text(encoding="utf-8"))["nav"]))
    there = {
        *(str(page.relative_to(DOCS)) for page in PAGES),
        *pages(),
        *(path for path in COPIES if path.endswith(".md")),
    }
    assert sorted(listed) == sorted(there)


def dangling(page, text):
    """Relative links of a page that lead nowhere in the repository: every reader of the sources can follow
    them, and the site turns them into its own.
    """
    for link in re.findall(r"\]\(([^)\s]+)\)", re.sub(r"```.*?```", "", text, flags=re.DOTALL)):
        path, _, anchor = link.partition("#")
        target = (page.parent / path).resolve() if path else page
        if "://" not in link and not (target.exists() and (not anchor or anchor in anchors(target))):
            yield link


def anchors(page):
    """What the headings of a page can be linked by."""
    headings = re.findall(r"(?m)^#+ (.+)$", page.read_text(encoding="utf-8"))
    plain = (re.sub(r"[^\w\- ]", "", re.sub(r"\]\([^)]*\)", "", heading)) for heading in headings)
    return {heading.lower().strip().replace(" ", "-") for heading in plain}


def test_links_that_lead_nowhere_are_found():
    text = "[a](faq.md) [b](gone.md) [c](faq.md#gone) [d](reference/telemetry.md) [e](../CONTRIBUTING.md)"
    assert list(dangling(DOCS / "index.md", text)) == ["gone.md", "faq.md#gone", "reference/telemetry.md"]


@pytest.mark.parametrize("page", SOURCES, ids=lambda page: str(page.relative_to(ROOT)))
def test_relative_links_lead_somewhere(page):
    assert not list(dangling(page, page.read_text(encoding="utf-8")))


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_links_out_of_docs_lead_to_a_page_of_the_site(page):
    assert not list(leaving(page, page.read_text(encoding="utf-8")))


def leaving(page, text):
    """Relative links of a page to files outside docs/ that the site does not have."""
    for link in re.findall(r"\]\(([^)#\s]+)", re.sub(r"```.*?```", "", text, flags=re.DOTALL)):
        target = (page.parent / link).resolve()
        copied = target.is_relative_to(ROOT) and str(target.relative_to(ROOT)) in COPIES.values()
        if "://" not in link and not target.is_relative_to(DOCS) and not copied:
            yield link


def test_links_that_the_site_cannot_follow_are_found():
    text = "[a](../tools/README.md) [b](../CONTRIBUTING.md#a-release) [c](faq.md) [d](https://example.org)"
    assert list(leaving(DOCS / "index.md", text)) == ["../tools/README.md"]


def command_lines(text):
    """What follows ``edl6dof`` in blocks, quoted in running text, and at the beginning of table cells."""
    text = re.sub(r"\\\n\s*", " ", text)
    for line in re.findall(r"(?m)^(?:    |\$ )?(?:\S*bin/)?edl6dof +(\S.*)$", text):
        yield line
    for line in re.findall(r"`edl6dof +([^`]+)`", text):
        yield " ".join(line.split())


def usage_error(line):
    """Why a command line is none; empty for a good one."""
    words = shlex.split(re.split(r" #| > | >/|; | \| | && ", line)[0], comments=True)
    words = [NUMBERS.get(word, word) for word in words if word not in ("...", "…")]
    if words[:1] == ["--help"] or words[:1] == ["--version"] or words[0] == "COMMAND":
        return ""
    size = 2 if words[0] in ("design", "new") else 1
    command = COMMANDS.get(" ".join(words[:size]))
    if command is None:
        return f"{line}: no such command"
    if size == len(words) and "--" not in line:  # the command itself is meant, not a call of it
        return ""
    try:
        command.make_context(" ".join(words[:size]), words[size:])
    except typer.Exit:
        return ""
    except Exception as error:
        return f"{line}: {getattr(error, 'message', error)}"
    return ""


@pytest.mark.parametrize("page", SOURCES, ids=lambda page: str(page.relative_to(ROOT)))
def test_command_lines_are_understood(page):
    problems = [usage_error(line) for line in command_lines(page.read_text(encoding="utf-8"))]
    assert not [problem for problem in problems if problem]


def test_examples_in_the_help_are_understood():
    shown = [command.epilog.partition("Examples:\n")[2] for command in COMMANDS.values()]
    assert all(shown)
    lines = [line.strip().removeprefix("edl6dof ") for text in shown for line in text.splitlines()]
    assert not [problem for problem in map(usage_error, lines) if problem]


def test_a_bad_command_line_or_link_is_found():
    assert [
        bool(usage_error(line)) for line in ("fly tianwen1 --colour", "flly tianwen1", "fly tianwen1")
    ] == [
        True,
        True,
        False,
    ]
    assert list(command_lines("    edl6dof fly a\n`edl6dof check b`")) == ["fly a", "check b"]
    assert list(dangling(DOCS / "index.md", "[a](nowhere.md) [b](air.md) [c](reference/vehicle.md)")) == [
        "nowhere.md",
        "reference/vehicle.md",
    ]


def test_every_public_name_is_in_the_reference():
    text = (DOCS / "reference" / "api.md").read_text(encoding="utf-8")
    named = re.findall(r"(?m)^::: edl6dof\.(\S+)$", text)
    assert set(edl6dof.__all__) == {name.rpartition(".")[2] for name in named if not name.startswith("gym.")}
    # the site is made from the sources alone, where the package of a name hides the function
    assert not [name for name in named if (ROOT / "edl6dof" / name).is_dir()]


def joint(docstring):
    """Entries of a docstring's ``Args`` that name several parameters: the site knows them for none."""
    listed = re.search(r"(?ms)^Args:\n(.*?)(?=^\S|\Z)", inspect.cleandoc(docstring))
    return re.findall(r"(?m)^    (\w+(?:, ?\w+)+):", listed[1]) if listed else []


def test_public_docstrings_have_an_entry_for_each_parameter():
    public = [getattr(edl6dof, name) for name in edl6dof.__all__]
    members = [member for one in public if inspect.isclass(one) for member in vars(one).values()]
    assert not [found for one in (*public, *members) for found in joint(getattr(one, "__doc__", "") or "")]
    assert joint("Do.\n\nArgs:\n    a, b: both.\n    c: one: x, y: z.\n\nReturns:\n    d, e: f.") == ["a, b"]


def test_generated_pages_have_every_parameter_channel_and_figure():
    from edl6dof.config.parameter_table import rows
    from edl6dof.metrics.figures import FIGURES
    from edl6dof.scenario.schema import Scenario
    from edl6dof.telemetry.channels import CHANNELS

    text = "\n".join(pages().values())
    sections = set(re.findall(r"(?m)^## `(.+)`$", text))
    listed = sum(
        line.startswith("| `")
        for name, page in pages().items()
        for line in page.splitlines()
        if name.removeprefix("reference/") not in ("telemetry.md", "figures.md", "commands.md")
    )
    assert {row.path.rpartition(".")[0] for row in rows(Scenario)} <= {*sections, ""}
    assert listed >= len(rows(Scenario))
    assert all(f"`{channel.name}`" in text for channel in CHANNELS)
    assert all(f"`{figure.name}`" in text for figure in FIGURES)
