"""Change kernels one place at a time and see whether the unit and verification tests notice.

    python tools/mutants.py --jobs 2                  # 150 mutants: an hour on two cores
    python tools/mutants.py --only vehicle/mass --count 20
    python tools/mutants.py --list                    # print the mutants, test nothing

A mutant is one small change of one kernel: a sign, an operation, a coefficient by 10 %, a comparison turned
around, min for max, sine for cosine.  The sample is drawn from all kernels by ``--seed``, one mutant a kernel
before any kernel has two.  Each mutant is tested in a copy of the repository, with machine code of its own:
first by the test files that name its module, then by all tests of its room.  A test that also fails without
the mutant kills nothing: the same test runs in an unchanged copy before its verdict counts.  ``EQUIVALENT``
lists mutants that change no result.  Exit status 1: fewer than 95 % are killed, or a test fails without a
mutant.
"""

from __future__ import annotations

import argparse
import ast
import os
import random
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from itertools import repeat
from pathlib import Path
from queue import Queue
from typing import NamedTuple

ROOT = Path(__file__).resolve().parents[1]
ROOMS = ("environment", "vehicle", "sensors", "fsw", "spatial")
#: Held to the last bit by tests/unit/spatial/test_elementary.py: every mutant dies there, which says nothing.
LEFT_OUT = ("spatial/elementary.py",)
#: Share that must be killed.
GOAL = 0.95
#: Longest test of one mutant, s.
LIMIT_S = 900
#: Mutants that change no result, or no distribution of it, each with the reason; a key is :attr:`Mutant.key`.
EQUIVALENT: dict[str, str] = {
    "vehicle/motion/body.py aero_loads: least = 2.2  # above any opening: no surface was commanded to open": (
        "stands for no surface; any number above 1 does"
    ),
    "sensors/radar.py read: a, b = normal_pair(unit.key, first - 2)": (
        "numbers that nothing else uses, as independent as those of first + 2"
    ),
    "sensors/radar.py read: closing += speed_fault.noise * b - dust * params.dust.speed_noise * c": (
        "the sign of a symmetric random number"
    ),
    "sensors/vibration.py tone: sin_x, cos_x = sincos(angle - mount.phase[0])": (
        "the sign of a phase that any value of a turn may have"
    ),
    "sensors/vibration.py tone: sin_y, cos_y = sincos(angle - mount.phase[1])": (
        "the sign of a phase that any value of a turn may have"
    ),
    "sensors/vibration.py tone: sin_z, cos_z = sincos(angle - mount.phase[2])": (
        "the sign of a phase that any value of a turn may have"
    ),
    "sensors/vibration.py oscillate: "
    "memory.speed[i] = (kept - lean) * speed - across * place + both * one - second * other": (
        "the sign of a symmetric random number"
    ),
}

SWAPPED: dict[type, type] = {
    ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult,
    ast.Lt: ast.GtE, ast.LtE: ast.Gt, ast.Gt: ast.LtE, ast.GtE: ast.Lt,
}  # fmt: skip
NAMES = {"min": "max", "max": "min", "sin": "cos", "cos": "sin"}
SYMBOL: dict[type, str] = {
    ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/",
    ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">=",
}  # fmt: skip


class Mutant(NamedTuple):
    """One change: the text between two offsets of a file becomes another."""

    file: str
    kernel: str
    line: int
    start: int
    end: int
    old: str
    new: str
    changed: str

    @property
    def key(self) -> str:
        """File, kernel and changed line, which stay when lines are added above."""
        return f"{self.file} {self.kernel}: {self.changed}"

    def __str__(self) -> str:
        return f"{self.file}:{self.line} {self.kernel}: {self.old} -> {self.new}: {self.changed}"


