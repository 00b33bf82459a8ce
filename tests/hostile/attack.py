"""Attack the program: thousands of attempts of one kind, in many processes; every failure is printed, and one
line says how all ended.

    python tests/hostile/attack.py KIND --number 2000 --seed 1 --jobs 2

``lines``: text files with changed lines; ``trees``: YAML, tables and DAVE-ML taken apart and put together in
another way; ``kills``: campaigns and flights killed at a random moment, and flown again; ``damage``: damaged
runs, campaigns, saved states, tables and terrain; ``received``: folders with a plugin that nobody accepted.

Each worker is a process that takes many attempts, so that even a crash of compiled code or a hang is found
and named.  Any attempt can be had again by its seed and number: ``--only 137``.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import chdir
from importlib import import_module
from pathlib import Path

sys.path.extend(map(str, Path(__file__).resolve().parents[:2]))

from attempt import SECONDS, Ended
from command import ROOT

#: Kinds of attacks, and how many attempts one process takes at most.
KINDS = {"lines": 50, "trees": 50, "kills": 4, "damage": 25, "received": 5}

Attempt = Callable[[int, int, Path], Iterator[Ended]]


def tried(attempt: Attempt, number: int, seed: int) -> Iterator[Ended]:
    """The commands of one attempt, in an empty folder that is the current one."""
    with tempfile.TemporaryDirectory(prefix="attack-") as home, chdir(home):
        os.environ["XDG_CONFIG_HOME"] = f"{home}/.settings"
        yield from attempt(number, seed, Path(home))


def attempt_of(kind: str) -> Attempt:
    """What tries a kind of attack."""
    found: Attempt = import_module(f"attack_{kind}").attempt
    return found


def worker(kind: str, seed: int, numbers: list[int]) -> None:
    """Try attempts in this process; a line of JSON before each, which may be the last, and after each
    command.
    """
    for number in numbers:
        print(json.dumps({"begin": number}), flush=True)
        for words, status, wrong, *_ in tried(attempt_of(kind), number, seed):
            result = {"number": number, "words": words, "status": status, "wrong": wrong}
            print(json.dumps(result), flush=True)


def batch(kind: str, seed: int, numbers: list[int]) -> list[dict]:
    """Results of some attempts, tried in a process of their own; one that kills the process is named, the
    others go on.
    """
    results: list[dict] = []
    while numbers:
        words = [sys.executable, __file__, kind, "--seed", str(seed)]
        words += ["--worker", ",".join(map(str, numbers))]
        environment = {**os.environ, "PYTHONPATH": str(ROOT), "COLUMNS": "80"}
        try:
            done = subprocess.run(
                words, capture_output=True, text=True, env=environment, cwd=ROOT, timeout=SECONDS * 10
            )
            output, how = done.stdout, f"the process died with {done.returncode}: {done.stderr[-500:]}"
        except subprocess.TimeoutExpired as error:
            output, how = (error.stdout or b"").decode(), "no end in sight"
        lines = [json.loads(line) for line in output.splitlines() if line.startswith("{")]
        results += [line for line in lines if "status" in line]
        begun = [line["begin"] for line in lines if "begin" in line]
        if len(begun) == len(numbers) and how.startswith("the process died with 0"):
            break
        last = begun[-1] if begun else numbers[0]
        results.append({"number": last, "words": [], "status": -1, "wrong": how})
        numbers = numbers[numbers.index(last) + 1 :]
    return results


def run(kind: str, number: int, seed: int, jobs: int) -> list[dict]:
    """Make so many attempts in ``jobs`` processes at a time; all results."""
    size = max(1, min(KINDS[kind], number // jobs))
    portions = [list(range(k, min(k + size, number))) for k in range(0, number, size)]
    with ThreadPoolExecutor(jobs) as pool:
        return [one for found in pool.map(lambda part: batch(kind, seed, part), portions) for one in found]


def main() -> int:
    """The long run, from the command line."""
    parser = argparse.ArgumentParser(description="Attack edl6dof.")
    parser.add_argument("kind", choices=KINDS)
    parser.add_argument("--number", type=int, default=2000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--only", type=int, help="one attempt, in this process, with what it prints")
    parser.add_argument("--worker", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.worker:
        worker(options.kind, options.seed, list(map(int, options.worker.split(","))))
        return 0
    if options.only is not None:
        for done in tried(attempt_of(options.kind), options.only, options.seed):
            print(done.words, done.status, done.stderr, done.wrong or "as it should", sep="\n")
        return 0
    results = run(options.kind, options.number, options.seed, options.jobs)
    wrong = [result for result in results if result["wrong"]]
    for result in wrong:
        print(f"--- attempt {result['number']}: {' '.join(result['words'])[:300]}\n{result['wrong']}")
    ends = Counter(f"{(result['words'] or ['?'])[0]} {result['status']}" for result in results)
    print(
        f"{options.kind}: {options.number} attempts (seed {options.seed}), {len(results)} commands, "
        f"{len(wrong)} wrong; status by command: {dict(sorted(ends.items()))}"
    )
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
