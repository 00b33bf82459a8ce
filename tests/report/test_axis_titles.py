"""One way of writing units for every figure: in brackets behind the name of the axis."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

import edl6dof

PACKAGE = Path(edl6dof.__file__).parent
DRAW = sorted(
    path
    for path in (*PACKAGE.rglob("*.py"), *(PACKAGE.parent / "tools").glob("*.py"))
    if "report.figure import" in path.read_text(encoding="utf-8")
)
LOOSE = re.compile(r", (s|ms|m|km|N|kN|Nm|N m|kg|deg|deg/s|m/s|km/s|m/s²|Pa|kPa|g|W/cm²|%|1)$")


def loose_units(source: str) -> list[str]:
    """Words of calls that end in a unit behind a comma."""
    words = [
        node.value
        for call in ast.walk(ast.parse(source))
        if isinstance(call, ast.Call)
        for node in call.args
        if isinstance(node, ast.Constant) and isinstance(node.value, str)
    ]
    return [text for text in words if LOOSE.search(text)]


def test_a_unit_behind_a_comma_is_found():
    assert loose_units('Axis("miss, km")') == ["miss, km"] and loose_units('Axis("miss (km)")') == []


@pytest.mark.parametrize("path", DRAW, ids=lambda path: path.stem)
def test_units_stand_in_brackets(path):
    assert loose_units(path.read_text(encoding="utf-8")) == []


def test_every_picture_is_drawn_by_one_path():
    """Reports use matplotlib and plotly through two modules of their own.  Studies,
    which use the simulator as a user does, draw with matplotlib in one module, and so do the tools that run
    notebooks and draw the conventions.  Titles of films take its fonts.
    """
    everywhere = (*PACKAGE.rglob("*.py"), *(PACKAGE.parent / "tools").glob("*.py"))
    found = {
        path.name
        for path in everywhere
        if re.search(r"^\s*(import|from) (matplotlib|plotly)", path.read_text(encoding="utf-8"), re.MULTILINE)
    }
    assert found == {
        "matplotlib_figure.py",
        "pdf.py",
        "frame.py",
        "titles.py",
        "docs_notebooks.py",
        "docs_conventions.py",
    }
