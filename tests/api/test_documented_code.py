"""The Python of the documents runs."""

import re
from pathlib import Path

import pytest

from edl6dof.cli.inspection import check_files

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


def files(text):
    """The YAML blocks of a page that begin with the name of a file, by that name."""
    return dict(re.findall(r"(?ms)^```yaml\n# (\S+\.yaml)\n(.*?)^```$", text))


@pytest.mark.parametrize("page", ["getting_started.md", "python.md", "stepping.md"])
def test_every_block_of_a_page_runs(page, tmp_path, monkeypatch, capsys):
    if page == "stepping.md":
        pytest.importorskip("gymnasium")
    monkeypatch.chdir(tmp_path)
    text = (DOCS / page).read_text(encoding="utf-8")
    for name, content in files(text).items():
        Path(name).write_text(content, encoding="utf-8")
        assert check_files([name], ()) == 0, capsys.readouterr().err
    code = program(text)
    assert len(re.findall(r"\S", code)) > 150
    exec(compile(code, str(DOCS / page), "exec"), {"__name__": page})


def test_files_of_a_page_are_found():
    assert files("```yaml\n# a.yaml\nx: 1\n```\n```yaml\ny: 2\n```\n") == {"a.yaml": "x: 1\n"}
    assert list(files((DOCS / "getting_started.md").read_text(encoding="utf-8"))) == [
        "mine.yaml",
        "mine_mc.yaml",
    ]


def test_a_block_that_fails_is_found_by_its_line():
    with pytest.raises(AssertionError) as caught:
        exec(compile(program("text\n```python\nx = 1\nassert x == 2\n```\n"), "page", "exec"), {})
    assert caught.traceback[-1].lineno == 3
