"""Make packages callable whose names are also functions, so that ``edl6dof.report(run)`` works together with
``from edl6dof.report.document import Report``.

When Python imports such a package, the package replaces the function of the same name.  The package is then
called like the function.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from types import ModuleType
from typing import Any


def stay_callable(package: ModuleType, functions: Mapping[str, Callable[..., Any]]) -> None:
    """Make modules of ``package`` with the names of these functions callable like the functions."""

    class Package(ModuleType):
        """A package that knows functions of the names of its packages."""

        def __setattr__(self, name: str, value: Any) -> None:
            if isinstance(value, ModuleType) and name in functions:
                value.__class__ = _called(functions[name])
            super().__setattr__(name, value)

    package.__class__ = Package


def _called(function: Callable[..., Any]) -> type[ModuleType]:
    """Modules that are called like a function."""

    class Called(ModuleType):
        """A package that is also a function."""

        __signature__ = inspect.signature(function)

        def __call__(self, *values: Any, **named: Any) -> Any:
            """Call the function."""
            return function(*values, **named)

    Called.__call__.__doc__ = function.__doc__
    return Called
