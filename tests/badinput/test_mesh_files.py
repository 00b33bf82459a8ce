"""Meshes that a vehicle file names: found beside it, refused at their key when they are none."""

from __future__ import annotations

import json
import struct
from pathlib import Path

import numpy as np
import pytest

import edl6dof
from edl6dof.config.errors import ConfigError
from edl6dof.interchange.meshes import read_mesh_file

VEHICLE = Path(edl6dof.__file__).parents[1] / "vehicles" / "tianwen1.yaml"
CORNERS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], "<f4")


def stl(places: np.ndarray = CORNERS) -> bytes:
    """One triangle."""
    return b"\0" * 80 + struct.pack("<I", 1) + struct.pack("<3f", 0, 0, 1) + places.tobytes() + b"\0\0"


def gltf(**more: object) -> dict:
    """One triangle, its numbers in a buffer of the binary file."""
    return {
        "asset": {"version": "2.0"},
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "buffers": [{"byteLength": 36}],
        **more,
    }


def glb(scene: object, data: bytes = CORNERS.tobytes()) -> bytes:
    """A binary glTF file."""
    text = json.dumps(scene).encode()
    text += b" " * (-len(text) % 4)
    body = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(data), b"BIN\0") + data
    return struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body


#: name, content, what is said
BROKEN = {
    "text.stl": (b"hello", "text.stl is no STL file"),
    "cut.stl": (stl()[:-1], "is no STL file"),
    "nan.stl": (stl(CORNERS * np.nan), "not finite"),
    "empty.glb": (b"", "is no binary glTF file"),
    "cut.glb": (glb(gltf())[:-4], "no complete binary glTF 2.0"),
    "json.glb": (struct.pack("<4sIII4s", b"glTF", 2, 24, 4, b"JSON") + b"{{{{", "no glTF file with a mesh"),
    "deep.gltf": (b"[" * 100_000, "no glTF file with a mesh"),
    "nothing.glb": (glb(gltf(meshes=[])), "no glTF 2.0 file with a mesh"),
    "old.gltf": (json.dumps(gltf(asset={"version": "1.0"})).encode(), "no glTF 2.0 file"),
    "packed.glb": (glb(gltf(extensionsRequired=["KHR_draco"])), "needs extensions"),
    "elsewhere.gltf": (json.dumps(gltf(buffers=[{"uri": "../../x.bin"}])).encode(), "names another file"),
    "called.gltf": (json.dumps(gltf(images=[{"uri": "http://x/y.png"}])).encode(), "names another file"),
    "mesh.obj": (b"v 0 0 0", "must end in .glb, .gltf, .stl"),
}


@pytest.mark.parametrize("name", BROKEN)
def test_what_is_no_mesh_is_refused(name, tmp_path):
    content, words = BROKEN[name]
    (tmp_path / name).write_bytes(content)
    with pytest.raises(ValueError, match=words):
        read_mesh_file(tmp_path / name)


def test_good_meshes_are_handed_on_as_they_are(tmp_path):
    ascii_stl = b"solid x\nfacet normal 0 0 1\nouter loop\nendloop\nendfacet\nendsolid x\n"
    for name, content in (("a.stl", stl()), ("b.STL", ascii_stl), ("c.glb", glb(gltf()))):
        (tmp_path / name).write_bytes(content)
        assert read_mesh_file(tmp_path / name).content == content
    assert read_mesh_file(tmp_path / "c.glb").media_type == "model/gltf-binary"


def scenario_beside(folder: Path, appearance: str) -> Path:
    """A scenario and its vehicle, whose appearance is written in the vehicle's file."""
    own = VEHICLE.read_text().replace("appearance: {lander: rover}", appearance)
    (folder / "mine.yaml").write_text(own)
    scenario = folder / "flight.yaml"
    scenario.write_text(f"extends: tianwen1\nname: mine\nvehicle: {folder / 'mine.yaml'}\n")
    return scenario


def test_file_is_looked_for_beside_the_vehicle_that_names_it(tmp_path, monkeypatch):
    (tmp_path / "shell.stl").write_bytes(stl())
    scenario = scenario_beside(
        tmp_path, "appearance:\n  meshes:\n    - {file: shell.stl, part: backshell, scale: 1e-3}"
    )
    monkeypatch.chdir("/")
    (mesh,) = edl6dof.load(str(scenario)).scenario.vehicle.appearance.meshes
    assert Path(mesh.file) == tmp_path / "shell.stl"


def test_missing_file_and_unknown_part_are_told_with_file_line_and_key(tmp_path):
    scenario = scenario_beside(tmp_path, "appearance:\n  meshes:\n    - file: none.stl")
    with pytest.raises(ConfigError) as caught:
        edl6dof.load(str(scenario))
    (problem,) = caught.value.problems
    line = (tmp_path / "mine.yaml").read_text().split("- file: none.stl")[0].count("\n") + 1
    assert (Path(problem.file).name, problem.line) == ("mine.yaml", line)
    assert problem.path == "vehicle.appearance.meshes.0.file"
    assert "cannot be read: No such file" in problem.message
    scenario = scenario_beside(tmp_path, "appearance: {meshes: [{file: none.stl, part: wheel}]}")
    with pytest.raises(ConfigError, match="no part named 'wheel'"):
        edl6dof.load(str(scenario))
