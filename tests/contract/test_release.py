"""A release says the same everywhere: version, licence, requirements, and what the source distribution
holds.
"""

from __future__ import annotations

import re
import subprocess
import tomllib
from pathlib import Path

import pytest
import yaml

import edl6dof

ROOT = Path(__file__).resolve().parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
RECIPE = (ROOT / "conda" / "recipe" / "meta.yaml").read_text(encoding="utf-8")


def bare(requirement):
    """A requirement without spaces and marks, as pip and conda write it; conda takes
    ``==0.41.*`` for 0.41.0.
    """
    return re.sub(r"==(?=[\d.]+\*$)", "", requirement.replace(" ", "").lower())


def test_version_is_one():
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    recipe = re.search(r'set version = "(.+?)"', RECIPE)
    assert {citation["version"], recipe and recipe[1]} == {edl6dof.__version__}
    assert citation["license"] == PROJECT["project"]["license"]


def test_conda_recipe_requires_what_the_project_requires():
    run = RECIPE.partition("  run:\n")[2].partition("\n\n")[0]
    wanted = {bare(text) for text in PROJECT["project"]["dependencies"]}
    wanted.add("python" + PROJECT["project"]["requires-python"])
    assert {bare(line.removeprefix("    - ")) for line in run.splitlines()} == wanted
    assert "==" not in run


def test_source_distribution_has_all_that_is_tracked_but_the_repositorys_own():
    try:
        done = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True)
    except (OSError, subprocess.CalledProcessError):
        pytest.skip("not a repository")
    included = PROJECT["tool"]["hatch"]["build"]["targets"]["sdist"]["include"]
    at_top = {"/" + name.partition("/")[0] for name in done.stdout.splitlines()}
    own = {"/.github", "/.ci", "/.gitignore", "/pyproject.toml"}  # hatchling adds the last two itself
    assert at_top - own == set(included)
