"""Speed and memory of edl6dof, and its speed beside JSBSim and Basilisk.

    python tools/bench.py                                    # everything, some minutes, the first compiling
    python tools/bench.py --only loop --in-place             # quick, with the repository's own cache
    python tools/bench.py --json bench.json                  # all samples, and the machine

The sections (``--only`` chooses):

processes   whole processes as a user starts them, not pinned: ``edl6dof fly tianwen1`` with all files
            written, ``--help``, ``import edl6dof``; wall seconds and peak resident memory.  The package is
            first copied into an empty folder, so the first flight compiles everything (the copy's cache is
            empty) and later edits of the sources disturb nothing.
loop        the nominal flight in this process, pinned to one core: the compiled loop alone, in turn with that
            of the landing among rocks; ``edl6dof.fly`` (records + loop), and ``edl6dof.load`` (reading and
            validating the files).  Then where the time of a cycle goes: by mission phase, and by the
            difference of flights with and without a part.
peers       JSBSim's and Basilisk's nearest case and ours in turn (ABAB...), pinned to one core; ratios are
            formed pair by pair.  The peers come with ``pip install "edl6dof[bench]"``; a missing one is
            reported and left out.
precision   simulated seconds per CPU second against the error of free entries, of all three programs: what
            counts for a user, as steps of different methods are not worth the same.

How to read it. A step is one integration step of a cycle; steps that events, a canopy or the ground split are
not counted. Seconds are CPU seconds where it says so: on a machine with other work they are what repeats,
wall seconds are not. No peer flies the whole chain, so every case of theirs contains less than our flight
(``tools/peers_*.py`` list what they lack). A second case is therefore ours with an empty mission, the
like of a ballistic entry ("free entry": 6-DOF, Runge-Kutta, the same vehicle, atmosphere, wind, navigation
and 50 Hz log, but no guidance, control or events). JSBSim evaluates the forces once a step, Basilisk four
times, edl6dof four times and once more in every cycle of the flight software; the last column compares
evaluations a second.
"""

from __future__ import annotations

import argparse
import importlib
import json
import math
import os
import platform
import statistics
import subprocess
import sys
import tempfile
import time
from collections import defaultdict
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from bench_boxes import measure_boxes
from bench_precision import draw_precision, measure_precision
from bench_processes import ROOT, SCENARIO, Lap, measure_processes, snapshot
from bench_tables import show_boxes, show_comparison, show_laps, show_phases, show_precision
from rich.console import Console

SECTIONS = ("processes", "loop", "peers", "precision")
PEERS = ("peers_jsbsim", "peers_basilisk")
#: Landing area, lidar, stereo cameras and landing camera: hazard detection.
AMONG_ROCKS = "tianwen1_hazards"
FREE_ENTRY = ("mission.phases=[]", "simulation.time_limit_s=250")
PROFILE_CHUNK_S = 0.2


@dataclass
class Calls:
    """What the calls of the compiled loop inside :func:`timed_loop` cost."""

    wall_s: float = 0.0
    cpu_s: float = 0.0
    cycles: int = 0
    by_phase: dict[int, list[float]] = field(default_factory=lambda: defaultdict(lambda: [0.0, 0.0]))


def stopwatch(work: Callable[[], Any]) -> tuple[Lap, Any]:
    """Wall and CPU seconds of ``work()``, and its result."""
    wall, cpu = time.perf_counter(), time.process_time()
    result = work()
    return Lap(time.perf_counter() - wall, time.process_time() - cpu), result


# ---------------------------------------------------------------- the loop in this process


@contextmanager
def timed_loop(chunk_s: float | None = None) -> Iterator[Calls]:
    """Time every call of the compiled loop that ``edl6dof.fly`` makes; ``chunk_s`` changes how much one call
    flies.
    """
    import edl6dof.sim.flight as flight
    import edl6dof.sim.flight_state as flight_state

    calls, compiled, chunk = Calls(), flight_state.fly_cycles, flight.QUIET_CHUNK_S

    def timed(*arguments: Any) -> Any:
        phase = _phase_in(arguments)
        lap, result = stopwatch(lambda: compiled(*arguments))
        calls.wall_s += lap.wall_s
        calls.cpu_s += lap.cpu_s
        calls.cycles += result[1]
        calls.by_phase[phase][0] += lap.cpu_s
        calls.by_phase[phase][1] += result[1]
        return result

    flight_state.fly_cycles, flight.QUIET_CHUNK_S = timed, chunk_s or chunk
    try:
        yield calls
    finally:
        flight_state.fly_cycles, flight.QUIET_CHUNK_S = compiled, chunk


