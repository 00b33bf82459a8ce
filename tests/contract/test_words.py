"""The documents are in plain technical English: words that they avoid, and counts that can only fall."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
PAGES = (
    *(ROOT / name for name in ("README.md", "CONTRIBUTING.md", "tools/README.md")),
    *sorted(DOCS.rglob("*.md")),
)

#: Words of everyday speech that stand in the place of a term, or that a reader has to read twice.
AVOIDED = re.compile(
    r"\b(?:told|tells?|telling|untold|besides?|befell|befalls?|likewise|anew|goes on|go on|going on|"
    r"way beyond|way right|nobody|hold against|held against|is sound|healthy ones|"
    r"(?:requirements?|limits?) (?:is |are )?(?:kept|broken)|keeps? (?:a|the|every|all) limits?)\b",
    re.IGNORECASE,
)
#: A sentence with an inverted or missing subject: "What ..." and "Whether ..." that ask nothing.
INVERTED = re.compile(r"(?:^|[.:|] |\*\*)(?:What|Whether) [^.?|]*(?:[.|]|$)", re.MULTILINE)


def prose(text: str) -> str:
    """Text of a page without results that programs print, quoted code, remarks and addresses."""
    text = re.sub(r"```text\n.*?```", "", text, flags=re.DOTALL)
    return re.sub(r"<!--.*?-->|`[^`\n]+`|\]\([^)]*\)", "", text, flags=re.DOTALL)


def avoided(text: str) -> list[str]:
    """Words and sentences of a page that plain technical English avoids."""
    return [found[0].strip() for pattern in (AVOIDED, INVERTED) for found in pattern.finditer(prose(text))]


def beginnings() -> list[str]:
    """Docstrings of the package that begin with "What" or "Whether"."""
    found = []
    for file in sorted((ROOT / "edl6dof").rglob("*.py")):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef)):
                text = ast.get_docstring(node) or ""
                if re.match(r"(?:What|Whether)\b", text):
                    found.append(f"{file.relative_to(ROOT)}: {text.splitlines()[0]}")
    return found


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_pages_are_in_plain_technical_english(page):
    assert avoided(page.read_text(encoding="utf-8")) == []


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_table_cells_are_short(page):
    rows = re.findall(r"(?m)^\|.*\|$", page.read_text(encoding="utf-8"))
    assert not [cell for row in rows for cell in row.split("|") if len(cell.split()) > 40]


def test_no_docstring_begins_with_what_or_whether():
    assert beginnings() == []


def test_avoided_words_are_found():
    page = "Only the sensors tell.\n\n| What a model is | it |\n\n**What is it?** A test. Whether it fits.\n"
    assert avoided(page) == ["tell", "| What a model is |", ". Whether it fits."]
    assert avoided("```text\nbeside\n```\n`beside`\n<!-- beside -->\n") == []
    assert avoided("```sh\nedl6dof fly tianwen1  # beside\n```\n") == ["beside"]


def test_the_readme_names_every_room_of_the_package():
    text = (ROOT / "README.md").read_text(encoding="utf-8").partition("## Where things are")[2]
    named = set(re.findall(r"(?m)^\| `edl6dof/(\w+)` \| .+ \|$", text))
    rooms = {
        path.name for path in (ROOT / "edl6dof").iterdir() if path.is_dir() and path.name != "__pycache__"
    }
    assert named == rooms


def test_the_glossary_has_its_size_and_every_source():
    text = (DOCS / "glossary.md").read_text(encoding="utf-8")
    terms, sources = text.partition("## Sources")[::2]
    rows = [row.strip("| ").split(" | ") for row in re.findall(r"(?m)^\| (?!term).*\|$", terms)]
    entries = [row for row in rows if not row[0].startswith("-")]
    assert 80 <= len(entries) <= 120
    assert len({row[0] for row in entries}) == len(entries)
    for used in {row[3].rstrip(" |") for row in entries if len(row) > 3 and row[3].strip()}:
        assert used.split()[0].rstrip(",") in sources, used
