"""Prints the values that compiled code freezes, of each global and closure that a kernel reads, as JSON."""

from __future__ import annotations

import enum
import hashlib
import importlib
import json
import pkgutil
from collections.abc import Iterator
from types import CodeType, FunctionType, ModuleType
from typing import Any

import numpy as np

import edl6dof
from edl6dof.config.errors import ConfigError
from edl6dof.kernels.jit import Kernel


def kernels(module: ModuleType) -> Iterator[FunctionType]:
    """The Python functions of the kernels that a module defines."""
    for value in vars(module).values():
        if isinstance(value, Kernel) and value.py_func.__module__ == module.__name__:
            yield value.py_func


def names_in(code: CodeType) -> set[str]:
    """Names that code reads, that of functions inside it too."""
    inside = [one for one in code.co_consts if isinstance(one, CodeType)]
    return {*code.co_names, *(name for one in inside for name in names_in(one))}


def frozen(function: FunctionType) -> dict[str, str]:
    """Values that the machine code of a kernel contains, by name."""
    cells = zip(function.__code__.co_freevars, function.__closure__ or (), strict=True)
    read = {
        name: function.__globals__[name] for name in names_in(function.__code__) & function.__globals__.keys()
    }
    read |= {name: cell.cell_contents for name, cell in cells}
    return {name: told for name, value in sorted(read.items()) if (told := exactly(value))}


def exactly(value: Any) -> str:
    """A value to the last bit; empty for what is code.

    Raises:
        TypeError: it is of no known kind.
    """
    if isinstance(value, ModuleType | type) or callable(value):
        return ""
    if isinstance(value, tuple | list):
        return "(" + ",".join(map(exactly, value)) + ")"
    if isinstance(value, float | np.floating):
        return float(value).hex()
    if isinstance(value, np.ndarray):
        return f"{value.dtype}{value.shape}{hashlib.sha256(value.tobytes()).hexdigest()}"
    if value is None or isinstance(value, bool | int | str | np.integer | np.dtype | enum.Enum):
        return repr(value)
    raise TypeError(f"a kernel reads {value!r}")


def main() -> None:
    found = {}
    for info in pkgutil.walk_packages(edl6dof.__path__, "edl6dof."):
        if info.name.endswith("__main__"):
            continue
        try:
            module = importlib.import_module(info.name)
        except (ImportError, ConfigError):  # an extra that is not installed
            continue
        for function in kernels(module):
            found |= {
                f"{info.name}.{function.__qualname__}: {name}": told
                for name, told in frozen(function).items()
            }
    print(json.dumps(found))


if __name__ == "__main__":
    main()