def _phase_in(arguments: tuple[Any, ...]) -> int:
    """Mission phase in the memory of the flight software, which is one of the record arrays."""
    from edl6dof.fsw.onboard import FSW

    return next(int(a["mission"]["phase"][0]) for a in arguments if getattr(a, "dtype", None) == FSW)


def fly_once(loaded: Any) -> tuple[Lap, Lap]:
    """One flight: cost of the compiled loop, cost of the whole ``edl6dof.fly``."""
    import edl6dof

    with timed_loop() as calls:
        whole, _ = stopwatch(lambda: edl6dof.fly(loaded))
    whole.steps = calls.cycles * loaded.scenario.steps_per_cycle
    return Lap(calls.wall_s, calls.cpu_s, whole.steps), whole


def measure_loop(repeats: int) -> dict[str, list[Lap]]:
    """Laps by name, the flights in turn, after one of each to load the compiled code."""
    import edl6dof

    loaded, among_rocks = edl6dof.load(SCENARIO), edl6dof.load(AMONG_ROCKS)
    fly_once(loaded)
    fly_once(among_rocks)
    rounds = [(fly_once(loaded), fly_once(among_rocks)[0]) for _ in range(repeats)]
    pairs = [pair for pair, _ in rounds]
    return {
        "compiled loop": [loop for loop, _ in pairs],
        f"the same, {AMONG_ROCKS}": [loop for _, loop in rounds],
        "edl6dof.fly(loaded)": [whole for _, whole in pairs],
        "edl6dof.load": [stopwatch(lambda: edl6dof.load(SCENARIO))[0] for _ in range(repeats)],
    }


def measure_phases(repeats: int) -> list[dict[str, Any]]:
    """Cost of a step in each mission phase: chunks of 0.2 s, each counted to the phase it begins in."""
    import edl6dof

    loaded = edl6dof.load(SCENARIO)
    steps = loaded.scenario.steps_per_cycle
    samples: dict[int, list[float]] = defaultdict(list)
    cycles: dict[int, float] = {}
    for lap in range(repeats + 1):
        with timed_loop(PROFILE_CHUNK_S) as calls:
            edl6dof.fly(loaded)
        for phase, (seconds, flown) in calls.by_phase.items():
            cycles[phase] = flown
            if lap:  # the first loads the compiled code
                samples[phase].append(1e9 * seconds / (flown * steps))
    total = sum(statistics.median(samples[phase]) * cycles[phase] for phase in samples)
    return [
        {
            "phase": loaded.scenario.mission.phases[phase].name,
            "flown_s": cycles[phase] / loaded.scenario.flight_software.rates.base_hz,
            "ns_per_step": samples[phase],
            "share": statistics.median(samples[phase]) * cycles[phase] / total,
        }
        for phase in sorted(samples)
    ]


# ---------------------------------------------------------------- beside the peers


def compare(peer: Any, repeats: int) -> dict[str, Any]:
    """Peer, our flight and our free entry in turn, after a round that warms up; short runs, which are
    noisier, more often.
    """
    import edl6dof

    ours = {
        "edl6dof, whole flight": edl6dof.load(SCENARIO),
        "edl6dof, free entry": edl6dof.load(SCENARIO, FREE_ENTRY),
    }
    for loaded in ours.values():
        fly_once(loaded)
    wall, _, end = peer.run()
    laps: dict[str, list[Lap]] = {peer.NAME: [], **{name: [] for name in ours}}
    for _ in range(repeats * max(1, min(5, math.ceil(0.3 / wall)))):
        wall, cpu, end = peer.run()
        laps[peer.NAME].append(Lap(wall, cpu, peer.STEPS))
        for name, loaded in ours.items():
            laps[name].append(fly_once(loaded)[0])
    evaluations = 4.0 + 1.0 / next(iter(ours.values())).scenario.steps_per_cycle
    return {
        "version": peer.version(),
        "case": peer.CASE,
        "has": peer.HAS,
        "lacks": peer.LACKS,
        "ended": end,
        "evaluations_ratio": evaluations / peer.FORCE_EVALUATIONS_A_STEP,
        "laps": laps,
    }


