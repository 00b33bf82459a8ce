"""The notebooks of the documents run, with few flights, and each ends in a figure."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tools"))
from docs_notebooks import FOLDER, INSTALL, NAMES, cells, notebook, page, source

#: What a notebook takes much of, and how little will do.
FEW = {"CASES": "6", "FLIGHTS": "3", "STEPS, EPISODES": "64, 1"}

#: Those that call what pages of the documents call, too, which run.
ALIKE = ("break_a_thruster", "disperse", "train")


def short(name):
    """A notebook with few flights."""
    return re.sub(
        rf"(?m)^({'|'.join(FEW)}) = [\d_, ]+$", lambda found: f"{found[1]} = {FEW[found[1]]}", source(name)
    )


@pytest.fixture
def drawn(monkeypatch, tmp_path):
    """Figures that are shown, in an empty folder."""
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    from matplotlib import pyplot

    monkeypatch.chdir(tmp_path)
    figures = []
    monkeypatch.setattr(pyplot, "show", lambda: figures.append(pyplot.gcf()))
    yield figures
    pyplot.close("all")


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=pytest.mark.long if name in ALIKE else ())
        for name in NAMES
        if name != "write_a_law"
    ],
)
def test_notebook_runs_and_ends_in_a_figure(name, drawn, monkeypatch):
    if name == "train":
        pytest.importorskip("gymnasium")
        monkeypatch.setitem(sys.modules, "stable_baselines3", None)  # the suite trains nothing
    exec(compile(short(name), str(FOLDER / f"{name}.py"), "exec"), {"__name__": name})
    (figure,) = drawn
    assert all(axes.has_data() and axes.get_xlabel() + axes.get_ylabel() for axes in figure.axes)


@pytest.mark.long
def test_law_of_the_notebook_flies(tmp_path):
    """In a process of its own: a plugin is there before what it joins.

    The example law of the plugin tests flies in every run.
    """
    code = f"{short('write_a_law')}\nassert mine.landed and len(top.lines) == len(bottom.lines) * 2 == 4"
    calm = os.environ | {"MPLBACKEND": "agg"}
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, env=calm
    )
    assert done.returncode == 0, done.stderr
    assert re.search(r"mine +landed", done.stdout)


@pytest.mark.parametrize("name", NAMES)
def test_notebook_is_the_same_as_page_and_for_jupyter(name):
    body = cells(source(name))
    assert body[0][0] == "markdown" and body[0][1].startswith("# ") and body[-1][0] == "code"
    made = json.loads(notebook(name))["cells"]
    shown = [(cell["cell_type"], "".join(cell["source"])) for cell in made]
    assert shown == [body[0], ("code", INSTALL), *body[1:]]
    assert all(text in page(name) for _, text in body)
    assert (FOLDER / f"{name}.webp").stat().st_size < 150_000
