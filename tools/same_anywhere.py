"""Whether flights have the same bits on other processors, which this machine can be told to be.

    python tools/same_anywhere.py                       # some scenarios under every processor
    python tools/same_anywhere.py --all                 # every golden flight
    python tools/same_anywhere.py --processor haswell --scenario msl

Each processor is emulated in a process of its own by the variables with which OpenBLAS, numpy, the C library
and numba choose their code.  All fields of the records, all channels of telemetry and all figures are
compared byte for byte with those of this machine as it is.  The first that differs is named, with its index
and the largest difference.  ``sse2`` and ``x86-64-v3`` recompile everything, some minutes each.

Exit status 1: something differs.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np

#: What makes a process take the code of another processor.
PROCESSORS: dict[str, dict[str, str]] = {
    **{
        core.lower(): {"OPENBLAS_CORETYPE": core}
        for core in ("Prescott", "Nehalem", "Sandybridge", "Haswell", "SkylakeX", "Zen")
    },
    "no-avx512": {"NPY_DISABLE_CPU_FEATURES": "X86_V4 AVX512_ICL"},
    "libm-without-fma": {"GLIBC_TUNABLES": "glibc.cpu.hwcaps=-FMA,-AVX2,-FMA4"},
    "sse2": {"NUMBA_CPU_NAME": "generic", "NUMBA_CPU_FEATURES": ""},
    "x86-64-v3": {"NUMBA_CPU_NAME": "x86-64-v3", "NUMBA_CPU_FEATURES": ""},
}
SCENARIOS = ("tianwen1", "tianwen1_hazards", "msl_landing", "phoenix")


def write_flight(name: str, file: Path) -> None:
    """Fly a scenario and write everything it gives: records, telemetry by channel, figures."""
    from edl6dof.scenario.loading import load_scenario
    from edl6dof.sim.flight import fly
    from edl6dof.verify.golden import CAMPAIGN, record_parts, traced

    if name == CAMPAIGN:
        np.savez(file, **{key: np.array(value) for key, value in traced(name).hashes.items()})
        return
    found = {path.replace(".", "/", 1): values for path, values in record_parts(name)}
    flight = fly(load_scenario(name))
    found |= {f"telemetry/{channel}": values for channel, values in flight.telemetry.items()}
    found |= {f"figure/{key}": np.array(value) for key, value in flight.figures.items()}
    plain = {key: values.astype(values.dtype.str) for key, values in found.items()}  # without metadata
    np.savez(file, **{f"{k:05d}|{key}": values for k, (key, values) in enumerate(plain.items())})


def difference(here: Path, there: Path) -> str:
    """The first field that differs between two files of :func:`write_flight`, or nothing."""
    with np.load(here) as own, np.load(there) as other:
        for key in own.files:
            name = key.partition("|")[2] or key
            if key not in other.files:
                return f"{name} is missing"
            a, b = own[key], other[key]
            if a.shape != b.shape:
                return f"{name} has shape {b.shape}, not {a.shape}"
            if a.tobytes() != b.tobytes():
                return f"{name}{_place(a, b, own)}"
    return ""


def _place(a: np.ndarray, b: np.ndarray, flight: object) -> str:
    if a.dtype.kind != "f" or a.ndim == 0:
        return f": {b} is not {a}"
    where = np.argwhere((a != b) & ~(np.isnan(a) & np.isnan(b)))
    if not len(where):
        return ": bytes of NaN or of a zero's sign"
    first = tuple(where[0])
    size = np.nanmax(np.abs(a[tuple(where.T)] - b[tuple(where.T)]))
    values = f"{float(b[first])!r} is not {float(a[first])!r}"
    return f"{list(map(int, first))}: {values} ({len(where)} values differ, by {size:.2g} at most)"


def fly_as(processor: str, scenarios: Sequence[str], folder: Path) -> Path:
    """Fly scenarios in a process that takes itself for another processor; returns where their files are."""
    into = folder / processor
    into.mkdir()
    environment = {**os.environ, **PROCESSORS.get(processor, {})}
    command = [sys.executable, __file__, "--into", str(into), *(f"--scenario={name}" for name in scenarios)]
    subprocess.run(command, env=environment, check=True)
    return into


def file_of(scenario: str) -> str:
    """Name of a scenario's file."""
    return f"{scenario.replace('/', '_')}.npz"


def main() -> int:
    """Compare, or fly as a child."""
    parser = argparse.ArgumentParser(description="The same bits on other processors.")
    parser.add_argument("--processor", action="append", choices=sorted(PROCESSORS))
    parser.add_argument("--scenario", action="append")
    parser.add_argument("--all", action="store_true", help="every golden flight, and the golden campaign")
    parser.add_argument("--into", type=Path, help=argparse.SUPPRESS)
    options = parser.parse_args()
    scenarios = options.scenario or SCENARIOS
    if options.into:
        for scenario in scenarios:
            write_flight(scenario, options.into / file_of(scenario))
        return 0
    from edl6dof.verify.golden import golden_names

    scenarios = golden_names() if options.all else scenarios
    wrong = 0
    with tempfile.TemporaryDirectory() as folder:
        here = fly_as("this machine", scenarios, Path(folder))
        for processor in options.processor or PROCESSORS:
            there = fly_as(processor, scenarios, Path(folder))
            found = {name: difference(here / file_of(name), there / file_of(name)) for name in scenarios}
            for name, text in found.items():
                if text:
                    print(f"{processor:<18} {name:<24} {text}")
            alike = sum(not text for text in found.values())
            print(f"{processor:<18} {alike} of {len(found)} identical", flush=True)
            wrong += alike < len(found)
            shutil.rmtree(there)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
