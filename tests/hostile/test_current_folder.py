"""A folder that came from somebody else is the current one: nothing in it is taken for a module, or for
settings of a library that this program uses.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from command import ROOT
from in_process import called

from edl6dof import jit
from edl6dof.child import python

#: Names that somebody who starts Python in this folder would import sooner or later.
MODULES = ("numba", "numpy", "yaml", "typing", "inspect", "shlex", "pydantic", "typer", "llvmlite")


@pytest.fixture
def prepared(tmp_path) -> Path:
    """A folder with modules that leave a trace when they are imported."""
    for name in MODULES:
        (tmp_path / f"{name}.py").write_text("open('RAN', 'a').write(__name__)\n")
    return tmp_path


def here(command: list[str], folder: Path) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, timeout=300)


def test_module_of_the_current_folder_is_not_imported(prepared):
    done = here([sys.executable, "-m", "edl6dof", "check", "tianwen1"], prepared)
    assert done.returncode == 0, done.stderr
    assert not (prepared / "RAN").exists()


def test_child_processes_find_what_this_process_finds_and_nothing_else(prepared):
    done = here(python("import numba, sys; print(numba.__file__, *sys.argv[1:])", "a:b", "c"), prepared)
    assert done.returncode == 0, done.stderr
    assert "site-packages" in done.stdout and done.stdout.endswith("a:b c\n")
    assert not (prepared / "RAN").exists()


def test_settings_of_numba_in_the_current_folder_have_no_say(tmp_path):
    """They could name the folder whose machine code is run."""
    (tmp_path / ".numba_config.yaml").write_text("cache_dir: theirs\nopt: 0\n")
    shown = "from edl6dof.jit import SETTINGS; print(repr(SETTINGS.CACHE_DIR), SETTINGS.OPT)"
    done = here([sys.executable, "-c", f"import numba; {shown}"], tmp_path)
    assert done.stdout == f"{jit.SETTINGS.CACHE_DIR!r} {jit.SETTINGS.OPT}\n", done.stderr


@pytest.mark.parametrize("content", ["cache_dir: theirs\n", "a: [\n"])
def test_command_refuses_a_folder_with_settings_of_numba(content, tmp_path):
    (tmp_path / ".numba_config.yaml").write_text(content)
    done = called("version", cwd=tmp_path)
    assert done.returncode == 2 and ".numba_config.yaml: " in done.stderr


def test_settings_of_matplotlib_in_the_current_folder_have_no_say(tmp_path):
    (tmp_path / "matplotlibrc").write_text("axes.facecolor: red\nlines.linewidth: 30\nfont.serif: theirs\n")
    code = (
        "from pathlib import Path; from edl6dof.report.figure import Figure, Panel; import matplotlib; "
        "from edl6dof.report.matplotlib_figure import own_style\n"
        "print(matplotlib.rcParams['axes.facecolor'])\n"
        "with own_style(): print(matplotlib.rcParams['axes.facecolor'], matplotlib.rcParams['font.size'])"
    )
    done = here([sys.executable, "-c", code], tmp_path)
    assert done.stdout.split() == ["red", "white", "8.0"], done.stderr
