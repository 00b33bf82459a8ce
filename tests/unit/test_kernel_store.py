"""Machine code on disk: damage, several processes that compile at once, and no place to write."""

from __future__ import annotations

import os
import sys
from collections import namedtuple
from pathlib import Path
from subprocess import PIPE, Popen

import pytest
import small_programs

from edl6dof.kernels import store

KERNEL = "from edl6dof.kernels import kernel\n@kernel\ndef twice(x):\n    return x + x\n"
CALL = (
    "import sys, mine; print(*(mine.twice(eval(word)) for word in sys.argv[1:]), "
    "sum(mine.twice.stats.cache_hits.values()))"
)


@pytest.fixture
def place(tmp_path) -> Path:
    """A folder with a module that has one kernel."""
    (tmp_path / "mine.py").write_text(KERNEL, encoding="utf-8")
    return tmp_path


def start(place: Path, *values: str, before: str = "", **environment: str) -> Popen:
    """Call the kernel in a process of its own, whose code is kept in ``cache`` of the folder."""
    settings = {"NUMBA_CACHE_DIR": str(place / "cache"), "PYTHONPATH": str(small_programs.ROOT)} | environment
    command = [sys.executable, "-c", before + CALL, *(values or ["1.5"])]
    environment = small_programs.inherited() | settings
    return Popen(command, cwd=place, env=environment, stdout=PIPE, stderr=PIPE, text=True)


def ended(process: Popen) -> tuple[str, int, list[str]]:
    """What a process printed, its cache hits, and the lines on its standard error."""
    out, err = process.communicate()
    assert process.returncode == 0, err
    said, hits = out.rsplit(None, 1)
    return said, int(hits), err.splitlines()


def kept(place: Path) -> Path:
    """The only folder of machine code of ``mine``."""
    (found,) = (place / "cache" / "edl6dof").glob("mine-*")
    return found


def harmed(content: bytes, harm: str) -> bytes:
    half = len(content) // 2
    flipped = content[:half] + bytes([content[half] ^ 1]) + content[half + 1 :]
    return {
        "emptied": b"",
        "cut short": content[:half],
        "one bit": flipped,
        "something else": b"\x80\x05garbage.",
    }[harm]


@pytest.fixture
def folders(tmp_path, monkeypatch):
    """A folder with the code of a function, and a way to take it as a new process does."""
    folder = tmp_path / "mine-abc"
    folder.mkdir()
    (tmp_path / "own").mkdir()
    for name, text in (("f-1.py311.nbi", b"index of f"), ("f-1.py311.1.nbc", b"code of f")):
        (tmp_path / "own" / name).write_bytes(text)
    store._exchange(folder, tmp_path / "own")

    def taken() -> dict[str, bytes]:
        store.say_once.cache_clear()
        own = tmp_path / f"process {len(list(tmp_path.iterdir()))}"
        own.mkdir()
        store._take(folder, own)
        return {file.name: file.read_bytes() for file in own.iterdir()}

    return folder, taken


@pytest.mark.parametrize("harm", ["emptied", "cut short", "one bit", "something else", "gone"])
@pytest.mark.parametrize("name", ["f-1.py311.nbi", "f-1.py311.1.nbc", "sums.json"])
def test_damaged_code_is_not_taken_and_said_in_one_line(folders, capsys, name, harm):
    folder, taken = folders
    assert len(taken()) == 2 and capsys.readouterr().err == ""
    if harm == "gone":
        (folder / name).unlink()
    else:
        (folder / name).write_bytes(harmed((folder / name).read_bytes(), harm))
    assert taken() == {}
    (line,) = capsys.readouterr().err.splitlines()
    assert line.endswith("is damaged; it is compiled again")


def test_what_a_process_writes_anew_changes_nothing_that_others_took(folders):
    """numba writes a file beside the old one and renames it; a link must not reach the other's file."""
    folder, taken = folders
    own = folder.parent / "own"
    (own / "new").write_bytes(b"other code of f")
    (own / "new").replace(own / "f-1.py311.1.nbc")
    assert taken()["f-1.py311.1.nbc"] == b"code of f"
    store._exchange(folder, own)
    assert taken()["f-1.py311.1.nbc"] == b"other code of f"


