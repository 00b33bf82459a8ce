"""Every broken file of the corpus is refused by ``check`` and ``fly`` with exactly the messages it announces;
nothing is written.

A case is a YAML file in ``cases/``.  Its first lines say what is expected of it::

    # set: dotted.path=value                       an override given on the command line (any number) #
    expect: FILE:LINE: dotted.key: text          a message: beginning of the text, as many as there are
    mistakes
"""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import in_process
import pytest

HERE = Path(__file__).parent
CASES = sorted((HERE / "cases").glob("*.yaml"))
ROOT = HERE.parents[1]


def announced(case: Path, word: str) -> list[str]:
    start = f"# {word}: "
    lines = case.read_text(encoding="utf-8").splitlines()
    return [line.removeprefix(start) for line in lines if line.startswith(start)]


def flags(case: Path) -> list[str]:
    return [word for text in announced(case, "set") for word in ("--set", text)]


def run(capsys, monkeypatch, *words: str) -> tuple[int, str, str]:
    monkeypatch.setattr(sys, "argv", ["edl6dof", *words])
    with pytest.raises(SystemExit) as end:
        in_process.main()
    out, err = capsys.readouterr()
    return end.value.code, out, err


def matches(expected: str, line: str) -> bool:
    """Whether a message begins as announced; folders and columns are left open, but the column must be
    there.
    """
    if expected.startswith("--set "):
        return line.startswith(expected)
    file, number, rest = expected.split(":", 2)
    found = re.match(rf"(?:.*/)?{re.escape(file)}:{number}:([1-9]\d*):", line)
    return found is not None and line[found.end() :].startswith(rest)


def require(lines: list[str], expected: list[str]) -> None:
    assert len(lines) == len(expected), "\n".join(lines)
    for text in expected:
        assert any(matches(text, line) for line in lines), f"announced: {text}\nprinted:\n" + "\n".join(lines)


#: Both refuse by the same check: the suite gives every file to the first, every fourth to the second.
GIVEN = [
    pytest.param(
        case, command, id=f"{command}-{case.stem}", marks=pytest.mark.long if place and number % 4 else ()
    )
    for place, command in enumerate(("check", "fly"))
    for number, case in enumerate(CASES)
]


@pytest.mark.parametrize(("case", "command"), GIVEN)
def test_broken_file(case, command, capsys, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    code, out, err = run(capsys, monkeypatch, command, str(case), *flags(case))
    assert (code, out) == (2, "")
    assert announced(case, "expect"), "the case announces nothing"
    require(err.splitlines(), announced(case, "expect"))
    assert not list(tmp_path.iterdir())


def test_corpus_is_wide_enough():
    assert len(CASES) >= 45
    expected = [text for case in CASES for text in announced(case, "expect")]
    assert len(expected) > len(CASES)


@pytest.mark.parametrize("every", [8, pytest.param(1, marks=pytest.mark.long)])
def test_all_files_in_one_call_without_a_traceback(every, tmp_path):
    """The real program, many files at once: every message of every file on stderr, one line each, nothing
    else.
    """
    plain = [case for case in CASES if not flags(case)][::every]
    command = [sys.executable, "-c", "from edl6dof.cli import main; main()", "check", *map(str, plain)]
    done = subprocess.run(
        command, capture_output=True, text=True, cwd=tmp_path, env={"PYTHONPATH": str(ROOT)}, timeout=60
    )
    assert (done.returncode, done.stdout) == (2, "")
    require(done.stderr.splitlines(), [text for case in plain for text in announced(case, "expect")])


def test_a_good_file_between_bad_ones_is_still_reported(capsys, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    code, out, err = run(capsys, monkeypatch, "check", str(CASES[0]), "tianwen1", str(CASES[1]))
    assert code == 2
    assert out.startswith("tianwen1: ok")
    assert len(err.splitlines()) == 2


#: file name -> content (None: a folder; absent: no such file), and what is said of it
ODD_FILES = {
    "empty.yaml": (b"", "empty.yaml:1:1: the file is empty"),
    "binary.yaml": (bytes(range(256)), "not UTF-8"),
    "nul.yaml": (b"name: a\x00b\n", "nul.yaml:1:8: character '\\x00' is not allowed in YAML"),
    "latin1.yaml": (
        "name: bad\ndescription: Größe\n".encode("latin-1"),
        "latin1.yaml:2:16: is not UTF-8 text",
    ),
    "folder.yaml": (None, "folder, not a"),
    "huge.yaml": (b"#" * 2_000_001, "has 2000001 bytes"),
    "deep.yaml": (b"wind: " + b"[" * 500 + b"]" * 500, "deep"),
    "long_line.yaml": (b"name: " + b"x" * 500_000 + b"\nx: [", "not valid YAML"),
}


@pytest.mark.parametrize("name", ODD_FILES)
@pytest.mark.parametrize("command", ["check", "fly"])
def test_odd_file(name, command, capsys, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    content, said = ODD_FILES[name]
    path = tmp_path / name
    path.mkdir() if content is None else path.write_bytes(content)
    code, out, err = run(capsys, monkeypatch, command, name)
    assert (code, out) == (2, "")
    assert said in err
    assert len(err.splitlines()) == 1
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("tianwen", "tianwen: no such scenario file; did you mean tianwen1 or tianwen1_mc"),
        ("scenarios/tianwen2.yaml", "did you mean tianwen1 or tianwen1_mc"),
        ("x" * 5000, "no such scenario file"),
        ("", "(no name): no such scenario file"),
    ],
)
@pytest.mark.parametrize("command", ["check", "fly"])
def test_missing_scenario(name, said, command, capsys, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    code, out, err = run(capsys, monkeypatch, command, name)
    assert (code, out) == (2, "")
    assert said in err
    assert len(err.splitlines()) == 1
    assert not list(tmp_path.iterdir())
