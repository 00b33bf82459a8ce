"""Notebooks of the documentation: docs/notebooks/NAME.py, text in cells (``# %%``), as pages of the site and
as .ipynb.

    python tools/docs_notebooks.py FOLDER            writes them there as .ipynb
    python tools/docs_notebooks.py --picture NAME    runs notebook NAME and draws its figure, NAME.png

The pages show the picture that is kept (``tools/pictures.py``), so that building the site flies nothing.
"""

from __future__ import annotations

import argparse
import json
import os
import re
from pathlib import Path
from tempfile import TemporaryDirectory

FOLDER = Path(__file__).resolve().parents[1] / "docs" / "notebooks"
#: In the order in which they are read.
NAMES = ("first_flight", "break_a_thruster", "write_a_law", "disperse", "train", "validate")

#: First cell of an .ipynb, for a hosted notebook (Colab, Binder) without the package.
INSTALL = """\
# On a hosted notebook, upload a wheel of edl6dof first; python -m build --wheel builds one.
try:
    import edl6dof
except ModuleNotFoundError:
    %pip install -q edl6dof-*.whl"""

_CELL = re.compile(r"(?m)^# %%(?P<markdown> \[markdown\])?\n")


def source(name: str) -> str:
    """Text of a notebook."""
    return (FOLDER / f"{name}.py").read_text(encoding="utf-8")


def cells(text: str) -> list[tuple[str, str]]:
    """Cells of a notebook: ``markdown`` or ``code``, and what stands in it."""
    marks = [*_CELL.finditer(text)]
    ends = [*(mark.start() for mark in marks[1:]), len(text)]
    found = []
    for mark, end in zip(marks, ends, strict=True):
        body = text[mark.end() : end].strip()
        if mark["markdown"]:
            found.append(("markdown", re.sub(r"(?m)^# ?", "", body)))
        else:
            found.append(("code", body))
    return found


def page(name: str) -> str:
    """A notebook as a page of the site."""
    shown = [body if kind == "markdown" else f"```python\n{body}\n```" for kind, body in cells(source(name))]
    shown.insert(1, f"As a notebook: [{name}.ipynb]({name}.ipynb); as a program: [{name}.py]({name}.py).")
    return "\n\n".join([*shown, f"![Figure of the last cell]({name}.webp)"]) + "\n"


def notebook(name: str) -> str:
    """A notebook as Jupyter reads it, without outputs; after the title comes the cell that installs."""
    made = []
    title, *others = cells(source(name))
    for number, (kind, body) in enumerate((title, ("code", INSTALL), *others)):
        cell = {
            "cell_type": kind,
            "id": f"{name}-{number}",
            "metadata": {},
            "source": body.splitlines(keepends=True),
        }
        made.append(cell | ({"execution_count": None, "outputs": []} if kind == "code" else {}))
    kernel = {"display_name": "Python 3", "language": "python", "name": "python3"}
    whole = {"cells": made, "metadata": {"kernelspec": kernel}, "nbformat": 4, "nbformat_minor": 5}
    return json.dumps(whole, indent=1, ensure_ascii=False) + "\n"


def pages() -> dict[str, str]:
    """Path inside the site, and Markdown, of every notebook."""
    return {f"notebooks/{name}.md": page(name) for name in NAMES}


def draw(name: str) -> None:
    """Run a notebook in an empty folder, and draw its figure here."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    here = Path.cwd()

    def keep() -> None:
        pyplot.savefig(here / f"{name}.png", dpi=130)
        pyplot.close("all")

    pyplot.show = keep
    with TemporaryDirectory() as folder:
        os.chdir(folder)
        exec(compile(source(name), f"{name}.py", "exec"), {"__name__": name})
        os.chdir(here)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("folder", nargs="?", type=Path)
    parser.add_argument("--picture", metavar="NAME", choices=NAMES)
    options = parser.parse_args()
    if options.picture:
        draw(options.picture)
    if options.folder:
        options.folder.mkdir(parents=True, exist_ok=True)
        for name in NAMES:
            (options.folder / f"{name}.ipynb").write_text(notebook(name), encoding="utf-8")
            print(options.folder / f"{name}.ipynb")


if __name__ == "__main__":
    main()
