"""What a kernel may hold so that numba-cuda makes GPU code of it."""

from __future__ import annotations

import ast

from source_rules import is_kernel, nodes

#: What numpy functions GPU code has that the processor's also has.
NUMPY_ON_GPU = ("uint64", "int64", "float32", "float64", "tan")


def foreign_to_gpus(source: str) -> list[str]:
    """``line: kernel: statement`` of what numba makes no GPU code of: exceptions, printing, most of numpy,
    and arrays copied whole, through an array in between.
    """
    return [
        f"{node.lineno}: {function.name}: {ast.unparse(node)}"
        for function in nodes(source)
        if isinstance(function, ast.FunctionDef) and is_kernel(function)
        for node in ast.walk(function)
        if isinstance(node, ast.Raise | ast.Try | ast.Assert | ast.With)
        or (isinstance(node, ast.Call) and _no_gpu_has(node.func))
        or (isinstance(node, ast.Assign) and _copies_array(node))
    ]


def _no_gpu_has(called: ast.expr) -> bool:
    if isinstance(called, ast.Attribute) and getattr(called.value, "id", "") == "np":
        return called.attr not in NUMPY_ON_GPU
    return getattr(called, "id", "") == "print" or getattr(called, "attr", "") == "copy"


def _copies_array(node: ast.Assign) -> bool:
    whole = any(isinstance(target, ast.Subscript) and _has_slice(target.slice) for target in node.targets)
    return whole and not isinstance(node.value, ast.Constant)


def _has_slice(index: ast.expr) -> bool:
    return any(isinstance(part, ast.Slice) for part in getattr(index, "elts", [index]))
