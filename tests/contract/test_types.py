"""Types, lint rules, layout, spelling and docstrings of the sources, asked of the developers' tools as
pyproject.toml sets them.
"""

import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest
from source_rules import breaches, modules, untyped

ROOT = Path(__file__).parents[2]


def asked(*words: str) -> subprocess.CompletedProcess[str]:
    """A tool asked in the root of the sources."""
    if find_spec(words[0]) is None:
        pytest.skip(f"{words[0]} is not installed; the extra named test brings it")
    return subprocess.run([sys.executable, "-m", *words], cwd=ROOT, capture_output=True, text=True)


@pytest.mark.parametrize(
    "words",
    [
        ("mypy",),
        ("ruff", "check", "."),
        ("ruff", "format", "--check", "."),
        ("codespell_lib",),
        ("interrogate", "edl6dof"),
    ],
    ids=" ".join,
)
def test_the_sources_are_clean(words):
    answer = asked(*words)
    assert answer.returncode == 0, answer.stdout + answer.stderr


#: Mistakes, and what each of them is called.
WRONG_TYPES = {
    "y: int = 'one'": "assignment",
    "offset('x', 3)": "arg-type",
    "np.zeross(3)": "attr-defined",
    "_: float = a.shape": "assignment",
}


def test_a_wrong_type_is_found(tmp_path):
    """In the use of our own functions and of numpy's arrays too, some of whose types are not read."""
    planted = tmp_path / "planted.py"
    imports = "import numpy as np\nfrom edl6dof.records import offset\n"
    planted.write_text(f"{imports}def f(a: np.ndarray) -> None:\n    " + "\n    ".join(WRONG_TYPES))
    answer = asked("mypy", str(planted))
    assert answer.returncode == 1
    for line, code in enumerate(WRONG_TYPES.values(), start=4):
        found = [said for said in answer.stdout.splitlines() if f"planted.py:{line}: error" in said]
        assert found and all(f"[{code}]" in said for said in found), answer.stdout + answer.stderr


def test_a_misspelt_word_and_a_missing_docstring_are_found(tmp_path):
    planted = tmp_path / "planted.py"
    planted.write_text("def f():  # recieved\n    return 1\n")  # codespell:ignore recieved
    spelt = asked("codespell_lib", str(planted))
    assert spelt.returncode != 0 and "received" in spelt.stdout, spelt.stdout + spelt.stderr
    assert asked("interrogate", "--config", "pyproject.toml", str(planted)).returncode != 0


def test_every_function_but_a_kernel_names_its_types():
    assert breaches(lambda _, source: untyped(source), modules()) == {}


@pytest.mark.parametrize(
    "planted",
    ["def f(x) -> int: ...", "def f(x: int): ...", "def f(*x) -> int: ...", "def f(*, x) -> int: ..."],
)
def test_planted_functions_without_types_are_found(planted):
    assert untyped(planted)


def test_a_kernel_and_an_object_itself_need_no_types():
    assert not untyped("@kernel\ndef f(x): ...\n\nclass A:\n    def __init__(self, x: int): ...")
