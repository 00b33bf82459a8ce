"""Help, version and what they import."""

from __future__ import annotations

import json
import re
import subprocess
import sys

import in_process
import pytest
from cli_run import environment, run

HEAVY = (
    "numpy",
    "scipy",
    "numba",
    "yaml",
    "pyarrow",
    "rerun",
    "rich.progress",
    "edl6dof.config.base",
    "edl6dof.sim",
)
#: What a flight has no use for; numba itself loads scipy.linalg.
UNUSED_BY_A_FLIGHT = (
    *("scipy.optimize", "scipy.interpolate", "scipy.stats", "rerun", "matplotlib", "plotly", "dask"),
    *("pandas", "pyarrow.compute"),
)

IMPORTS = f"""
import json, sys
from edl6dof.cli import main
for words in map(json.loads, sys.argv[1:]):
    sys.argv = ["edl6dof", *words]
    try:
        main()
    except SystemExit:
        pass
    print([name for name in {HEAVY!r} if name in sys.modules], file=sys.stderr)
"""


LIGHT = (
    ["--help"],
    ["fly", "--help"],
    ["version"],
    ["--version"],
    ["no-such-command"],
    ["fly", "--no-such-option"],
)


def imported(folder, code, *commands):
    """What the commands print, one after the other in one process, and after each what it has imported."""
    done = subprocess.run(
        [sys.executable, "-c", code, *map(json.dumps, commands)],
        capture_output=True,
        text=True,
        env=environment(),
        cwd=folder,
        timeout=300,
    )
    return done.stdout, [line for line in done.stderr.splitlines() if line.startswith("[")], done.stderr


def test_light_commands_import_nothing_heavy(tmp_path):
    """Typer loads pydantic when it parses a command's arguments; for the help alone nobody needs it."""
    code = IMPORTS.replace("name in sys.modules]", "name in sys.modules], 'pydantic' in sys.modules")
    _, found, err = imported(tmp_path, code, *LIGHT)
    assert found[0] == "[] False", err
    assert [line.partition("]")[0] for line in found] == ["["] * len(LIGHT), err


def test_a_flight_without_replay_imports_only_what_it_flies_with_and_pipes_plain_text(tmp_path):
    """Each of these costs tens of megabytes and tenths of a second of every flight."""
    code = IMPORTS.replace(repr(HEAVY), repr(UNUSED_BY_A_FLIGHT))
    words = ["fly", "tianwen1", "--no-replay", "--set", "simulation.time_limit_s=1"]
    out, found, err = imported(tmp_path, code, words)
    assert out.startswith("tianwen1: time limit") and not re.search(r"[\x00-\x09\x0b-\x1f\x7f]", out)
    assert found == ["[]"] and err == "[]\n", err


def test_help_names_every_command(capsys, monkeypatch):
    """Under the title of its part."""
    code, out, _ = run(capsys, monkeypatch, "-h")
    assert code == 0 and out == run(capsys, monkeypatch, "--help")[1]
    parts = [part.splitlines() for part in out.partition("\n\nFly:\n")[2].split("\n\n")[:-1]]
    lines = [line for part in parts for line in part if line.startswith("  ")]
    assert sorted(line.split()[0] for line in lines) == sorted(in_process.PROGRAM.commands)
    assert lines[0].split()[0] == "fly" and "Look at results:" in out and "Commands:" not in out
    assert not [line for line in lines if line.endswith("...")], "the summary of a command fits on its line"


def commands():
    """Words of every command, those of groups with both names."""
    for name, command in in_process.PROGRAM.commands.items():
        inner = getattr(command, "commands", None)
        yield from [[name, one] for one in inner] if inner else [[name]]


@pytest.mark.parametrize("words", [["design"], *commands()], ids=" ".join)
def test_help_of_a_command_is_in_words_of_its_reader(words, capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    code, out, _ = run(capsys, monkeypatch, *words, "--help")
    assert code == 0 and max(map(len, out.splitlines())) <= 80
    assert not re.search(r"(?m)[{}]|<(str|int|float|path|list|tuple)|list\[|TEXT|[a-z,]\.\.\.$", out)
    described = out.partition("Options:")[0].partition("Arguments:")[2] + out.partition("Options:")[2]
    assert not re.search(r"(?m)^  (-\S+|[A-Z]\S*)( \S+)?$\n(?! {4})", described), "each has its meaning"
    assert not re.search(r"[<>]=?x|x[<>]", out), "bounds of a number are words"
    assert words == ["design"] or f"Examples:\n    edl6dof {' '.join(words)}" in out


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["campaign"], ("[at least 1]", "[1 to 1024]")),
        (["replay"], ("[at least 0.1]", "[default: 30.0; 1 to 120]")),
    ],
    ids=["campaign", "replay"],
)
def test_help_says_the_bounds_of_a_number_in_words(words, said, capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    _, out, _ = run(capsys, monkeypatch, *words, "--help")
    assert all(text in " ".join(out.split()) for text in said)


def test_no_command_shows_the_help(capsys, monkeypatch):
    code, out, err = run(capsys, monkeypatch)
    assert code in (0, 2)
    assert "Look at results:" in out + err


@pytest.mark.parametrize(
    "words", [["flly"], ["fly", "--colour"], ["fly", "a", "b"], ["check"], ["fly", "--save-state", "soon"]]
)
def test_wrong_usage_is_status_2(words, capsys, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    code, out, err = run(capsys, monkeypatch, *words)
    assert (code, out) == (2, "")
    assert "Error" in err
    assert not list(tmp_path.iterdir())


def test_version(capsys, monkeypatch):
    import edl6dof

    assert run(capsys, monkeypatch, "version") == (0, f"{edl6dof.__version__}\n", "")
    assert run(capsys, monkeypatch, "--version") == (0, f"edl6dof {edl6dof.__version__}\n", "")


def test_schema_is_json(capsys, monkeypatch):
    code, out, err = run(capsys, monkeypatch, "schema")
    assert (code, err) == (0, "")
    assert json.loads(out)["title"] == "Scenario"
