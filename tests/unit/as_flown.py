"""Kernels called from Python with fields of records, as flights call them.

To numba a field of a record is something else than an array with the same numbers: a kernel that is called
with one is compiled for it, with all that it calls.
"""

from collections.abc import Callable
from hashlib import sha256
from typing import Any

from edl6dof.kernels.functions import choice


def as_flown(kernel: Any, given: str, call: str) -> Callable[..., Any]:
    """Function of ``given`` (names) that calls a kernel with ``call``: expressions of these, of types that
    a flight has.
    """
    name = f"as_flown_{sha256(f'{kernel.__name__} {given}: {call}'.encode()).hexdigest()[:16]}"
    flown = choice(name, {0: kernel}, [given], {0: [call]})
    return lambda *arguments: flown(0, *arguments)
