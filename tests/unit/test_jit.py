"""The compile cache: the trap that numba leaves open, sprung in fresh processes.

A small package is written to disk with the real ``jit.py`` in it; subprocesses compile and run it, edit it
and run it again. What the machine code returns, and numba's own count of cache hits, say whether the cache
was used and whether it was stale.
"""

import gc
import time
from pathlib import Path

import numba
import pytest
import small_programs

from edl6dof import jit
from edl6dof.code_files import say_once
from edl6dof.source_stamp import SourceTree, parsed

HELPER = "from probe.jit import kernel\n@kernel\ndef factor():\n    return {}\n"
CALLER = "from probe.jit import kernel\n{}\n@kernel\ndef area(x):\n    return {}() * x\n"
CALL = """
import sys
sys.path.insert(0, {root!r})
from probe.caller import area
print(area(2.0), sum(area.stats.cache_hits.values()), area.stats.cache_path)
"""


@pytest.fixture
def package(tmp_path):
    """A package ``probe`` with the real jit.py, a helper (factor 3) and folders for more."""
    (tmp_path / "probe" / "deep").mkdir(parents=True)
    write(tmp_path, "__init__.py", "")
    write(tmp_path, "deep/__init__.py", "")
    write(tmp_path, "jit.py", Path(jit.__file__).read_text())
    write(tmp_path, "deep/helper.py", HELPER.format("3.0"))
    return tmp_path


def write(root, name, text):
    (root / "probe" / name).write_text(text)


def call(root, **environment):
    """Run the caller kernel in a fresh process: (result, cache hits, cache folder)."""
    result, hits, folder = run(CALL.format(root=str(root)), **environment).split()
    return float(result), int(hits), Path(folder)


def run(program, **environment):
    """What a program prints that runs in a process of its own."""
    ran = small_programs.run(program, cwd=Path.cwd(), **environment)
    assert ran.returncode == 0, ran.stderr
    return ran.stdout


def reached(root, name):
    """Names of the files whose edits recompile the kernels of file ``name``."""
    package = root / "probe"
    found = SourceTree(package, root / "sources.json").reached(str(package / name))
    return {str(Path(file).relative_to(package)) for file in found}


def test_an_edited_helper_of_a_helper_recompiles_its_callers_and_nothing_else_does(package):
    write(package, "middle.py", "from probe.jit import kernel\nfrom probe.deep.helper import factor\n"
          "@kernel\ndef twice():\n    return 2.0 * factor()\n")  # fmt: skip
    write(package, "caller.py", CALLER.format("from probe.middle import twice", "twice"))
    write(package, "stranger.py", "x = 1\n")
    assert call(package)[:2] == (12.0, 0)
    assert call(package)[:2] == (12.0, 1)
    write(package, "stranger.py", "x = 2\n")
    # touched, not changed: content counts, not the date
    write(package, "deep/helper.py", HELPER.format("3.0"))
    assert call(package)[:2] == (12.0, 1)
    # two imports away, same length, within the clock's resolution
    write(package, "deep/helper.py", HELPER.format("5.0"))
    assert call(package)[:2] == (20.0, 0)


SPELLINGS = {
    "plain": "from probe.deep.helper import factor",
    "parentheses": "from probe.deep.helper import (\n    factor,\n    other,  # (why)\n)",
    "module of a package": "from probe.deep import helper",
    "module after others": "from probe.deep import (\n    nothing,  # a comment )\n    helper as h,\n)",
    "whole name": "import probe.deep.helper",
    "second of two": "import math, probe.deep.helper as h",
    "continued line": "from probe.deep \\\n    import nothing, \\\n    helper",
    "star": "from probe.deep.helper import *",
    "inside a function": "def f():\n    from probe.deep.helper import factor",
    "relative": "from .deep.helper import factor",
    "relative package": "from .deep import helper",
    "relative to here": "from . import deep, other",
    "tight": "from probe.deep import(helper)",
}


@pytest.mark.parametrize("spelling", SPELLINGS)
def test_every_spelling_of_an_import_is_seen(package, spelling):
    write(package, "deep/__init__.py", "from . import helper\n" if spelling == "relative to here" else "")
    write(package, "caller.py", SPELLINGS[spelling] + "\n")
    assert "deep/helper.py" in reached(package, "caller.py")


def test_files_that_are_not_imported_are_not_seen(package):
    write(
        package,
        "caller.py",
        (
            "import math\nfrom probed.deep import helper\n# from "
            "probe.deep import helper\nfrom .. import jit\n"
        ),
    )
    assert reached(package, "caller.py") == {"caller.py"}


EDITED = """
import sys, time
sys.path.insert(0, {root!r})
from pathlib import Path
from probe.caller import area
helper = Path({root!r}, "probe", "deep", "helper.py")
helper.write_text(helper.read_text().replace("3.0", "7.0"))
print(area(2.0))
"""


def test_code_of_a_source_that_was_edited_after_it_was_imported_is_not_kept(package):
    """Its stamp would be that of the new source, and the next process would run the old one."""
    write(package, "caller.py", CALLER.format("from probe.deep.helper import factor", "factor"))
    assert run(EDITED.format(root=str(package))) == "6.0\n", "what was imported"
    assert call(package)[:2] == (14.0, 0)


