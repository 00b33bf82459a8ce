"""Write the golden flights anew, after a change that moves bits on purpose; commit them by themselves.

    python tools/golden.py                  # all
    python tools/golden.py tianwen1 msl     # some

Prints what has moved first in each.  ``edl6dof verify --golden`` compares without writing.
"""

from __future__ import annotations

import sys

from edl6dof.verify.golden import FOLDER, Trace, difference, golden_names, read_golden, traced, write_golden


def main(names: list[str]) -> int:
    """Fly, say what moved, and keep."""
    known = golden_names()
    if unknown := [name for name in names if name not in known]:
        print(f"{unknown[0]}: no golden flight (flights: {', '.join(known)})", file=sys.stderr)
        return 2
    before = read_golden() if (FOLDER / "hashes.json").exists() else {}
    after: dict[str, Trace] = {}
    for name in known:
        if names and name not in names and name in before:
            after[name] = before[name]
            continue
        after[name] = traced(name)
        moved = difference(before[name], after[name]) if name in before else "new"
        print(f"{name:<24} {moved or 'as it was'}", flush=True)
    write_golden(after)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
