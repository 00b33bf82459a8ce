"""Golden flights: what every shipped scenario, and 20 cases of a campaign, give bit for bit on any machine.

Stored are a hash of each part of the records that a flight reads, of each telemetry channel and of each
figure, and the values of some channels at a few times.  ``edl6dof verify --golden`` flies them again;
``python tools/golden.py`` writes them again after a change that moves bits.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np

from edl6dof.campaign.design.plan import load_plan
from edl6dof.campaign.executor import fly_rows, table_of
from edl6dof.config.document.locate import shipped_names
from edl6dof.records import numbers
from edl6dof.scenario.loading import load_scenario
from edl6dof.scenario.records import build_records
from edl6dof.sim.flight import fly
from edl6dof.telemetry.channels import BRIEF_CHANNELS

FOLDER = Path(__file__).resolve().parents[1] / "data" / "golden"
CAMPAIGN, CASES = "tianwen1_mc", 20
#: Rows of a flight whose values are stored.
_SAMPLES = 25
_SAMPLED = ("t_s", *(channel.name for channel in BRIEF_CHANNELS))
_RECORD = np.dtype([(name, "f8") for name in _SAMPLED])


class Trace(NamedTuple):
    """Stored results of a flight or a campaign.

    Attributes:
        hashes: of records, channels and figures, by name, in the order in which they are made.
        samples: values of some channels at some rows, a field for each channel; none of a campaign.
    """

    hashes: dict[str, str]
    samples: np.ndarray


def golden_names() -> list[str]:
    """Names of the golden flights, all shipped scenarios without campaigns and plugins; and the campaign."""
    names = (name for name in shipped_names("scenarios") if not name.startswith("plugin/"))
    return [*(name for name in names if not name.endswith("_mc")), CAMPAIGN]


def traced(name: str) -> Trace:
    """Fly a golden flight, or the campaign."""
    return _campaign() if name == CAMPAIGN else _flight(name)


def difference(golden: Trace, found: Trace) -> str:
    """The first part, channel (with time and difference) or figure that differs; empty if none."""
    names = [*golden.hashes, *(name for name in found.hashes if name not in golden.hashes)]
    wrong = [name for name in names if golden.hashes.get(name) != found.hashes.get(name)]
    if not wrong:
        return ""
    first = wrong[0]
    place = _first_sample(golden.samples, found.samples)
    if place is not None and not first.startswith(("tables", "case", "onboard")):
        row, channel = place
        kept, new = float(golden.samples[channel][row]), float(found.samples[channel][row])
        return f"{channel} at {golden.samples['t_s'][row]:.2f} s: {new!r} is not {kept!r} ({new - kept:+.2g})"
    more = f" and {len(wrong) - 1} more" if len(wrong) > 1 else ""
    return f"{first}{more}"


def _first_sample(golden: np.ndarray, found: np.ndarray) -> tuple[int, str] | None:
    """Row and channel of the first sample that differs, among the channels that both have."""
    rows = min(len(golden), len(found))
    differs = [
        (int(np.argmax(wrong)), channel)
        for channel in golden.dtype.names or ()
        if channel in (found.dtype.names or ())
        and (wrong := golden[channel][:rows].view(np.int64) != found[channel][:rows].view(np.int64)).any()
    ]
    return min(differs, key=lambda place: place[0], default=None)


def read_golden() -> dict[str, Trace]:
    """Return the stored golden traces by name."""
    hashes = json.loads((FOLDER / "hashes.json").read_text(encoding="utf-8"))
    with np.load(FOLDER / "samples.npz", allow_pickle=False) as samples:
        return {name: Trace(found, samples[name]) for name, found in hashes.items()}


def write_golden(traces: Mapping[str, Trace]) -> None:
    """Store traces as the golden ones."""
    FOLDER.mkdir(exist_ok=True)
    hashes = {name: trace.hashes for name, trace in traces.items()}
    (FOLDER / "hashes.json").write_text(json.dumps(hashes, indent=0) + "\n", encoding="utf-8")
    np.savez_compressed(FOLDER / "samples.npz", **{name: trace.samples for name, trace in traces.items()})


def record_parts(name: str) -> Iterator[tuple[str, np.ndarray]]:
    """Every field of the records that a scenario's flight reads, by its path, in order."""
    records = build_records(load_scenario(name))
    for record in ("tables", "case", "onboard"):
        for field in numbers(getattr(records, record), record):
            yield field.path, field.values


def _flight(name: str) -> Trace:
    parts: dict[str, hashlib._Hash] = {}
    for path, values in record_parts(name):
        part = ".".join(path.split(".")[:2])
        parts.setdefault(part, hashlib.sha256()).update(np.ascontiguousarray(values).tobytes())
    hashes = {part: found.hexdigest()[:12] for part, found in parts.items()}
    flight = fly(load_scenario(name))
    telemetry, rows = flight.telemetry, len(flight.telemetry["t_s"])
    for channel, values in telemetry.items():
        hashes[channel] = _digest(np.ascontiguousarray(values, dtype=float).tobytes())
    hashes |= {f"figure {key}": float(value).hex() for key, value in flight.figures.items()}
    hashes["outcome"] = flight.outcome
    kept = np.linspace(0, rows - 1, min(_SAMPLES, rows)).astype(int)
    samples = np.zeros(len(kept), _RECORD)
    for channel in _SAMPLED:
        samples[channel] = telemetry[channel][kept]
    return Trace(hashes, samples)


def _campaign() -> Trace:
    plan = load_plan(CAMPAIGN)
    table = table_of(fly_rows(plan.loaded, plan.cases(0, CASES)))
    columns = {name: repr(table[name].to_pylist()) for name in table.column_names}
    hashes = {f"column {name}": _digest(text.encode()) for name, text in columns.items()}
    return Trace(hashes, np.zeros(0, _RECORD))


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()[:12]
