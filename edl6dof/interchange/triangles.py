"""Triangles of a mesh file, in the file's own axes and units: STL, and glTF 2.0 with everything inside it."""

from __future__ import annotations

import base64
import json
import struct
from pathlib import Path
from typing import Any

import numpy as np

from edl6dof.interchange.mesh_file import GLB, STL, read_mesh_file
from edl6dof.spatial.arrays import product

#: Most triangles that are taken from one file.
MOST_TRIANGLES = 50_000
_COMPONENTS = {5121: "<u1", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_TRIANGLES = 4


def read_triangles(path: Path) -> np.ndarray:
    """Corners [triangle, corner, (x, y, z)] of all triangles of a file, scenes and nodes put together.

    Raises:
        OSError: the file cannot be read.
        ValueError: it is no mesh of these kinds, has too many triangles, none, or none that are plain.
    """
    content, media_type = read_mesh_file(path)
    try:
        corners = _stl(content) if media_type == STL else _gltf(content, media_type == GLB)
    except (LookupError, TypeError, struct.error, AttributeError) as error:
        raise ValueError(f"{path.name} is damaged: {error}") from None
    if not 4 <= len(corners) <= MOST_TRIANGLES:
        raise ValueError(
            f"{path.name} has {len(corners)} triangles; a body has at least 4, and at most "
            f"{MOST_TRIANGLES} are taken"
        )
    if not np.isfinite(corners).all():
        raise ValueError(f"{path.name} has numbers that are not finite")
    return corners


def _stl(content: bytes) -> np.ndarray:
    if len(content) >= 84:
        (count,) = struct.unpack_from("<I", content, 80)
        if len(content) == 84 + 50 * count:
            kind = np.dtype([("normal", "<f4", (3,)), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
            return np.frombuffer(content, kind, offset=84)["corners"].astype(float)
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
    buffers = [_buffer(one, data) for one in scene.get("buffers", ())]
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
                # a mirror image has its corners the other way round
                found.append(
                    turned[:, ::-1]
                    if product(place[0, :3], np.cross(place[1, :3], place[2, :3])) < 0.0
                    else turned
                )
    return np.concatenate(found)


def _buffer(one: dict[str, Any], binary: bytes) -> bytes:
    if "uri" not in one:
        return binary
    return base64.b64decode(one["uri"].partition(",")[2])


def _placing(node: dict[str, Any]) -> np.ndarray:
    """Matrix of a node: given, or of its scale, rotation (x, y, z, w) and translation."""
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
