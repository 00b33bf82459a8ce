"""Meshes in files of others: glTF 2.0 and STL, seen to be such before a viewer is handed them.

A file is data and nothing else: it is read as bytes, nothing in it is run, and one that names other files or
addresses is refused.
"""

from __future__ import annotations

import json
import struct
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from edl6dof.config.document.regular import read_regular

#: Size, in bytes, of the largest mesh that is read.
LARGEST_MESH = 30_000_000
_GLB_HEAD, _CHUNK_HEAD = struct.Struct("<4sII"), struct.Struct("<I4s")
#: A binary STL: 80 bytes of anything, the number of triangles, and 50 bytes for each.
_STL_HEAD, _STL_TRIANGLE = 84, np.dtype([("places", "<f4", (12,)), ("attribute", "<u2")])


#: Media types.
GLB, GLTF, STL = "model/gltf-binary", "model/gltf+json", "model/stl"


class MeshFile(NamedTuple):
    """A mesh as it is on disk, and its media type."""

    content: bytes
    media_type: str


def read_mesh_file(path: Path) -> MeshFile:
    """A mesh.

    Raises:
        OSError: the file cannot be read.
        ValueError: it is no mesh of these kinds, or names other files.
    """
    kind = path.suffix.lower()
    if kind not in _KINDS:
        raise ValueError(f"must end in {', '.join(_KINDS)} (got {path.name!r})")
    media_type, check = _KINDS[kind]
    content = read_regular(path, LARGEST_MESH)
    if words := check(content):
        raise ValueError(f"{path.name} {words}")
    return MeshFile(content, media_type)


def _glb_problem(content: bytes) -> str:
    size = _GLB_HEAD.size + _CHUNK_HEAD.size
    if len(content) < size or content[:4] != b"glTF":
        return "is no binary glTF file"
    _, version, length = _GLB_HEAD.unpack_from(content)
    part, kind = _CHUNK_HEAD.unpack_from(content, _GLB_HEAD.size)
    if version != 2 or length != len(content) or kind != b"JSON" or size + part > length:
        return "is no complete binary glTF 2.0 file"
    return _gltf_problem(content[size : size + part])


def _gltf_problem(content: bytes) -> str:
    try:
        scene: Any = json.loads(content)
        version = str(scene["asset"]["version"])
        drawn = [
            one for mesh in scene["meshes"] for one in mesh["primitives"] if "POSITION" in one["attributes"]
        ]
        named = [one.get("uri", "data:") for key in ("buffers", "images") for one in scene.get(key, ())]
        outside = [uri for uri in named if not uri.startswith("data:")]
    except (ValueError, RecursionError, LookupError, TypeError, AttributeError):
        return "is no glTF file with a mesh"
    if not version.startswith("2.") or not drawn:
        return "is no glTF 2.0 file with a mesh"
    if scene.get("extensionsRequired"):
        return f"needs extensions that viewers may lack: {str(scene['extensionsRequired'])[:80]}"
    return f"names another file: {outside[0][:60]!r}; put all into one .glb" if outside else ""


def _stl_problem(content: bytes) -> str:
    if len(content) > _STL_HEAD:
        (count,) = struct.unpack_from("<I", content, _STL_HEAD - 4)
        if len(content) == _STL_HEAD + count * _STL_TRIANGLE.itemsize:
            places = np.frombuffer(content, _STL_TRIANGLE, offset=_STL_HEAD)["places"]
            return "" if np.isfinite(places).all() else "has numbers that are not finite"
    if content.lstrip()[:5] == b"solid" and b"facet" in content and b"endsolid" in content:
        return ""
    return "is no STL file"


_KINDS = {
    ".glb": (GLB, _glb_problem),
    ".gltf": (GLTF, _gltf_problem),
    ".stl": (STL, _stl_problem),
}
