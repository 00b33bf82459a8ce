"""Python in a process of its own that finds the modules that this one finds, and no others.

Started with ``-m`` or ``-c`` alone, Python looks for modules in the current folder first, where a received
folder may hold a ``numba.py``.
"""

from __future__ import annotations

import os
import sys

_FIND = "import sys; sys.path[:] = sys.argv.pop(1).split({!r}); "


def python(code: str, *words: str) -> list[str]:
    """Command that runs some code with ``sys.argv[1:]`` as given."""
    return [sys.executable, "-P", "-c", _FIND.format(os.pathsep) + code, os.pathsep.join(sys.path), *words]