def test_functions_of_both_are_kept_and_never_the_index_of_one_with_the_code_of_the_other(folders):
    folder, taken = folders
    own = folder.parent / "second"
    own.mkdir()
    for name in ("f-1.py311.nbi", "f-1.py311.1.nbc", "g-1.py311.nbi"):
        (own / name).write_bytes(b"of the second")
    (folder.parent / "own" / "h-10.py311.nbi").write_bytes(b"index of h")
    store._exchange(folder, folder.parent / "own")
    store._take(folder, own)
    store._exchange(folder, own)
    of_second = dict.fromkeys(("f-1.py311.nbi", "f-1.py311.1.nbc", "g-1.py311.nbi"), b"of the second")
    assert taken() == of_second | {"h-10.py311.nbi": b"index of h"}


@pytest.mark.parametrize("kind", [".nbi", ".nbc", "sums.json"])
def test_damaged_code_is_compiled_again(place, kind):
    assert ended(start(place)) == ("3.0", 0, [])
    assert ended(start(place)) == ("3.0", 1, [])
    file = next(file for file in kept(place).iterdir() if file.name.endswith(kind))
    file.write_bytes(harmed(file.read_bytes(), "cut short"))
    said, hits, (line,) = ended(start(place))
    assert (said, hits) == ("3.0", 0) and line.endswith("is damaged; it is compiled again")
    assert ended(start(place)) == ("3.0", 1, [])


def test_processes_that_compile_at_once_leave_sound_code(place):
    """Each compiles for arguments of its own; nobody's code is taken for another's."""
    values = {"1.5": "3.0", "2": "4"}
    running = [start(place, value) for value in values for _ in range(2)]
    assert [ended(one)[0] for one in running] == [said for said in values.values() for _ in range(2)]
    said, hits, lines = ended(start(place, *values))
    assert (said, lines) == (" ".join(values.values()), []) and hits >= 1
    assert ended(start(place, *values)) == (said, len(values), [])


def test_a_process_that_died_leaves_no_copy_for_long(place):
    dies = "import atexit, os; atexit.register(lambda: os._exit(0)); "
    ended(start(place, before=f"import edl6dof.kernels.store; {dies}"))
    copies = list((place / "cache" / "edl6dof").glob(f"{store.COPIES}*"))
    assert ended(start(place))[0] == "3.0"
    assert not [one for one in copies if one.exists()]


FULL = (
    "from edl6dof.kernels import store; from collections import namedtuple; "
    "store.disk_usage = lambda place: namedtuple('Usage', 'free')(0); "
)
#: A disk on which nothing can be exchanged, as when it fills while the process compiles.
FILLS = (
    "from edl6dof.kernels import store\n"
    "def fails(*given): raise OSError(28, 'No space left on device')\n"
    "store._exchange = fails\n"
)


@pytest.mark.parametrize(
    ("disk", "words"), [(FULL, "there is no room for machine code"), (FILLS, "machine code cannot be kept")]
)
def test_a_full_disk_costs_a_line_and_nothing_else(place, disk, words):
    for _ in range(2):
        said, hits, (line,) = ended(start(place, before=disk))
        assert (said, hits) == ("3.0", 0) and words in line


def test_copies_go_to_another_disk_where_that_of_the_code_is_full(tmp_path, monkeypatch, capsys):
    (tmp_path / "tmp").mkdir()
    (tmp_path / "code").mkdir()
    monkeypatch.setattr(store.tempfile, "tempdir", str(tmp_path / "tmp"))
    usage = namedtuple("Usage", "free")
    monkeypatch.setattr(store, "disk_usage", lambda place: usage(store.NEEDED_B * (place.name == "tmp")))
    own = store._place.__wrapped__(tmp_path / "code")
    assert own is not None and own.parent == tmp_path / "tmp" and capsys.readouterr().err == ""
    assert own.stat().st_mode & 0o777 == 0o700 or os.name == "nt"
