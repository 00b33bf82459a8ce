"""A body whose file cannot be flown: refused at the key that names it, with what is wrong."""

from __future__ import annotations

import pytest

import edl6dof
from edl6dof.config.errors import ConfigError

BROKEN = {
    "text.stl": ("solid a\nfacet\nvertex 0 0 0\nendfacet\nendsolid a\n", "three corners"),
    "some.stl": ("not a mesh", "is no STL file"),
    "some.gltf": ("{}", "is no glTF file with a mesh"),
    "some.csv": ("mach,alpha_deg,CA\n", "lacks the column Cm"),
    "some.txt": ("hello", "must end in .glb, .gltf, .stl"),
}


def problem(path):
    with pytest.raises(ConfigError) as error:
        edl6dof.load("earth_drop", ["vehicle.aero.model=body", f"vehicle.aero.body.file={path}"])
    (found,) = error.value.problems
    return found


@pytest.mark.parametrize("name", BROKEN)
def test_broken_file_is_told_at_its_key(tmp_path, name):
    content, words = BROKEN[name]
    path = tmp_path / name
    path.write_text(content, encoding="utf-8")
    found = problem(path)
    assert found.path == "vehicle.aero.body.file" and words in found.message


def test_missing_file_is_told(tmp_path):
    assert "cannot be read" in problem(tmp_path / "gone.stl").message


def test_no_file_is_asked_for():
    with pytest.raises(ConfigError, match=r"vehicle\.aero\.body\.file: required key is missing"):
        edl6dof.load("earth_drop", ["vehicle.aero.model=body"])


def test_model_that_needs_more_is_told_in_its_own_line(tmp_path):
    path = tmp_path / "aero.dml"
    path.write_text(
        '<DAVEfunc>\n<variableDef name="angleOfAttack" varID="a" units="deg"/>\n'
        '<variableDef name="flap" varID="f" units="deg"/>\n'
        '<variableDef name="aeroBodyForceCoefficient_X" varID="x" units="nd"><calculation><math>'
        "<apply><plus/><ci>a</ci><ci>f</ci></apply></math></calculation></variableDef>\n</DAVEfunc>\n",
        encoding="utf-8",
    )
    found = problem(path)
    assert found.file.endswith("aero.dml") and found.line == 3 and "daveml_inputs" in found.message
