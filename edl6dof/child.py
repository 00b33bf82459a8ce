"""Python in another process that finds the same modules and no others.

With ``-m`` or ``-c`` alone, Python looks for modules first in the current folder, which may be a received one
with a ``numba.py``.
"""

from __future__ import annotations

import os
import sys

_FIND = "import sys; sys.path[:] = sys.argv.pop(1).split({!r}); "


def python(code: str, *words: str) -> list[str]:
    """Command that runs some code with ``sys.argv[1:]`` as given."""
    return [sys.executable, "-P", "-c", _FIND.format(os.pathsep) + code, os.pathsep.join(sys.path), *words]
