"""Closed meshes of simple bodies [triangle, corner, xyz], and files of them."""

import json
import struct
from math import cos, pi, sin

import numpy as np


def revolved(profile, parts):
    """The body of revolution about x with this meridian of (x, r) from the nose aft; its ends are shut."""
    points = [(profile[0][0], 0.0), *profile, (profile[-1][0], 0.0)]
    phi = 2 * pi * np.arange(parts + 1) / parts
    ring = np.array([[(x, r * sin(p), r * cos(p)) for p in phi] for x, r in points])
    a, b, c, d = ring[:-1, :-1], ring[:-1, 1:], ring[1:, 1:], ring[1:, :-1]
    both = np.concatenate((np.stack((a, b, c), axis=2), np.stack((a, c, d), axis=2)))
    return both.reshape(-1, 3, 3)


def sphere(rows, columns):
    """A sphere of radius one about the origin."""
    arc = [(cos(a), sin(a)) for a in pi * np.arange(1, rows) / rows]
    return revolved([(1.0, 0.0), *arc, (-1.0, 0.0)], columns)


def box(x, y, z):
    """A box about the origin."""
    found = []
    for axis, half in enumerate((0.5 * x, 0.5 * y, 0.5 * z)):
        j, k = (axis + 1) % 3, (axis + 2) % 3
        sides = (0.5 * x, 0.5 * y, 0.5 * z)
        for sign in (-1.0, 1.0):
            corners = np.zeros((4, 3))
            corners[:, axis] = sign * half
            corners[:, j] = sides[j] * np.array([-1, 1, 1, -1])
            corners[:, k] = sides[k] * np.array([-1, -1, 1, 1])
            if sign < 0.0:
                corners = corners[::-1]
            found += [corners[[0, 1, 2]], corners[[0, 2, 3]]]
    return np.array(found)


def write_stl(path, corners):
    rows = np.zeros(len(corners), [("places", "<f4", (12,)), ("attribute", "<u2")])
    rows["places"][:, 3:] = np.asarray(corners).reshape(-1, 9)
    path.write_bytes(bytes(80) + struct.pack("<I", len(corners)) + rows.tobytes())
    return path


def write_text_stl(path, corners):
    lines = ["solid body"]
    for corner in np.asarray(corners):
        lines += ["facet normal 0 0 0", "outer loop"]
        lines += [f"vertex {x:.9g} {y:.9g} {z:.9g}" for x, y, z in corner]
        lines += ["endloop", "endfacet"]
    path.write_text("\n".join([*lines, "endsolid body", ""]), encoding="ascii")
    return path


def write_glb(path, corners):
    """Binary glTF: half its size, under a node of scale two that stands a metre aside, inside one that takes
    that back.
    """
    places = np.ascontiguousarray(0.5 * np.asarray(corners).reshape(-1, 3) + [0.0, 0.5, 0.0], "<f4")
    order = np.arange(len(places), dtype="<u2")
    data = places.tobytes() + order.tobytes()
    data += bytes(-len(data) % 4)
    scene = {
        "asset": {"version": "2.0"},
        "nodes": [
            {"children": [1], "translation": [0.0, -1.0, 0.0]},
            {"mesh": 0, "scale": [2.0, 2.0, 2.0]},
        ],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": len(places), "type": "VEC3"},
            {"bufferView": 1, "componentType": 5123, "count": len(order), "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteLength": places.nbytes},
            {"buffer": 0, "byteOffset": places.nbytes, "byteLength": order.nbytes},
        ],
        "buffers": [{"byteLength": len(data)}],
    }
    text = json.dumps(scene).encode()
    text += b" " * (-len(text) % 4)
    length = 12 + 8 + len(text) + 8 + len(data)
    path.write_bytes(
        struct.pack("<4sII", b"glTF", 2, length)
        + struct.pack("<I4s", len(text), b"JSON") + text
        + struct.pack("<I4s", len(data), b"BIN\0") + data
    )  # fmt: skip
    return path
