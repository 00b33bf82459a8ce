"""Squares of plain Python by multiplication, as numba compiles ``x ** 2``.

Python calls pow of the C library, which differs from the product in the last bit in one of 1,100 cases.
"""

from __future__ import annotations

import ast
from importlib.machinery import SourceFileLoader
from types import CodeType


class _Products(ast.NodeTransformer):
    """Replaces ``x ** 2`` by the product of x with itself."""

    def visit_BinOp(self, node: ast.BinOp) -> ast.AST:
        self.generic_visit(node)
        if isinstance(node.op, ast.Pow) and isinstance(node.right, ast.Constant) and node.right.value == 2:
            product = ast.parse("(lambda x: x * x)(None)", mode="eval").body
            assert isinstance(product, ast.Call)
            product.args = [node.left]
            return product
        return node


def multiply(package: str) -> None:
    """Multiply in modules of this package that are imported from now on."""
    usual = SourceFileLoader.get_code

    def get_code(loader: SourceFileLoader, name: str) -> CodeType | None:
        if not name.startswith(f"{package}."):
            return usual(loader, name)
        path = loader.get_filename(name)
        tree = _Products().visit(ast.parse(loader.get_data(path), path))
        return compile(ast.fix_missing_locations(tree), path, "exec", dont_inherit=True)

    SourceFileLoader.get_code = get_code  # type: ignore[method-assign]
