"""Flies saved states with seeded corruptions, many in one process; a process of its own, as a state that is
trusted can end it.

Each corruption gives a line of JSON: its number, what it was, ``refused`` or ``flown``, and in which words.
"""

from __future__ import annotations

import io
import json
import sys
import zipfile
from dataclasses import replace
from pathlib import Path
from unittest.mock import patch

import numpy as np

from edl6dof.config.dtype import duplicate
from edl6dof.config.errors import ConfigError
from edl6dof.records import numbers
from edl6dof.sim.checkpoint import State
from edl6dof.sim.flight import continue_from, fly

WHOLE = (-(2**63), -(10**6), -2, -1, 0, 1, 2, 3, 4, 7, 8, 15, 16, 31, 32, 33, 10**6, 2**31, 2**63 - 1)
FLOATS = (np.nan, np.inf, -np.inf, 0.0, -1.0, 1e-300, -1e300, 1e300, 1e9, 1e99, 5e-324)


def fits(dtype, value):
    """Whether a field of this type can hold a whole number."""
    return bool(np.iinfo(dtype).min <= value <= np.iinfo(dtype).max)


def store(state, path):
    """Save without compressing, which would take as long as all else; a state is read from both forms."""
    with patch.object(np, "savez_compressed", np.savez):
        state.save(path)


def change_values(rng, state, path):
    """Some fields of the records, each to a value that is hardly ever right."""
    fields = [
        field for record in (state.plant, state.peaks, state.sensors, state.fsw) for field in numbers(record)
    ]
    chosen = [fields[i] for i in rng.integers(0, len(fields), rng.integers(1, 4))]
    whole = [field for field in fields if field.is_whole]
    chosen.append(whole[rng.integers(0, len(whole))])
    for field in chosen:
        values = field.values.flat
        choice = [one for one in WHOLE if fits(field.values.dtype, one)] if field.is_whole else FLOATS
        values[rng.integers(0, len(values))] = rng.choice(choice)
    store(state, path)
    return ", ".join(field.path for field in chosen)


def change_cycle(rng, state, path):
    store(replace(state, cycle=int(rng.choice(WHOLE))), path)
    return "cycle"


def change_record_bytes(rng, state, path):
    """Bytes anywhere in the records, in a file that is otherwise whole."""
    for record in (state.plant, state.peaks, state.sensors, state.fsw):
        data = record.view(np.uint8)
        data[rng.integers(0, len(data), 8)] = rng.integers(0, 256, 8)
    store(state, path)
    return "record bytes"


def change_file_bytes(rng, state, path):
    """Bytes of the file, or its end cut off."""
    state.save(path)
    data = bytearray(path.read_bytes())
    for place in rng.integers(0, len(data), rng.integers(1, 30)):
        data[place] = rng.integers(0, 256)
    path.write_bytes(data[: rng.integers(1, len(data))] if rng.random() < 0.3 else data)
    return "file bytes"


def change_members(rng, state, path):
    """One member gone, of another kind or size, or full of bytes, in an archive that is otherwise whole."""
    store(state, path)
    with zipfile.ZipFile(path) as archive:
        members = {name: archive.read(name) for name in archive.namelist()}
    name = rng.choice(sorted(members))
    kind = rng.integers(0, 5)
    array = np.load(io.BytesIO(members[name]))
    if kind == 0:
        del members[name]
    elif kind == 1:
        members[name] = rng.integers(0, 256, rng.integers(0, 400), dtype=np.uint8).tobytes()
    else:
        other = (array.astype("f8"), array.reshape(-1)[:-1], np.zeros((3, 5)))[kind - 2]
        buffer = io.BytesIO()
        np.save(buffer, other)
        members[name] = buffer.getvalue()
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for member, data in members.items():
            archive.writestr(member, data)
    return f"member {name}, {kind}"


def change_scenario(rng, state, path):
    """Some letters of the scenario's text."""
    text = bytearray(state.scenario_text.encode())
    for place in rng.integers(0, len(text), 3):
        text[place] = rng.integers(32, 127)
    store(replace(state, scenario_text=text.decode()), path)
    return "scenario"


KINDS = (
    change_values,
    change_values,
    change_values,
    change_cycle,
    change_record_bytes,
    change_file_bytes,
    change_members,
    change_scenario,
)


def main(states, first, last):
    sound = [State.load(Path(state)) for state in states]
    path = Path(states[0]).with_name(f"corrupted_{first}.npz")
    for number in range(first, last):
        rng = np.random.default_rng((2026, number))
        whole = sound[rng.integers(0, len(sound))]
        records = {name: duplicate(getattr(whole, name)) for name in ("plant", "peaks", "sensors", "fsw")}
        state = replace(whole, **records)
        what = KINDS[number % len(KINDS)](rng, state, path)
        print(json.dumps([number, what, "begun", ""]), flush=True)
        try:
            loaded = State.load(path)
            flight = fly(continue_from(loaded), start=loaded)
            flight.events, flight.figures  # noqa: B018  formed too
            print(json.dumps([number, what, "flown", flight.outcome]), flush=True)
        except ConfigError as error:
            print(json.dumps([number, what, "refused", str(error)]), flush=True)


if __name__ == "__main__":
    main(sys.argv[3:], int(sys.argv[1]), int(sys.argv[2]))
