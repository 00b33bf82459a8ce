"""Seeded mutations of the lines of what a user gives: YAML files, overrides, data tables, DAVE-ML, words of
the command line.
"""

from __future__ import annotations

import json
import random
import re
from collections.abc import Callable, Iterator
from contextlib import chdir
from pathlib import Path

from attempt import Ended, ended, parameters

ROOT = Path(__file__).resolve().parents[2]

#: Values that tend to go wrong where a number, a name or a list is expected.
NASTY = (
    *(
        "nan",
        ".nan",
        ".inf",
        "-.inf",
        "0",
        "-0.0",
        "-1",
        "1e308",
        "-1e308",
        "1e-320",
        "1e999",
        "9" * 30,
        "-" + "9" * 30,
        "0x10",
        "010",
    ),
    *(
        "",
        "null",
        "~",
        "true",
        "yes",
        "[]",
        "{}",
        "[[]]",
        "[1, 2]",
        "[nan, 1, 2]",
        "{a: 1}",
        '"text"',
        "'1.0'",
        "2021-05-14",
        "1_000",
    ),
    *(
        "*anchor",
        "&a [*a]",
        "!!python/object/apply:os.getcwd []",
        "!!binary AAAA",
        "? x",
        "- y",
        "|",
        ">",
        "%",
        "@",
        "`",
        "\t1",
        "\x07",
    ),
    *(
        "a" * 5000,
        "../../etc/passwd",
        "/dev/zero",
        "/dev/null",
        "CON",
        "naïve",
        "\u202e",
        "\U0001f680",
        "${HOME}",
        "name: {name}",
    ),
)

#: Files that a mutation starts from.
SCENARIOS = (
    *(
        "scenarios/tianwen1.yaml",
        "scenarios/msl.yaml",
        "scenarios/tianwen1_mc.yaml",
        "scenarios/zheng2015.yaml",
    ),
    *("scenarios/nesc/case06.yaml", "scenarios/wu2013.yaml"),
)
VEHICLES = ("vehicles/tianwen1.yaml", "vehicles/msl.yaml")
TABLES = {
    "atmosphere.table": "edl6dof/data/atmosphere/marsgram2010_jezero_feb2021_winds.csv",
    "planet.gravity.coefficients": "edl6dof/data/gravity/gmm3_degree12_sha.tab",
    "vehicle.aero.capsule.static_table": "edl6dof/data/aerodynamics/phoenix_70deg_static_aero.csv",
}
DAVEML = (
    "vehicles/nesc/brick_aero.dml",
    "vehicles/nesc/brick_inertia.dml",
    "vehicles/nesc/cannonball_aero.dml",
    "vehicles/nesc/cannonball_inertia.dml",
)

#: Nothing that a mutation leaves whole flies longer than this: what is looked for is how a flight begins and
#: ends.
SHORT = ("--set", "simulation.time_limit_s=2")


def attempt(number: int, seed: int, home: Path) -> Iterator[Ended]:
    """One mutation, with random numbers of its own."""
    yield from checked_and_flown(home, lambda folder: _mutant(random.Random(f"{seed}/{number}"), folder))


def checked_and_flown(home: Path, mutant: Callable[[Path], list[str]]) -> Iterator[Ended]:
    """A mutation, which writes its files into a folder and returns the words that give it to the program;
    what the check lets pass is flown for two seconds.
    """
    folder = home / "input"
    folder.mkdir()
    with chdir(folder):
        done = ended(mutant(folder), folder)
        yield done
        if done.words[0] != "check" or done.status != 0 or "tianwen1_mc" in done.words:
            return
        run = home / "run"
        flown = ended(["fly", *done.words[1:], *SHORT, "--no-replay", "-q", "--out", str(run)], folder)
        kept = (run / "telemetry.parquet").is_file()
        lost = "" if kept == (flown.status != 2) else "telemetry is lost, or a refused flight left something"
        yield flown._replace(wrong=flown.wrong or lost)


def _mutant(draw: random.Random, folder: Path) -> list[str]:
    """Files in an empty folder, and the words that give them to the program."""
    kinds: list[Callable[[random.Random, Path, list[str]], list[str]]] = [
        _yaml,
        _yaml,
        _vehicle,
        _override,
        _override,
        _table,
        _dave,
        _words,
    ]
    return draw.choice(kinds)(draw, folder, parameters())


def _yaml(draw: random.Random, folder: Path, paths: list[str]) -> list[str]:
    text = (ROOT / draw.choice(SCENARIOS)).read_text(encoding="utf-8")
    return ["check", str(_write(folder / "mutant.yaml", _mutated(draw, text)))]


def _vehicle(draw: random.Random, folder: Path, paths: list[str]) -> list[str]:
    _write(folder / "craft.yaml", _mutated(draw, (ROOT / draw.choice(VEHICLES)).read_text(encoding="utf-8")))
    text = re.sub(
        r"^vehicle: .*$",
        "vehicle: craft.yaml",
        (ROOT / "scenarios/tianwen1.yaml").read_text(encoding="utf-8"),
        flags=re.MULTILINE,
    )
    return ["check", str(_write(folder / "mutant.yaml", text.encode()))]


def _override(draw: random.Random, folder: Path, paths: list[str]) -> list[str]:
    words = ["check", draw.choice(("tianwen1", "msl", "nesc/case06", "tianwen1_mc"))]
    for _ in range(draw.choice((1, 1, 2, 5))):
        path = draw.choice(paths).replace("[]", f".{draw.choice(('0', '3', '99', '-1', '*'))}")
        where = draw.choice(("", "", "truth."))
        value = (
            draw.choice(NASTY)
            if draw.random() < 0.6
            else repr(draw.choice((-1, 1)) * 10 ** draw.uniform(-12, 12))
        )
        words += ["--set", f"{where}{path}={value}" if not where else f"truth={json.dumps({path: value})}"]
    return [word.replace("\0", "") for word in words]