# ---------------------------------------------------------------- all of it


def machine() -> dict[str, Any]:
    """Where this was measured."""
    from importlib.metadata import version

    info = Path("/proc/cpuinfo")
    lines = info.read_text(encoding="utf-8").splitlines() if info.exists() else []
    models = [line.split(":")[1].strip() for line in lines if line.startswith("model name")]
    git = subprocess.run(
        ["git", "-C", str(ROOT), "describe", "--always", "--dirty"],
        capture_output=True,
        text=True,
        check=False,
    )
    return {
        "cpu": models[0] if models else platform.processor(),
        "cores": os.cpu_count(),
        "python": platform.python_version(),
        "numba": version("numba"),
        "numpy": version("numpy"),
        "commit": git.stdout.strip(),
        "load_average": os.getloadavg()[0],
        "date": time.strftime("%Y-%m-%d %H:%M"),
    }


def bench(console: Console, options: argparse.Namespace, tree: Path) -> dict[str, Any]:
    """Run the chosen sections; returns everything measured."""
    results: dict[str, Any] = {"machine": machine()}
    console.print(", ".join(f"{name} {value}" for name, value in results["machine"].items()))
    if "processes" in options.only:
        results["processes"] = measure_processes(tree, options.repeats, cold=not options.in_place)
        show_laps(console, "Whole processes", results["processes"])
    sys.path.insert(0, str(tree))
    os.environ.pop("NUMBA_CACHE_DIR", None)
    os.sched_setaffinity(0, {options.core})
    if "loop" in options.only:
        results["loop"] = measure_loop(options.repeats)
        show_laps(console, f"The nominal flight, in process, core {options.core}", results["loop"])
        results["phases"] = measure_phases(options.repeats)
        show_phases(console, results["phases"])
        results["boxes"] = measure_boxes(SCENARIO, options.repeats)
        show_boxes(console, results["boxes"])
    if "peers" in options.only:
        results["peers"] = {}
        for name in PEERS:
            peer = importlib.import_module(name)
            try:
                peer.version()
                results["peers"][peer.NAME] = compare(peer, options.repeats)
            except ImportError as error:
                console.print(
                    f'{peer.NAME}: left out ({error}); the peers come with  pip install "edl6dof\\[bench]"'
                )
            except FloatingPointError as error:
                console.print(f"{peer.NAME}: no comparison; {error}")
            else:
                show_comparison(console, peer.NAME, results["peers"][peer.NAME])
    if "precision" in options.only:
        results["precision"] = measure_precision(max(1, options.repeats // 2))
        show_precision(console, results["precision"])
        if options.picture:
            draw_precision(results["precision"].programs, options.picture)
    results["machine"]["load_average_after"] = os.getloadavg()[0]
    console.print(
        f"load average afterwards {os.getloadavg()[0]:.2f}; above 1 or so, trust CPU seconds and ratios only"
    )
    return results


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", nargs="+", choices=SECTIONS, default=list(SECTIONS), help="sections to run")
    parser.add_argument(
        "--repeats", type=int, default=7, metavar="N", help="repetitions of each measurement (7)"
    )
    parser.add_argument(
        "--core",
        type=int,
        default=max(os.sched_getaffinity(0)),
        metavar="K",
        help="core to pin to (the last)",
    )
    parser.add_argument(
        "--in-place",
        action="store_true",
        help=("use the repository and its cache; no first-flight measurement"),
    )
    parser.add_argument("--picture", type=Path, metavar="FILE", help="draw the work-precision diagram")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write all samples")
    options = parser.parse_args()
    console = Console(highlight=False, width=None if sys.stdout.isatty() else 150)
    with tempfile.TemporaryDirectory(prefix="edl6dof-bench-") as folder:
        results = bench(console, options, ROOT if options.in_place else snapshot(Path(folder)))
    if options.json:
        options.json.write_text(json.dumps(results, indent=1, default=asdict), encoding="utf-8")


if __name__ == "__main__":
    main()
