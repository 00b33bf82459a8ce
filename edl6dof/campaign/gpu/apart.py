"""What :func:`edl6dof.apart.stay_apart` is on a GPU: an attribute of the function that says it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from numba import types
from numba.extending import intrinsic, overload

from edl6dof.apart import stay_apart


@intrinsic
def _keep_out_of_line(context: Any) -> Any:
    def mark(target: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        builder.function.attributes.add("noinline")
        return target.get_dummy_value()

    return types.none(), mark


@overload(stay_apart, target="cuda", inline="always")
def _on_a_gpu() -> Callable[[], None]:
    def mark() -> None:
        _keep_out_of_line()

    return mark
