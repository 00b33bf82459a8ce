"""Tables in plain text, for objects that print themselves."""

from __future__ import annotations

from collections.abc import Iterable, Sequence


def text_table(rows: Iterable[Sequence[str]], right: Sequence[int] = ()) -> str:
    """Return rows as aligned lines; ``right``: columns that are aligned to the right.

    >>> print(text_table([("mach", "1.8"), ("load_g0", "10.25")], right=(1,)))
    mach       1.8
    load_g0  10.25
    """
    rows = [*rows]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    sides = [">" if column in right else "<" for column in range(len(widths))]
    lines = (
        "  ".join(f"{cell:{side}{width}}" for cell, side, width in zip(row, sides, widths, strict=True))
        for row in rows
    )
    return "\n".join(line.rstrip() for line in lines)