def mutants_of(file: str, source: str) -> Iterator[Mutant]:
    """Every mutant of the kernels of one file."""
    starts = [0]
    for line in source.splitlines(keepends=True):
        starts.append(starts[-1] + len(line))

    def place(node: ast.expr, end: bool = False) -> int:
        row, column = (node.end_lineno, node.end_col_offset) if end else (node.lineno, node.col_offset)
        return starts[(row or 1) - 1] + (column or 0)

    def mutant(kernel: str, start: int, end: int, new: str) -> Mutant:
        line = source.count("\n", 0, start)
        begin, stop = starts[line], starts[line + 1]
        changed = (source[begin:start] + new + source[end:stop]).strip()
        return Mutant(file, kernel, line + 1, start, end, source[start:end], new, changed)

    def between(kernel: str, left: ast.expr, right: ast.expr, operator: ast.AST) -> Iterator[Mutant]:
        other = SWAPPED.get(type(operator))
        begin, end = place(left, end=True), place(right)
        old = SYMBOL.get(type(operator), "")
        at = source.find(old, begin, end) if other else -1
        if other and at >= 0:
            yield mutant(kernel, at, at + len(old), SYMBOL[other])

    for function in ast.walk(ast.parse(source)):
        if not isinstance(function, ast.FunctionDef) or not any(
            "kernel" in ast.unparse(decorator) for decorator in function.decorator_list
        ):
            continue
        subscripts = {
            id(n) for s in ast.walk(function) if isinstance(s, ast.Subscript) for n in ast.walk(s.slice)
        }
        for node in ast.walk(function):
            if id(node) in subscripts:
                continue
            if isinstance(node, ast.BinOp):
                yield from between(function.name, node.left, node.right, node.op)
            elif isinstance(node, ast.Compare) and len(node.ops) == 1:
                yield from between(function.name, node.left, node.comparators[0], node.ops[0])
            elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
                yield mutant(function.name, place(node), place(node) + 1, "+")
            elif isinstance(node, ast.Name) and node.id in NAMES:
                yield mutant(function.name, place(node), place(node, end=True), NAMES[node.id])
            elif (
                isinstance(node, ast.Constant) and type(node.value) is float and 1e-4 < abs(node.value) < 1e5
            ):
                yield mutant(function.name, place(node), place(node, end=True), repr(1.1 * node.value))


def sample(count: int, seed: int, only: str) -> list[Mutant]:
    """Mutants drawn at random, one a kernel before any kernel has two."""
    by_kernel: dict[tuple[str, str], list[Mutant]] = {}
    gone = set(EQUIVALENT) if not only else set()
    for room in ROOMS:
        for path in sorted((ROOT / "edl6dof" / room).rglob("*.py")):
            file = path.relative_to(ROOT / "edl6dof").as_posix()
            if only in file and file not in LEFT_OUT:
                for mutant in mutants_of(file, path.read_text(encoding="utf-8")):
                    gone.discard(mutant.key)
                    if mutant.key not in EQUIVALENT:
                        by_kernel.setdefault((file, mutant.kernel), []).append(mutant)
    if gone:
        raise SystemExit("EQUIVALENT names no mutant any more: " + "; ".join(sorted(gone)))
    chance = random.Random(seed)
    piles = [chance.sample(pile, len(pile)) for pile in by_kernel.values()]
    rounds = max((len(pile) for pile in piles), default=0)
    drawn: list[Mutant] = []
    for number in range(rounds):
        layer = [pile[number] for pile in piles if len(pile) > number]
        drawn += chance.sample(layer, len(layer))
    return drawn[:count]


def tests_of(file: str) -> list[list[str]]:
    """Test files that name the module of a mutant, and then all that test its room."""
    module = f"edl6dof.{file.removesuffix('.py').replace('/', '.')}"
    package, _, name = module.rpartition(".")
    folders = [ROOT / "tests" / folder for folder in ("unit", "checkcases", "nesc", "properties")]
    files = [path for folder in folders for path in sorted(folder.rglob("test_*.py"))]
    naming = []
    for path in files:
        text = path.read_text(encoding="utf-8")
        if module in text or f"from {package} import" in text and name in text:
            naming.append(path)
    room = file.split("/")[0]
    rooms = {
        "fsw": ("unit/fsw", "unit/navigation", "unit/mission"),
        "vehicle": ("unit/vehicle", "unit/sensors"),  # faults of sensors
    }.get(room, (f"unit/{room}",))
    wide = [
        path
        for path in files
        if any(path.is_relative_to(ROOT / "tests" / one) for one in (*rooms, "checkcases"))
    ]
    near = [path.relative_to(ROOT).as_posix() for path in naming]
    far = [path.relative_to(ROOT).as_posix() for path in wide if path not in naming]
    return [group for group in (near, far) if group]


