"""Versions of the developers' tools: one each for a clone, the newest for the job that tries those."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))
from newest_requirements import extras, main, unpinned  # noqa: E402

#: Tools whose answer a new release changes; all of the site are.
TOOLS = {"ruff", "mypy", "codespell", "interrogate"}


def test_tools_are_of_one_version():
    wanted = [one for one in extras()["test"] if unpinned(one) in TOOLS]
    assert {unpinned(one) for one in wanted} == TOOLS
    assert not [one for one in (*wanted, *extras()["docs"]) if "==" not in one or "*" in one]


@pytest.mark.parametrize(
    "requirement, name",
    [("mypy==2.4.1", "mypy"), ("numba-cuda[cu12]>=0.30,<0.31", "numba-cuda[cu12]"), ("a.b-c ; x", "a.b-c")],
)
def test_a_requirement_without_its_version(requirement, name):
    assert unpinned(requirement) == name


def test_the_newest_are_of_any_version(capsys):
    assert main(["test", "docs"]) == 0
    listed = capsys.readouterr().out.split()
    assert listed == sorted({unpinned(one) for name in ("test", "docs") for one in extras()[name]})
    assert main(["tests"]) == main([]) == 2
    assert "name extras of pyproject.toml: test, " in capsys.readouterr().err


def test_a_job_tries_the_newest_every_week():
    workflow = ROOT / ".github" / "workflows" / "newest.yml"
    if not workflow.is_file():
        pytest.skip("a source distribution has no workflows")
    read = yaml.safe_load(workflow.read_text(encoding="utf-8"))
    assert read[True]["schedule"] and "workflow_dispatch" in read[True]  # YAML's "on" is true
    done = "\n".join(step.get("run", "") for step in read["jobs"]["newest"]["steps"])
    for words in (
        "newest_requirements.py test docs",
        "ruff check",
        "\nmypy\n",
        "mkdocs build --strict",
        "pytest",
    ):
        assert words in done, words
