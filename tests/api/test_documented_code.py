"""The Python of the documents runs."""

import re
from pathlib import Path

import pytest

DOCS = Path(__file__).resolve().parents[2] / "docs"


def program(text):
    """The Python blocks of a page, with as many empty lines before as there are, so that an error has its
    line.
    """
    lines, inside = [], False
    for line in text.splitlines():
        inside = inside and not line.startswith("```")
        lines.append(line if inside else "")
        inside = inside or line == "```python"
    return "\n".join(lines)


@pytest.mark.parametrize("page", ["python.md", "stepping.md"])
def test_every_block_of_a_page_runs(page, tmp_path, monkeypatch, capsys):
    if page == "stepping.md":
        pytest.importorskip("gymnasium")
    monkeypatch.chdir(tmp_path)
    code = program((DOCS / page).read_text(encoding="utf-8"))
    assert len(re.findall(r"\S", code)) > 500
    exec(compile(code, str(DOCS / page), "exec"), {"__name__": page})


def test_a_block_that_fails_is_found_by_its_line():
    with pytest.raises(AssertionError) as caught:
        exec(compile(program("text\n```python\nx = 1\nassert x == 2\n```\n"), "page", "exec"), {})
    assert caught.traceback[-1].lineno == 3
