"""``edl6dof verify --golden``."""

from __future__ import annotations

import json
from collections.abc import Sequence

from edl6dof.app.compiling import announce_compiling
from edl6dof.app.exit_status import refuse
from edl6dof.config.wording import nearest
from edl6dof.verify.golden import difference, golden_names, read_golden, traced


def run_golden(names: Sequence[str], as_json: bool) -> int:
    """Fly golden flights, or some of them, and print what differs first in each; returns the exit status."""
    known = golden_names()
    if unknown := [name for name in names if name not in known]:
        near = nearest(unknown[0], known)
        hint = f"; did you mean {near!r}?" if near else ""
        return refuse(f"{unknown[0]}: no golden flight{hint} (flights: {', '.join(known)})")
    announce_compiling(not as_json)
    golden, found = read_golden(), {}
    for name in names or known:
        found[name] = difference(golden[name], traced(name))
        if not as_json:
            print(f"{name:<24} {found[name] or 'identical'}", flush=True)
    same = not any(found.values())
    if as_json:
        print(json.dumps({"identical": same, "flights": found}, indent=1))
    else:
        alike = sum(not text for text in found.values())
        print(f"{alike} of {len(found)} identical to the last bit")
    return 0 if same else 1
