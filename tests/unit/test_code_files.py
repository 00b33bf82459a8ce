"""Machine code on disk: damage, several writers at once, and users who may write nowhere."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
import small_programs

from edl6dof import code_files
from edl6dof.code_files import CodeFiles, say_once, trusted_users

KERNEL = "from edl6dof.jit import kernel\n@kernel\ndef twice(x):\n    return x + x\n"
CALL = (
    "import sys, mine; print(*(mine.twice(eval(word)) for word in sys.argv[1:]), "
    "sum(mine.twice.stats.cache_hits.values()))"
)


@pytest.fixture
def place(tmp_path) -> Path:
    """A folder with a module that has one kernel."""
    return with_kernel(tmp_path)


def with_kernel(folder: Path) -> Path:
    (folder / "mine.py").write_text(KERNEL, encoding="utf-8")
    return folder


def start(place: Path, *values: str, **environment: str) -> small_programs.Running:
    """Call the kernel in a process of its own, whose code is kept in ``cache`` of the folder."""
    settings = {"HOME": "/dev/null", "NUMBA_CACHE_DIR": str(place / "cache")} | environment
    return small_programs.start(CALL, *(values or ["1.5"]), cwd=place, **settings)


def ended(process: small_programs.Running) -> tuple[str, int, list[str]]:
    """What a process printed, its cache hits, and the lines on its standard error."""
    status, out, err = process.ended()
    assert status == 0, err
    said, hits = out.rsplit(None, 1)
    return said, int(hits), err.splitlines()


def code(place: Path) -> list[Path]:
    return sorted(file for file in (place / "cache").rglob("*") if file.is_file())


@pytest.fixture(scope="module")
def compiled(tmp_path_factory) -> Path:
    """A folder with a module whose kernel is compiled; every test leaves it so."""
    place = with_kernel(tmp_path_factory.mktemp("compiled"))
    assert ended(start(place)) == ("3.0", 0, [])
    return place


def harmed(content: bytes, harm: str) -> bytes:
    half = len(content) // 2
    flipped = content[:half] + bytes([content[half] ^ 1]) + content[half + 1 :]
    return {
        "emptied": b"",
        "cut short": content[:half],
        "one bit": flipped,
        "something else": b"\x80\x05garbage.",
    }[harm]


@pytest.mark.parametrize("harm", ["emptied", "cut short", "one bit", "something else"])
def test_damaged_code_is_not_loaded_and_said_in_one_line(tmp_path, capsys, harm):
    say_once.cache_clear()
    files = CodeFiles(tmp_path, "f", "a" * 64)
    files.save("int", "code")
    (file,) = tmp_path.iterdir()
    file.write_bytes(harmed(file.read_bytes(), harm))
    assert files.load("int") is None and files.load("int") is None
    (line,) = capsys.readouterr().err.splitlines()
    assert line.endswith("is damaged; it is compiled again")


def test_code_of_another_user_is_not_loaded(tmp_path, capsys, monkeypatch):
    """In a folder that many may write to, such as NUMBA_CACHE_DIR in /tmp."""
    say_once.cache_clear()
    files = CodeFiles(tmp_path, "f", "a" * 64)
    files.save("int", "code")
    assert files.load("int") == "code"
    owner = next(tmp_path.iterdir()).stat().st_uid
    monkeypatch.setattr(code_files, "trusted_users", lambda: trusted_users() - {owner})
    assert files.load("int") is None
    assert "another user's" in capsys.readouterr().err


def test_users_whose_code_is_run():
    assert trusted_users() == {0, os.getuid(), Path(code_files.__file__).stat().st_uid}


def test_damaged_code_is_compiled_again(compiled):
    (file,) = code(compiled)
    file.write_bytes(harmed(file.read_bytes(), "one bit"))
    said, hits, lines = ended(start(compiled))
    assert (said, hits) == ("3.0", 0)
    (line,) = lines
    assert line.endswith("is damaged; it is compiled again")
    assert ended(start(compiled)) == ("3.0", 1, [])


def test_processes_that_compile_at_once_leave_code_for_all(place):
    """Each compiles for arguments of its own; nobody's code is lost or taken for another's."""
    values = {"1.5": "3.0", "2": "4"}
    running = [start(place, value) for value in values for _ in range(2)]
    assert [ended(one)[0] for one in running] == [said for said in values.values() for _ in range(2)]
    assert ended(start(place, *values)) == (" ".join(values.values()), len(values), [])
    assert {file.suffix for file in code(place)} == {".nbc"}


def test_two_writers_who_know_nothing_of_each_other(tmp_path):
    first, second = (CodeFiles(tmp_path, "f-1.py311", "a" * 64) for _ in range(2))
    assert not first and first.load("int") is None
    first.save("int", "code for int")
    second.save("float", "code for float")
    for one in (first, second):
        assert one and (one.load("int"), one.load("float")) == ("code for int", "code for float")


def test_code_of_other_sources_is_neither_taken_nor_kept(tmp_path):
    old, new, other = (
        CodeFiles(tmp_path, name, stamp * 64)
        for name, stamp in (("f-1.py311", "a"), ("f-1.py311", "b"), ("f-10.py311", "a"))
    )
    (tmp_path / "f-1.py311.nbi").write_bytes(b"an index of numba's own")
    other.save("int", "another function's")
    old.save("int", "old")
    assert not new and new.load("int") is None
    new.save("int", "new")
    assert (new.load("int"), old.load("int"), other.load("int")) == ("new", None, "another function's")
    assert len(list(tmp_path.iterdir())) == 2
    new.flush()
    assert not new and other


def test_a_folder_that_takes_no_file_costs_a_line_and_nothing_else(tmp_path, capsys):
    say_once.cache_clear()
    files = CodeFiles(tmp_path / "gone", "f", "a" * 64)
    files.save("int", "code")
    files.save("float", "code")
    (line,) = capsys.readouterr().err.splitlines()
    assert "machine code cannot be kept in" in line and "No such file" in line


@pytest.fixture
def read_only(place) -> Path:
    """No folder is named, and the module stands outside the package: its own folder keeps no code."""
    (place / "tmp").mkdir()
    return place


@pytest.mark.skipif(os.name == "nt", reason="Windows gives every user a folder for temporary files")
class TestNowhereToWrite:
    def test_a_user_without_a_home_gets_a_folder_of_his_own(self, read_only):
        temporary = {"TMPDIR": str(read_only / "tmp"), "NUMBA_CACHE_DIR": ""}
        said, hits, lines = ended(start(read_only, **temporary))
        assert (said, hits) == ("3.0", 0)
        folder = read_only / "tmp" / f"edl6dof-{os.getuid()}"
        assert lines == [
            f"edl6dof: machine code is kept in {folder} (NUMBA_CACHE_DIR can name a better place)"
        ]
        assert folder.stat().st_mode & 0o777 == 0o700
        assert ended(start(read_only, **temporary))[:2] == ("3.0", 1)

    @pytest.mark.parametrize("kind", ["open to others", "a file", "a link"])
    def test_a_folder_that_others_prepared_is_not_used(self, read_only, kind):
        folder = read_only / "tmp" / f"edl6dof-{os.getuid()}"
        if kind == "a file":
            folder.write_text("")
        elif kind == "a link":
            (read_only / "elsewhere").mkdir(mode=0o700)
            folder.symlink_to(read_only / "elsewhere")
        else:
            folder.mkdir()
            folder.chmod(0o777)
        said, hits, lines = ended(start(read_only, TMPDIR=str(read_only / "tmp"), NUMBA_CACHE_DIR=""))
        assert (said, hits) == ("3.0", 0)
        (line,) = lines
        assert line.startswith(
            "edl6dof: no folder for machine code can be written to: it is compiled for this process alone"
        )

    def test_a_home_that_is_no_path_makes_no_folder_here(self, read_only):
        before = sorted(read_only.iterdir())
        assert (
            ended(start(read_only, HOME="home", TMPDIR=str(read_only / "tmp"), NUMBA_CACHE_DIR=""))[0]
            == "3.0"
        )
        assert sorted(read_only.iterdir()) == before
