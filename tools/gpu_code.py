"""GPU code of the flight, made without a GPU: whether the loop still becomes device code, how large it is,
how many registers it takes and what it spills.

    python tools/gpu_code.py --part derivative   # the equations of motion: half a minute of one core
    python tools/gpu_code.py                     # the closed loop, as edl6dof campaign --engine gpu flies it
    python tools/gpu_code.py --part loop-with-eyes   # and with images and maps
    python tools/gpu_code.py --no-assembly       # as far as PTX

It needs `pip install 'edl6dof[gpu]'`, which brings NVVM and the assembler of CUDA.  Exit status 1: no code
could be made.
"""

from __future__ import annotations

import argparse
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numba
from numba import cuda, types
from numba.cuda import dispatcher

from edl6dof.campaign.gpu.entry import fly_flights
from edl6dof.campaign.gpu.layouts import LEAN, WHOLE_LOG, Layout
from edl6dof.fsw.onboard import ONBOARD
from edl6dof.metrics.telling_rows import TELLING
from edl6dof.scenario.case import CASE
from edl6dof.scenario.records import TABLES
from edl6dof.telemetry.channels import BRIEF, TICK
from edl6dof.vehicle.motion.runge_kutta import evaluate
from edl6dof.vehicle.plant import OUTPUTS, STATE, WORKSPACE


def derivative(cases, tables_, plants, outputs_, works):
    """What a thread of the GPU runs: the equations of motion of one vehicle."""
    i = cuda.grid(1)
    if i < len(plants):
        evaluate(cases[i], tables_[0], plants[i], outputs_[i], works[i])


def records(layout: Any) -> types.Array:
    """Type of an array of records on the GPU."""
    return numba.from_dtype(layout)[::1]


def lines(layout: Any) -> types.Array:
    """Type of an array with a line of records for each flight."""
    return numba.from_dtype(layout)[:, ::1]


#: Functions that are named.
MOST = 12
WHOLE, MANY = types.int64, types.int64[::1]


def loop(layout: Layout) -> tuple[Callable[..., Any], list[types.Type]]:
    """The closed loop, for records of a layout."""
    case, *changing = layout.own.values()
    return fly_flights.py_func, [
        *(records(case), records(ONBOARD), MANY, records(TABLES), MANY),
        *(records(kind) for kind in changing),
        *(MANY, MANY, MANY, WHOLE, WHOLE, lines(TICK), lines(BRIEF)),
        *(records(TELLING), MANY, types.int8[:, ::1], WHOLE),
    ]


#: What is compiled, and for which arguments.
PARTS: dict[str, tuple[Callable[..., Any], list[types.Type]]] = {
    "derivative": (derivative, [records(d) for d in (CASE, TABLES, STATE, OUTPUTS, WORKSPACE)]),
    "loop": loop(LEAN),
    "loop-with-eyes": loop(WHOLE_LOG),
}


def ptx_of(part: str, capability: tuple[int, int]) -> str:
    """PTX of a part."""
    function, arguments = PARTS[part]
    # a device function is compiled for the GPU of the machine, and here there is none to be asked
    dispatcher.get_current_device = lambda: SimpleNamespace(compute_capability=capability)
    text, _ = cuda.compile_ptx(function, types.void(*arguments), device=False, cc=capability)
    return text


def assembler() -> str:
    """Path of ptxas: that of the wheel, or one on the path."""
    for folder in sys.path:
        found = Path(folder) / "nvidia/cuda_nvcc/bin/ptxas"
        if found.is_file():
            return str(found)
    return "ptxas"


def assembled(text: str, capability: tuple[int, int]) -> str:
    """What the assembler says of each function."""
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder) / "flight.ptx"
        source.write_text(text)
        words = [
            assembler(),
            "-v",
            f"-arch=sm_{capability[0]}{capability[1]}",
            str(source),
            "-o",
            f"{source}.cubin",
        ]
        return subprocess.run(words, check=True, capture_output=True, text=True).stderr


def summary(report: str) -> str:
    """Registers and stack of the entry, how many functions spill and how much, and those that spill most."""
    registers = max(map(int, re.findall(r"Used (\d+) registers", report)), default=0)
    stack = max(map(int, re.findall(r"(\d+) bytes cumulative stack", report)), default=0)
    found = re.findall(
        r"properties for (\S+)\s+\d+ bytes stack frame, (\d+) bytes spill stores, (\d+) bytes spill loads",
        report,
    )
    spills = sorted(((int(a) + int(b), plain(name)) for name, a, b in found), reverse=True)
    most, spilling = max(spills, default=(0, ""))[0], sum(spill > 0 for spill, _ in spills)
    words = (
        f"{registers} registers, {stack} bytes of stack; {len(spills)} functions, {spilling} of them spill, "
        f"at most {most} bytes"
    )
    return "\n".join([words, *(f"{spill:8} bytes by {name}" for spill, name in spills[:MOST] if spill)])


def plain(mangled: str) -> str:
    """Module and name of a function: parts of the mangled name, each behind its length."""
    parts, rest = [], mangled.removeprefix("_ZN")
    while length := re.match(r"\d+", rest):
        end = length.end() + int(length[0])
        parts.append(rest[length.end() : end])
        rest = rest[end:]
    return ".".join(parts) or mangled


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--part", choices=PARTS, default="loop")
    parser.add_argument("--capability", default="9.0", metavar="X.Y", help="of the GPU")
    parser.add_argument("--no-assembly", action="store_true")
    options = parser.parse_args()
    major, minor = map(int, options.capability.split("."))
    start = time.process_time()
    try:
        text = ptx_of(options.part, (major, minor))
    except numba.core.errors.NumbaError as error:
        print(f"no GPU code of the {options.part}: {str(error)[-2000:]}", file=sys.stderr)
        return 1
    print(
        f"{options.part}: {len(text) / 1e6:.1f} MB of PTX in {time.process_time() - start:.0f} s of CPU time"
    )
    if not options.no_assembly:
        start = time.perf_counter()
        print(summary(assembled(text, (major, minor))))
        print(f"assembled in {time.perf_counter() - start:.0f} s")
    return 0


if __name__ == "__main__":
    sys.exit(main())