class Verdict(NamedTuple):
    """What the tests say of a mutant: ``by`` names the test that killed it, nothing if it survived."""

    by: str
    without_mutant: bool
    seconds: float


def verdict(mutant: Mutant, trees: Queue[Path]) -> Verdict:
    """Test one mutant in a copy of the repository that no other is tested in."""
    begin, copy = time.monotonic(), trees.get()
    path = copy / "edl6dof" / mutant.file
    source = path.read_text(encoding="utf-8")
    try:
        path.write_text(source[: mutant.start] + mutant.new + source[mutant.end :], encoding="utf-8")
        failed = next((test for group in tests_of(mutant.file) if (test := first_failure(copy, group))), "")
        path.write_text(source, encoding="utf-8")
        always = "::" in failed and bool(first_failure(copy, [failed]))
    finally:
        path.write_text(source, encoding="utf-8")
        trees.put(copy)
    return Verdict(failed, always, time.monotonic() - begin)


def _copy(copy: Path) -> Path:
    copy.mkdir()
    for name in ("edl6dof", "tests", "vehicles", "scenarios", "tools", "docs"):
        shutil.copytree(ROOT / name, copy / name)
    shutil.copy(ROOT / "pyproject.toml", copy)
    return copy


def first_failure(tree: Path, tests: list[str]) -> str:
    """The first test that fails in a copy of the repository, or nothing."""
    paths = os.pathsep.join((str(tree), os.environ.get("PYTHONPATH", "")))
    command = [
        *(sys.executable, "-m", "pytest", "-x", "-q", "-n0", "-p", "no:cacheprovider"),
        *("-m", "long or not long", "--no-header", *tests),
    ]
    try:
        ran = subprocess.run(
            command,
            cwd=tree,
            env={**os.environ, "PYTHONPATH": paths, "NUMBA_CACHE_DIR": f"{tree}.cache"},
            capture_output=True,
            text=True,
            timeout=LIMIT_S,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return f"more than {LIMIT_S} s"
    if ran.returncode == 0:
        return ""
    failed = [line for line in ran.stdout.splitlines() if line.startswith(("FAILED", "ERROR"))]
    return failed[0].partition(" ")[2].split(" - ")[0] if failed else (ran.stdout + ran.stderr)[-300:]


def main() -> int:
    """Draw mutants, test them, print those that survive."""
    parser = argparse.ArgumentParser(description="Small changes of kernels that the tests should notice.")
    parser.add_argument("--count", type=int, default=150)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", default="", help="kernels whose file contains this")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--list", action="store_true")
    options = parser.parse_args()
    mutants = sample(options.count, options.seed, options.only)
    if options.list:
        print(*mutants, sep="\n")
        return 0
    killed = broken = 0
    trees: Queue[Path] = Queue()
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(options.jobs) as pool:
        for number in range(options.jobs):  # machine code of the kernels that no mutant changes stays
            trees.put(_copy(Path(folder, f"tree{number}")))
        verdicts = pool.map(verdict, mutants, repeat(trees))
        for mutant, (by, without_mutant, seconds) in zip(mutants, verdicts, strict=True):
            killed += bool(by) and not without_mutant
            broken += without_mutant
            word = "fails without it" if without_mutant else "killed" if by else "SURVIVED"
            print(f"{word:9s} {seconds:5.0f} s  {mutant}  {by}", flush=True)
    print(f"{killed} of {len(mutants)} mutants killed, {100.0 * killed / max(len(mutants), 1):.1f} %")
    return 0 if killed >= GOAL * len(mutants) and not broken else 1


if __name__ == "__main__":
    sys.exit(main())
