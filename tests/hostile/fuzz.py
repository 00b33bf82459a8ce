"""Give the program thousands of mutated inputs; every one must end with a status of its own and a message,
never with a traceback.

    python tests/hostile/fuzz.py --mutations 2000 --seed 1 --jobs 2

Each worker is a process that takes many mutations, so that even a crash of compiled code or a hang is found
and named.  What the check lets pass is flown for two seconds.  Any finding can be had again by its seed and
number: ``--only 137``.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

sys.path.extend(map(str, Path(__file__).resolve().parents[:2]))

from command import ROOT
from in_process import called
from mutations import SHORT, mutant

#: Mutations that one process takes, and the seconds that each may last.
BATCH, SECONDS = 50, 60.0

#: Exit statuses that an input may bring about: done, not within limits, refused.
ALLOWED = (0, 1, 2)


def tried(number: int, seed: int, paths: list[str]) -> Iterator[tuple[list[str], int, str]]:
    """The commands of one mutation with exit status, and what is wrong with how they ended (empty when
    nothing is).
    """
    with tempfile.TemporaryDirectory(prefix="fuzz-") as home:
        folder = Path(home) / "input"
        folder.mkdir()
        os.chdir(folder)
        words = mutant(number, seed, folder, paths)
        status, wrong = _ended(words, folder)
        yield words, status, wrong
        if words[0] == "check" and status == 0 and "tianwen1_mc" not in words:
            words = ["fly", *words[1:], *SHORT, "--no-replay", "-q", "--out", str(Path(home) / "run")]
            status, wrong = _ended(words, folder)
            kept = (Path(home) / "run" / "telemetry.parquet").is_file()
            yield (
                words,
                status,
                wrong
                or (
                    "" if kept == (status != 2) else ("telemetry is lost, or a refused flight left something")
                ),
            )
        os.chdir(ROOT)


def _ended(words: list[str], folder: Path) -> tuple[int, str]:
    before, began = set(folder.iterdir()), time.monotonic()
    try:
        done = called(*words)
    except BaseException as error:  # what the program itself would have let through
        return 70, f"{type(error).__name__}: {error}"
    text = done.stdout + done.stderr
    if done.returncode not in ALLOWED or "Traceback" in text:
        return done.returncode, f"ended with {done.returncode}: {text[-600:]}"
    if done.returncode == 2 and not done.stderr.strip():
        return 2, "refused without a word"
    if done.returncode == 2 and set(folder.iterdir()) != before:
        return 2, f"left behind: {set(folder.iterdir()) - before}"
    if any(not (ch.isprintable() or ch == "\n") for ch in done.stderr):
        return done.returncode, f"control characters: {done.stderr[:200]!r}"
    return (
        done.returncode,
        f"took {time.monotonic() - began:.0f} s" if time.monotonic() - began > SECONDS else "",
    )


def worker(seed: int, numbers: list[int]) -> None:
    """Try mutations in this process; a line of JSON before each (it may be the last) and after each
    command.
    """
    paths = [row["path"] for row in json.loads(called("params", "--json").stdout)]
    for number in numbers:
        print(json.dumps({"begin": number}), flush=True)
        for words, status, wrong in tried(number, seed, paths):
            print(
                json.dumps({"number": number, "words": words, "status": status, "wrong": wrong}), flush=True
            )


def batch(seed: int, numbers: list[int]) -> list[dict]:
    """Results of some mutations, tried in a process of their own; one that kills the process is named, the
    others go on.
    """
    results: list[dict] = []
    while numbers:
        words = [sys.executable, __file__, "--seed", str(seed), "--worker", ",".join(map(str, numbers))]
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
        if (
            len(begun) == len(numbers)
            and not how.startswith("the process died with -")
            and "no end" not in how
        ):
            break
        last = begun[-1] if begun else numbers[0]
        results.append({"number": last, "words": [], "status": -1, "wrong": how})
        numbers = numbers[numbers.index(last) + 1 :]
    return results


def run(mutations: int, seed: int, jobs: int, first: int = 0) -> list[dict]:
    """Try mutations ``first .. first + mutations - 1`` in ``jobs`` processes at a time; all results."""
    numbers = list(range(first, first + mutations))
    portions = [numbers[k : k + BATCH] for k in range(0, len(numbers), BATCH)]
    with ThreadPoolExecutor(jobs) as pool:
        return [
            result
            for results in pool.map(lambda portion: batch(seed, portion), portions)
            for result in results
        ]


def main() -> int:
    """The long run, from the command line."""
    parser = argparse.ArgumentParser(description="Give edl6dof mutated inputs.")
    parser.add_argument("--mutations", type=int, default=2000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--only", type=int, help="one mutation, in this process, with what it prints")
    parser.add_argument("--worker", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.worker:
        worker(options.seed, list(map(int, options.worker.split(","))))
        return 0
    if options.only is not None:
        paths = [row["path"] for row in json.loads(called("params", "--json").stdout)]
        for words, status, wrong in tried(options.only, options.seed, paths):
            print(words, status, wrong or "as it should", sep="\n")
        return 0
    results = run(options.mutations, options.seed, options.jobs)
    wrong = [result for result in results if result["wrong"]]
    for result in wrong:
        print(f"--- mutation {result['number']}: {' '.join(result['words'])[:300]}\n{result['wrong']}")
    ends = Counter((result["words"] or ["?"])[0] + f" {result['status']}" for result in results)
    print(
        f"{options.mutations} mutations (seed {options.seed}), {len(results)} commands: {len(wrong)} wrong; "
        f"{dict(sorted(ends.items()))}"
    )
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
