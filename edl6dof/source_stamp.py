"""What machine code follows from: the statements of a file and of all package files that it reaches.

numba stamps a cache entry with the file of the compiled function only; when a helper in another module is
edited, its callers keep running the old machine code (numba issues 1833 and 8851).  Here the stamp covers all
that a function can reach.  Words do not count: comments, docstrings, error messages, meanings of parameters.
"""

from __future__ import annotations

import ast
import atexit
import json
import os
from collections.abc import Iterable, Iterator
from contextlib import suppress
from functools import cached_property
from hashlib import sha256
from os.path import isfile, join
from pathlib import Path
from typing import NamedTuple

from edl6dof.durable import write_atomic

#: Calls whose texts are read by people: declarations of parameters, and what is wrong with an input.
_SPOKEN = frozenset(
    ["param", "group", "section", "Problem", "ConfigError", "Inconsistent", "refusal", "say_once", "print"]
)
#: What was read by another version of this file does not count.
_READER = sha256(Path(__file__).read_bytes()).digest()
#: Sources remembered between processes; with more (versions of years), the memory starts anew.
_REMEMBERED = 4000


class Source(NamedTuple):
    """What one file contributes: the hash of its statements, and the dotted names that it imports."""

    statements: str
    imported: list[str]


class SourceTree:
    """The files of one package, each read once."""

    def __init__(self, package: Path, memory: Path) -> None:
        """``memory``: file that keeps what was read of each content, since parsing takes ten times as long as
        hashing; it is never needed and may be missing, damaged or impossible to write.
        """
        self._package, self._memory = package, memory
        self._files: dict[str, tuple[str, frozenset[str]]] = {}
        self._places: dict[str, str] = {}
        self._taken: dict[str, bytes] = {}

    def take(self, path: str, content: bytes) -> None:
        """Take this for the content of a file from now on, whatever happens to it on the disk."""
        self._taken[path] = content
        self._files.pop(path, None)

    def stamp(self, paths: Iterable[str]) -> str:
        """Hash of the statements of all files that ``paths`` reach."""
        return sha256(
            "".join(self._read(path)[0] for path in sorted(self.reached(*paths))).encode()
        ).hexdigest()

    def changed_at(self, paths: Iterable[str]) -> float:
        """When the last of all files that ``paths`` reach was written or put in its place, s since 1970; one
        whose content was taken does not count.
        """
        found = [os.stat(path) for path in self.reached(*paths) if path not in self._taken]
        return max((max(one.st_mtime, one.st_ctime) for one in found), default=0.0)

    def reached(self, *paths: str) -> set[str]:
        """The paths and all package files that they reach by imports; a ring ends."""
        seen, queue = set(paths), list(paths)
        while queue:
            new = self._read(queue.pop())[1] - seen
            seen |= new
            queue += new
        return seen

    def _read(self, path: str) -> tuple[str, frozenset[str]]:
        """Hash of a file's statements, and the package files that it imports itself."""
        if path not in self._files:
            content = self._taken.get(path) or Path(path).read_bytes()
            key = sha256(_READER + path.encode() + b"\0" + content).hexdigest()
            if key not in self._known:
                self._known[key] = parsed(content.decode("utf-8-sig"), self._dotted(path))
                self._new.append(key)
            source = self._known[key]
            files = frozenset(file for name in source.imported if (file := self._file_of(name)))
            self._files[path] = (source.statements, files)
        return self._files[path]

    def _dotted(self, path: str) -> list[str]:
        """The package that holds a file, as the start of its relative imports; empty outside this package."""
        folder = Path(path).parent
        if not folder.is_relative_to(self._package):
            return []
        return [self._package.name, *folder.relative_to(self._package).parts]

    def _file_of(self, dotted: str) -> str:
        """File of a module of this package; empty for anything else."""
        if dotted not in self._places:
            first, *inside = dotted.split(".")
            base = join(self._package, *inside)
            files = (f"{base}.py", f"{base}/__init__.py") if first == self._package.name else ()
            self._places[dotted] = next(filter(isfile, files), "")
        return self._places[dotted]

    @cached_property
    def _known(self) -> dict[str, Source]:
        atexit.register(self._remember)
        with suppress(OSError, ValueError, TypeError, AttributeError):
            kept = json.loads(self._memory.read_bytes())
            if len(kept) <= _REMEMBERED:
                return {
                    key: Source(str(statements), list(map(str, names)))
                    for key, (statements, names) in kept.items()
                }
        return {}

    @cached_property
    def _new(self) -> list[str]:
        return []

    def _remember(self) -> None:
        if self._new:
            with suppress(OSError):
                write_atomic(self._memory, json.dumps(self._known).encode())


def parsed(text: str, package: list[str]) -> Source:
    """What a source contributes; relative imports count from ``package`` and are ignored without one."""
    tree = ast.parse(text)
    names = list(dict.fromkeys(_imported(tree, package)))
    return Source(sha256(ast.dump(_Wordless().visit(tree)).encode()).hexdigest(), names)


def _imported(tree: ast.Module, package: list[str]) -> Iterator[str]:
    """Dotted names that the import statements mention; some are not modules but names in one."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = package[: len(package) - node.level + 1] if node.level else []
            if node.level and not base:
                continue
            origin = ".".join([*base, node.module] if node.module else base)
            yield origin
            yield from (f"{origin}.{alias.name}" for alias in node.names)


class _Wordless(ast.NodeTransformer):
    """Empties the texts that only people read."""

    def visit_Expr(self, node: ast.Expr) -> ast.AST:
        """Docstrings."""
        return _silent(node) if isinstance(node.value, ast.Constant) else self.generic_visit(node)

    def visit_Raise(self, node: ast.Raise) -> ast.AST:
        """Error messages."""
        return _silent(node)

    def visit_Call(self, node: ast.Call) -> ast.AST:
        """Declarations and messages."""
        name = getattr(node.func, "attr", getattr(node.func, "id", ""))
        return _silent(node) if name in _SPOKEN else self.generic_visit(node)


def _silent(node: ast.AST) -> ast.AST:
    for part in ast.walk(node):
        if isinstance(part, ast.Constant) and isinstance(part.value, str):
            part.value = ""
    return node