def _table(draw: random.Random, folder: Path, paths: list[str]) -> list[str]:
    key = draw.choice(list(TABLES))
    name = _write(folder / "table.csv", _mutated(draw, (ROOT / TABLES[key]).read_text(encoding="utf-8")))
    return ["check", "tianwen1", "--set", f"{key}={name}"]


def _dave(draw: random.Random, folder: Path, paths: list[str]) -> list[str]:
    source = ROOT / draw.choice(DAVEML)
    name = _write(folder / "model.dml", _mutated(draw, source.read_text(encoding="utf-8")))
    model = source.name.split("_")[0]
    others = [str(ROOT / other) for other in DAVEML if model in other and not other.endswith(source.name)]
    case = "nesc/case02" if model == "brick" else "nesc/case01"
    return ["check", case, "--set", f"vehicle.daveml={json.dumps([str(name), *others])}"]


#: Words of a command line at the wrong place.
_ODD = (
    "tianwen1",
    "mutant.yaml",
    ".",
    "--force",
    "--out",
    "-n",
    "--set",
    "seed=3",
    "--at",
    "--from",
    "-1",
    "--json",
)


def _words(draw: random.Random, folder: Path, paths: list[str]) -> list[str]:
    """A command with arguments that are none; ``fly`` ends soon."""
    odd = [*NASTY[:25], *_ODD, str(folder)]
    command = draw.choice(
        (
            "fly",
            "check",
            "params",
            "report",
            "plot",
            "compare",
            "export",
            "refly",
            "campaign",
            "faults",
            "study",
        )
    )
    words = [command, *(draw.choice(odd) for _ in range(draw.randint(1, 4)))]
    words = [word for word in words if word and "\0" not in word]
    if command in ("fly", "campaign", "faults"):
        # always one mistake, or nothing would end soon
        return [*words, *SHORT, "--set", "no.such.parameter=1"]
    return [*words, "--no-such-option"] if command == "study" else words


def _write(path: Path, content: bytes) -> Path:
    path.write_bytes(content)
    return path


def _mutated(draw: random.Random, text: str) -> bytes:
    """A text with one to four changes, and now and then a few bytes of noise."""
    lines = text.splitlines()
    for _ in range(draw.choice((1, 1, 1, 2, 4))):
        draw.choice(_CHANGES)(draw, lines)
    content = ("\n".join(lines) + "\n").encode("utf-8", errors="surrogatepass")
    if draw.random() < 0.1 and content:
        noisy = bytearray(content)
        for _ in range(draw.randint(1, 8)):
            noisy[draw.randrange(len(noisy))] = draw.randrange(256)
        content = bytes(noisy)
    return content[: draw.randrange(len(content) + 1)] if draw.random() < 0.05 else content


def _value(draw: random.Random, lines: list[str]) -> None:
    """Another value behind a key or a comma."""
    k = draw.randrange(len(lines))
    spans = list(re.finditer(r"(?<=[:,\[{>\"] )?[-+\w.]+(?=[,\]}\s<\"]|$)", lines[k]))
    if spans:
        span = draw.choice(spans)
        lines[k] = lines[k][: span.start()] + draw.choice(NASTY) + lines[k][span.end() :]


def _number(draw: random.Random, lines: list[str]) -> None:
    """A number changed by orders of magnitude, or its sign."""
    k = draw.randrange(len(lines))
    spans = list(re.finditer(r"[-+]?\d+\.?\d*(?:[eE][-+]?\d+)?", lines[k]))
    if spans:
        span = draw.choice(spans)
        changed = float(span.group()) * draw.choice((-1, 0, 10 ** draw.uniform(-9, 9), 1.0000001))
        lines[k] = lines[k][: span.start()] + repr(changed) + lines[k][span.end() :]


def _gone(draw: random.Random, lines: list[str]) -> None:
    if len(lines) > 1:
        del lines[draw.randrange(len(lines))]


def _twice(draw: random.Random, lines: list[str]) -> None:
    lines.insert(draw.randrange(len(lines)), draw.choice(lines))


def _moved(draw: random.Random, lines: list[str]) -> None:
    i, j = draw.randrange(len(lines)), draw.randrange(len(lines))
    lines[i], lines[j] = lines[j], lines[i]


def _indented(draw: random.Random, lines: list[str]) -> None:
    k = draw.randrange(len(lines))
    lines[k] = (
        draw.choice((" ", "  ", "\t", "- ", "# ")) + lines[k] if draw.random() < 0.7 else lines[k].lstrip()
    )


def _spelled(draw: random.Random, lines: list[str]) -> None:
    """A letter changed, dropped or doubled."""
    k = draw.randrange(len(lines))
    if lines[k]:
        i = draw.randrange(len(lines[k]))
        lines[k] = (
            lines[k][:i]
            + draw.choice(("", "x", lines[k][i] * 2, ":", "\u00e9", "\ud800"))
            + lines[k][i + 1 :]
        )


def _long(draw: random.Random, lines: list[str]) -> None:
    """A line as deep or as long as nobody writes it."""
    lines.insert(
        draw.randrange(len(lines)),
        draw.choice(
            ("x: " + "[" * 500 + "]" * 500, "y: " + "{a: " * 300 + "1" + "}" * 300, "z: " + "ab " * 20000)
        ),
    )


_CHANGES = (_value, _value, _value, _number, _number, _gone, _twice, _moved, _indented, _spelled, _long)
