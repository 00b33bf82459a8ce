"""Libraries that only some functions need: an extra of the package."""

from __future__ import annotations

from importlib import import_module
from typing import Any


def library(name: str, caller: str, extra: str = "") -> Any:
    """The module of a library, of the extra that is called as it is, or as ``extra`` says.

    Raises:
        ImportError: it is not installed; says what ``caller`` needs and how to get it.
    """
    try:
        return import_module(name)
    except ImportError:
        raise ImportError(f"{caller} needs {name}: pip install 'edl6dof[{extra or name}]'") from None
