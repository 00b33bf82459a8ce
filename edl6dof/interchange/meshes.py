"""Mesh files of unknown origin, glTF 2.0 and STL: checked before they are given to a viewer; and their
triangles, in the file's own axes and units.

A file is data and nothing else: it is read as bytes, nothing in it is run, and one that names other files or
addresses is refused.
"""

from __future__ import annotations

import base64
import json
import struct
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from edl6dof.config.document.regular import read_regular
from edl6dof.spatial.arrays import product

#: Size, in bytes, of the largest mesh that is read.
LARGEST_MESH = 30_000_000
_GLB_HEAD, _CHUNK_HEAD = struct.Struct("<4sII"), struct.Struct("<I4s")
#: A binary STL: 80 bytes of anything, the number of triangles, and 50 bytes for each.
_STL_HEAD, _STL_TRIANGLE = 84, np.dtype([("places", "<f4", (12,)), ("attribute", "<u2")])
#: Media types.
GLB, GLTF, STL = "model/gltf-binary", "model/gltf+json", "model/stl"


class MeshFile(NamedTuple):
    """Content of a mesh file, and its media type."""

    content: bytes
    media_type: str


def read_mesh_file(path: Path) -> MeshFile:
    """Read and check a mesh file.

    Raises:
        OSError: the file cannot be read.
        ValueError: the file is no glTF 2.0 or STL, or names other files.
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


def _binary_stl(content: bytes) -> np.ndarray | None:
    """Normal and three corners of each triangle of a binary STL, shape (triangles, 12)."""
    if len(content) < _STL_HEAD:
        return None
    (count,) = struct.unpack_from("<I", content, _STL_HEAD - 4)
    if len(content) != _STL_HEAD + count * _STL_TRIANGLE.itemsize:
        return None
    return np.frombuffer(content, _STL_TRIANGLE, offset=_STL_HEAD)["places"]


def _stl_problem(content: bytes) -> str:
    if (places := _binary_stl(content)) is not None and len(places):
        return "" if np.isfinite(places).all() else "has numbers that are not finite"
    if content.lstrip()[:5] == b"solid" and b"facet" in content and b"endsolid" in content:
        return ""
    return "is no STL file"


_KINDS = {
    ".glb": (GLB, _glb_problem),
    ".gltf": (GLTF, _gltf_problem),
    ".stl": (STL, _stl_problem),
}


#: Largest number of triangles in one file.
MOST_TRIANGLES = 50_000
_COMPONENTS = {5121: "<u1", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_TRIANGLES = 4


def read_triangles(path: Path) -> np.ndarray:
    """Corners [triangle, corner, (x, y, z)] of all triangles of a file, scenes and nodes put together.

    Raises:
        OSError: the file cannot be read.
        ValueError: the file is no glTF 2.0 or STL, is damaged, or its triangles cannot be used.
    """
    content, media_type = read_mesh_file(path)
    try:
        corners = _stl(content) if media_type == STL else _gltf(content, media_type == GLB)
    except (LookupError, TypeError, struct.error, AttributeError) as error:
        raise ValueError(f"{path.name} is damaged: {error}") from None
    if not 4 <= len(corners) <= MOST_TRIANGLES:
        words = f"a body has at least 4, and at most {MOST_TRIANGLES} are taken"
        raise ValueError(f"{path.name} has {len(corners)} triangles; {words}")
    if not np.isfinite(corners).all():
        raise ValueError(f"{path.name} has numbers that are not finite")
    return corners


def _stl(content: bytes) -> np.ndarray:
    if (found := _binary_stl(content)) is not None:
        return found[:, 3:].reshape(-1, 3, 3).astype(float)
    rows = [line.split() for line in content.decode("ascii", "replace").splitlines()]
    places = [[float(word) for word in row[1:4]] for row in rows if row[:1] == ["vertex"]]
    if len(places) % 3 or any(len(place) != 3 for place in places):
        raise ValueError("the STL file has a facet without three corners of three numbers")
    return np.array(places).reshape(-1, 3, 3)


def _gltf(content: bytes, binary: bool) -> np.ndarray:
    data = b""
    if binary:
        (length,) = struct.unpack_from("<I", content, 12)
        data, content = content[20 + length + 8 :], content[20 : 20 + length]
    scene = json.loads(content)
    if any("sparse" in one for one in scene.get("accessors", ())):
        raise ValueError("the glTF file has sparse accessors, which are not supported")
    uris = [one.get("uri") for one in scene.get("buffers", ())]
    buffers = [data if uri is None else base64.b64decode(uri.partition(",")[2]) for uri in uris]
    nodes = scene.get("nodes", [])
    inner = {child for node in nodes for child in node.get("children", ())}
    waiting = [(k, np.eye(4)) for k in range(len(nodes)) if k not in inner]
    found, met = [np.zeros((0, 3, 3))], 0
    while waiting:
        k, above = waiting.pop()
        if (met := met + 1) > len(nodes):
            raise ValueError("the glTF file has nodes that contain themselves")
        node, place = nodes[k], product(above, _placing(nodes[k]))
        waiting += [(child, place) for child in node.get("children", ())]
        if "mesh" in node:
            for one in scene["meshes"][node["mesh"]]["primitives"]:
                corners = _primitive(scene, buffers, one)
                turned = product(corners, place[:3, :3].T) + place[:3, 3]
                mirrored = product(place[0, :3], np.cross(place[1, :3], place[2, :3])) < 0.0
                found.append(turned[:, ::-1] if mirrored else turned)  # corners the other way round
    return np.concatenate(found)


def _placing(node: dict[str, Any]) -> np.ndarray:
    """Matrix of a node: as given, or from scale, rotation (x, y, z, w) and translation."""
    if "matrix" in node:
        return np.array(node["matrix"], dtype=float).reshape(4, 4).T
    x, y, z, w = node.get("rotation", (0.0, 0.0, 0.0, 1.0))
    turn = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    place = np.eye(4)
    place[:3, :3] = turn * np.array(node.get("scale", (1.0, 1.0, 1.0)))
    place[:3, 3] = node.get("translation", (0.0, 0.0, 0.0))
    return place


def _primitive(scene: dict[str, Any], buffers: list[bytes], one: dict[str, Any]) -> np.ndarray:
    if one.get("mode", _TRIANGLES) != _TRIANGLES:
        raise ValueError("the glTF file has points, lines, strips or fans; triangles alone are taken")
    places = _accessor(scene, buffers, one["attributes"]["POSITION"], 3)
    if "indices" in one:
        places = places[_accessor(scene, buffers, one["indices"], 1)[:, 0].astype(int)]
    if len(places) % 3:
        raise ValueError("the glTF file has a triangle without three corners")
    return places.reshape(-1, 3, 3)


def _accessor(scene: dict[str, Any], buffers: list[bytes], number: int, width: int) -> np.ndarray:
    """Rows of an accessor as floats, [count, width]."""
    accessor = scene["accessors"][number]
    view = scene["bufferViews"][accessor["bufferView"]]
    kind = np.dtype(_COMPONENTS[accessor["componentType"]])
    count, stride = accessor["count"], view.get("byteStride", kind.itemsize * width)
    start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
    raw = np.frombuffer(buffers[view["buffer"]], np.uint8)
    if count < 0 or stride < kind.itemsize * width or start < 0:
        raise ValueError("the glTF file has an accessor that cannot be")
    if count and start + (count - 1) * stride + kind.itemsize * width > len(raw):
        raise ValueError("the glTF file has an accessor beyond the end of its buffer")
    bytes_of = start + stride * np.arange(count)[:, None] + np.arange(kind.itemsize * width)
    return raw[bytes_of].copy().view(kind).reshape(count, width).astype(float)