def test_a_source_dated_in_the_future_is_said_to_be_compiled_each_time(package, capsys, monkeypatch):
    """Of a machine whose clock is fast, or was set back since."""
    say_once.cache_clear()
    monkeypatch.setattr(jit.TREE, "changed_at", lambda paths: time.time() + 3600.0)
    assert jit._edited_since_start(str(package / "caller.py"))
    assert "dated in the future" in capsys.readouterr().err


def test_an_import_cycle_ends_and_both_files_count(package):
    write(package, "a.py", "from probe import b\n")
    write(package, "b.py", "import probe.a\nfrom probe.deep.helper import factor\n")
    assert reached(package, "a.py") == reached(package, "b.py")
    assert {"a.py", "b.py", "deep/helper.py"} <= reached(package, "a.py")


def test_a_parenthesised_submodule_import_springs_the_trap_in_a_running_kernel(package):
    write(
        package,
        "caller.py",
        CALLER.format("from probe.deep import (\n    helper as h,\n)\nfactor = h.factor", "factor"),
    )
    assert call(package)[:2] == (6.0, 0)
    write(package, "deep/helper.py", HELPER.format("7.0"))
    assert call(package)[:2] == (14.0, 0)


KERNEL = """'''{doc}'''
from edl6dof.config.base import Params, param

class P(Params):
    '''{doc}'''
    mass_kg: float = param({default}, "{doc}", gt=0)

def check(x):
    # {doc}
    if x < 0:
        raise ValueError(f"{doc} {{x}}")

FIELDS = [("{field}", "f8")]
"""
AS_IT_WAS = {"doc": "the mass", "default": "1.0", "field": "mass"}


@pytest.mark.parametrize(
    "edit, recompiles",
    [({"doc": "what it weighs,\n in kg"}, False), ({"default": "2.0"}, True), ({"field": "weight"}, True)],
)
def test_words_recompile_nothing_and_statements_do(edit, recompiles):
    if "doc" in edit:
        edit = {"doc": edit["doc"].replace("\n", "")}
    before, after = (parsed(KERNEL.format(**AS_IT_WAS | changed), []) for changed in ({}, edit))
    assert (before.statements != after.statements) == recompiles


def test_a_comment_above_a_kernel_recompiles_nothing_though_its_line_is_another(package):
    write(package, "caller.py", CALLER.format("from probe.deep.helper import factor", "factor"))
    assert call(package)[:2] == (6.0, 0)
    moved = "# a word\n" + CALLER.format("from probe.deep.helper import factor", "factor")
    write(package, "caller.py", moved)
    assert call(package)[:2] == (6.0, 1)


def test_what_was_read_of_a_source_is_remembered_and_never_needed(package):
    memory, file = package / "sources.json", str(package / "probe" / "jit.py")
    tree = SourceTree(package / "probe", memory)
    stamp = tree.stamp([file])
    tree._remember()
    assert memory.stat().st_size > 100
    assert SourceTree(package / "probe", memory).stamp([file]) == stamp
    for damage in (b"", b"{", b"[1, 2]", b'{"a": 3}'):
        memory.write_bytes(damage)
        assert SourceTree(package / "probe", memory).stamp([file]) == stamp


def test_a_package_that_cannot_be_written_caches_for_the_user(package, tmp_path):
    write(package, "caller.py", CALLER.format("from probe.deep.helper import factor", "factor"))
    for folder in ("probe", "probe/deep"):
        (package / folder / "__pycache__").write_text("")  # a file in its place stops even root
    home = {"XDG_CACHE_HOME": str(tmp_path / "user")}
    result, hits, folder = call(package, **home)
    assert (result, hits) == (6.0, 0) and folder.is_relative_to(tmp_path / "user")
    assert call(package, **home)[:2] == (6.0, 1)
    write(package, "deep/helper.py", HELPER.format("5.0"))
    assert call(package, **home)[:2] == (10.0, 0)


def test_a_chosen_cache_folder_is_used(package, tmp_path):
    write(package, "caller.py", CALLER.format("from probe.deep.helper import factor", "factor"))
    result, _, folder = call(package, NUMBA_CACHE_DIR=str(tmp_path / "chosen"))
    assert result == 6.0 and folder.is_relative_to(tmp_path / "chosen")


def test_the_decorator_leaves_other_users_of_numba_alone():
    before = numba.config.CACHE_LOCATOR_CLASSES

    def nothing():
        return 0

    jit.kernel(nothing)
    assert before == numba.config.CACHE_LOCATOR_CLASSES


def test_division_by_zero_follows_numpy_and_rounding_is_not_relaxed():
    @jit.kernel
    def divide(a, b):
        return a / b

    @jit.kernel
    def compensated(a, b):
        return (a + b) - a - b

    assert divide(1.0, 0.0) == float("inf")
    assert compensated(1.0, 1e-17) == -1e-17  # fast-math would make it 0


def test_a_kernel_is_compiled_once_for_all_literals_and_the_collector_is_as_before():
    @jit.kernel
    def power(x, n):
        return x**n

    @jit.kernel
    def both(x):
        return power(x, 2) + power(x, n=3)

    before = gc.get_threshold()
    assert both(2.0) == 12.0
    assert len(power.signatures) == 1
    assert gc.get_threshold() == before
