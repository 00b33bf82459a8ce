"""The folders of machine code: never stale, whatever is edited, and what users do who can write nowhere.

A small package with the real decorator and some rooms is written to disk; processes of their own compile and
run it, edit it and run it again.  What the machine code returns, and numba's own count of cache hits, say
whether the cache was used and whether it was stale.
"""

import os
import sys
import tarfile
import time
from pathlib import Path

import numba
import pytest
import small_programs

from edl6dof import kernels
from edl6dof.kernels import cache
from edl6dof.kernels.cache import OLDEST_S

HELPER = "from probe.kernels import kernel\n@kernel\ndef factor():\n    return {}\n"
CALLER = """from probe.kernels import kernel
from probe.spatial.helper import factor
@kernel
def area(x):
    return factor() * x
"""
CALL = """
import sys
sys.path.insert(0, {root!r})
from probe.fsw.caller import area
print(area(2.0), sum(area.called.stats.cache_hits.values()), area.called.signatures != [])
"""


@pytest.fixture
def package(tmp_path):
    """A package ``probe`` with the real kernels and two rooms: a helper (factor 3) and its caller."""
    for room in ("spatial", "fsw"):
        write(tmp_path, f"{room}/__init__.py", "")
    for source in Path(kernels.__file__).parent.glob("*.py"):
        if source.name != "functions.py":
            text = source.read_text().replace("edl6dof.kernels", "probe.kernels")
            write(tmp_path, f"kernels/{source.name}", text.replace(r"from edl6dof\.", r"from probe\."))
    write(tmp_path, "__init__.py", "")
    write(tmp_path, "spatial/helper.py", HELPER.format("3.0"))
    write(tmp_path, "fsw/caller.py", CALLER)
    return tmp_path


def write(root, name, text):
    file = root / "probe" / name
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text)
    os.utime(file, (time.time() - 1.0,) * 2)  # code of a source that is younger than the process is not kept


def run(program, root, **environment):
    """What a program prints that runs in a process of its own."""
    settings = {"NUMBA_CACHE_DIR": str(root / "cache")} | environment
    ran = small_programs.run(program, cwd=root, **settings)
    assert ran.returncode == 0, ran.stderr
    return ran.stdout


def call(root, **environment):
    """Run the caller in a fresh process: result and cache hits."""
    result, hits, _ = run(CALL.format(root=str(root)), root, **environment).split()
    return float(result), int(hits)


TERMINAL = """
import io, sys
class Terminal(io.StringIO):
    def isatty(self):
        return True
sys.stderr = Terminal()
{}
print(sys.stderr.getvalue())
"""


def test_a_terminal_is_told_of_code_that_is_compiled_and_not_of_code_that_is_kept(package):
    program = TERMINAL.format(CALL.format(root=str(package)))
    assert run(program, package).count("edl6dof: compiling") == 1, "once, of two kernels"
    assert "compiling" not in run(program, package)
    write(package, "fsw/caller.py", CALLER + "# edited\n")
    assert "edl6dof: compiling" in run(program, package)


def test_edited_helper_recompiles_its_caller_and_a_room_that_it_cannot_see_does_not(package):
    assert call(package) == (6.0, 0)
    write(package, "vehicle/other.py", "x = 1\n")
    write(package, "spatial/helper.py", HELPER.format("3.0"))  # touched, not changed: content counts
    assert call(package) == (6.0, 1)
    write(package, "spatial/helper.py", HELPER.format("5.0"))  # same length, within the clock's resolution
    assert call(package) == (10.0, 0)
    assert len(list(package.glob("cache/edl6dof/*/*.nbc"))) == 2, "code of other sources has gone"


def test_edited_constant_recompiles_what_reads_it(package):
    write(package, "interface/size.py", "SIZE = 3.0\n")
    write(package, "fsw/caller.py", CALLER.replace("factor() * x", "SIZE * x")
          + "from probe.interface.size import SIZE\n")  # fmt: skip
    assert call(package) == (6.0, 0)
    write(package, "interface/size.py", "SIZE = 4.0\n")
    assert call(package) == (8.0, 0)


def test_edited_member_recompiles_itself_alone(package):
    write(package, "fsw/caller.py", f"from probe.fsw import law\n{CALLER}")
    law = "from probe.kernels import kernel\n@kernel\ndef law(x):\n    return {} * x\nMEMBER = law\n"
    both = CALL.replace(
        "print",
        "from probe.fsw.law import law\nprint(law(1.0), *law.called.stats.cache_hits.values())\nprint",
    )
    found = []
    for factor in (1.0, 1.0, 2.0):
        write(package, "fsw/law.py", law.format(factor))
        found.append(run(both.format(root=str(package)), package).splitlines())
    assert found == [["1.0", "6.0 0 True"], ["1.0 1", "6.0 1 True"], ["2.0", "6.0 1 True"]]


def test_a_file_that_moves_with_its_content_is_another_source(tmp_path):
    """A module that calls it by a list of functions does not name its place, but its machine code does."""
    places = [tmp_path / name for name in ("here.py", "there.py")]
    for place in places:
        place.write_text("x = 1\n")
        os.utime(place, (1e9, 1e9))
    assert len({cache.stamp(str(place)) for place in places}) == 2


def test_code_of_a_source_that_is_edited_while_the_program_runs_is_not_kept(package):
    edit = (
        "from pathlib import Path\nhelper = Path('probe/spatial/helper.py')\n"
        "helper.write_text(helper.read_text().replace('3.0', '7.0'))\nprint"
    )
    assert run(CALL.replace("print", edit).format(root=str(package)), package).split()[0] == "6.0"
    assert call(package) == (14.0, 0)


@pytest.mark.parametrize("flag", ["NUMBA_BOUNDSCHECK", "NUMBA_DEBUGINFO"])
def test_flags_that_change_machine_code_have_folders_of_their_own(package, flag):
    assert call(package) == (6.0, 0)
    assert call(package, **{flag: "1"}) == (6.0, 0)
    assert call(package) == call(package, **{flag: "1"}) == (6.0, 1)


def test_processes_that_compile_at_once_leave_sound_code(package):
    """Each compiles for arguments of its own; nobody's code is taken for another's."""
    values = {"1.5": "4.5", "2": "6.0"}
    program = CALL.replace("area(2.0)", "area(eval(sys.argv[1]))").format(root=str(package))
    for hits in ("0", "1"):
        running = [
            small_programs.start(program, value, cwd=package, NUMBA_CACHE_DIR=str(package / "cache"))
            for value in values
            for _ in range(1 if hits == "1" else 2)
        ]
        said = [one.ended().stdout.split() for one in running]
        assert {word[0] for word in said} == set(values.values())
    assert [word[1] for word in said] == ["1", "1"]


@pytest.mark.parametrize("kind", ["nbi", "nbc"])
@pytest.mark.parametrize("damage", ["emptied", "cut short", "a bit flipped"])
def test_damaged_code_is_compiled_again(package, kind, damage):
    """As by a power failure or a failing disk; it costs a line."""
    call(package)
    (file,) = package.glob(f"cache/edl6dof/*/caller.area.called*.{kind}")
    content = bytearray(file.read_bytes())
    content[len(content) // 2] ^= 1
    file.write_bytes({"emptied": b"", "cut short": content[:40], "a bit flipped": content}[damage])
    ran = small_programs.run(
        CALL.format(root=str(package)), cwd=package, NUMBA_CACHE_DIR=str(package / "cache")
    )
    assert ran.stdout.split()[:2] == ["6.0", "0"]
    assert ran.stderr.rstrip().endswith("is damaged; it is compiled again")
    assert call(package) == (6.0, 1)


def test_code_for_types_that_are_gone_is_compiled_again(package):
    """As after an update that renames the module of a named tuple: the sources of the helper are the same."""
    write(package, "spatial/helper.py", HELPER.format("pair.a").replace("factor()", "factor(pair)"))
    for name in ("kinds", "sorts"):
        caller = CALLER.replace("factor()", "factor(Pair(3.0))")
        write(package, "fsw/caller.py", f"from probe.fsw.{name} import Pair\n{caller}")
        write(package, f"fsw/{name}.py", "import typing\nclass Pair(typing.NamedTuple):\n    a: float\n")
        assert call(package) == (6.0, 0)
        assert call(package) == (6.0, 1)
        (package / "probe" / "fsw" / f"{name}.py").unlink()


def test_a_full_disk_costs_a_line_and_nothing_else(package):
    full = "import probe.kernels.cache as c; c.NEEDED_B = 1 << 62\nfrom probe.fsw.caller"
    ran = small_programs.run(
        CALL.replace("from probe.fsw.caller", full).format(root=str(package)), cwd=package,
        NUMBA_CACHE_DIR=str(package / "cache"),
    )  # fmt: skip
    assert ran.stdout.split()[0] == "6.0" and not list(package.rglob("*.nbc"))
    assert ran.stderr.startswith("edl6dof: no folder for machine code")


def test_a_disk_that_fills_while_code_is_written_costs_a_line_and_nothing_else(package):
    """By an index that is written to a full device, for each function and the one that calls it."""
    full = (
        "import os\n"
        "def save(*given, **named):\n    raise OSError(28, 'No space left on device')\n"
        "os.replace = save\nprint"
    )
    ran = small_programs.run(
        CALL.replace("print", full).format(root=str(package)), cwd=package,
        NUMBA_CACHE_DIR=str(package / "cache"),
    )  # fmt: skip
    assert (ran.returncode, ran.stdout.split()[0]) == (0, "6.0"), ran.stderr
    (line,) = ran.stderr.splitlines()
    assert line.startswith("edl6dof: machine code is not kept: No space left on device: ")
    assert call(package) == (6.0, 0)


@pytest.fixture
def shipped(package):
    """The package in another place, with its machine code in an archive and an empty cache."""
    call(package, NUMBA_CPU_NAME=kernels.shipped.TARGET)
    (compiled,) = (one for one in package.glob("cache/edl6dof/*") if one.is_dir())
    with tarfile.open(package / "probe" / "kernels" / "code.tar.xz", "w:xz") as archive:
        for file in compiled.iterdir():
            archive.add(file, file.name)
    (package / "installed").mkdir()
    (package / "probe").rename(package / "installed" / "probe")
    return package / "installed"


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="code is shipped for Linux")
class TestShippedCode:
    def test_a_package_with_machine_code_compiles_nothing(self, shipped):
        assert call(shipped) == (6.0, 1)
        write(shipped, "spatial/helper.py", HELPER.format("5.0"))
        assert call(shipped) == (10.0, 0), "nor does it fly stale code"

    def test_a_damaged_archive_costs_a_line_and_nothing_else(self, shipped):
        archive = shipped / "probe" / "kernels" / "code.tar.xz"
        archive.write_bytes(archive.read_bytes()[:-100])
        ran = small_programs.run(
            CALL.format(root=str(shipped)), cwd=shipped, NUMBA_CACHE_DIR=str(shipped / "cache")
        )
        assert ran.stdout.split()[:2] == ["6.0", "0"]
        assert ran.stderr.startswith(f"edl6dof: machine code of {archive} is not used: ")
        assert call(shipped) == (6.0, 1)

    @pytest.mark.parametrize(("instructions", "usable"), [({"fpu"}, True), ({"fpu", "nothing"}, False)])
    def test_code_is_for_processors_that_have_its_instructions(
        self, tmp_path, monkeypatch, instructions, usable
    ):
        monkeypatch.setattr(kernels.shipped, "ARCHIVE", tmp_path)
        monkeypatch.setattr(kernels.shipped, "_INSTRUCTIONS", instructions)
        assert kernels.shipped.is_usable() == usable


def test_folders_that_nobody_used_for_thirty_days_go(package):
    call(package)
    place = package / "cache" / "edl6dof"
    (used,) = (one for one in place.iterdir() if one.is_dir())
    for name, days in (("old", 1.1), ("young", 0.9)):
        (place / name).mkdir()
        (place / name / "code.nbc").write_bytes(b"code")
        os.utime(place / name, (time.time() - days * OLDEST_S,) * 2)
    os.utime(used, (time.time() - 1.1 * OLDEST_S,) * 2)
    assert call(package) == (6.0, 1), "a folder that is used stays"
    assert {one for one in place.iterdir() if one.is_dir()} == {used, place / "young"}


KERNEL = "from edl6dof.kernels import kernel\n@kernel\ndef twice(x):\n    return x + x\n"
TWICE = "import mine; print(mine.twice(1.5), sum(mine.twice.called.stats.cache_hits.values()))"


def test_machine_code_beside_a_file_from_outside_is_neither_read_nor_written(tmp_path):
    """A ``.nbc`` is a pickle: one that was received would run whatever its author likes."""
    (tmp_path / "mine.py").write_text(KERNEL)
    os.utime(tmp_path / "mine.py", (1e9, 1e9))
    for hits in "01":
        assert run(TWICE, tmp_path).split() == ["3.0", hits]
    assert not list(tmp_path.glob("**/__pycache__/*.nb*"))


def test_what_was_received_counts_as_it_was_received(tmp_path, monkeypatch):
    file = tmp_path / "law.py"
    file.write_text("x = 1\n")
    stamps = set()
    for content in (b"x = 1\n", b"x = 2\n"):
        monkeypatch.setitem(cache.received, str(file), content)
        stamps.add(cache.stamp.__wrapped__(str(file)))
    assert len(stamps) == 2


@pytest.mark.skipif(os.name == "nt", reason="Windows gives every user a folder for temporary files")
class TestNowhereToWrite:
    @pytest.fixture
    def homeless(self, tmp_path):
        """What a user has who has no home, and a module with a kernel."""
        (tmp_path / "mine.py").write_text(KERNEL)
        os.utime(tmp_path / "mine.py", (1e9, 1e9))
        (tmp_path / "tmp").mkdir()
        return {
            "HOME": "/dev/null",
            "XDG_CACHE_HOME": "",
            "NUMBA_CACHE_DIR": "",
            "TMPDIR": str(tmp_path / "tmp"),
        }

    def ended(self, place, settings):
        ran = small_programs.run(TWICE, cwd=place, **settings)
        assert ran.returncode == 0, ran.stderr
        return ran.stdout.split(), ran.stderr.splitlines()

    def test_a_user_without_a_home_gets_a_folder_of_his_own(self, tmp_path, homeless):
        folder = tmp_path / "tmp" / f"edl6dof-{os.getuid()}"
        said = [f"edl6dof: machine code is kept in {folder} (NUMBA_CACHE_DIR can name a better place)"]
        assert self.ended(tmp_path, homeless) == (["3.0", "0"], said)
        assert folder.stat().st_mode & 0o777 == 0o700
        assert self.ended(tmp_path, homeless)[0] == ["3.0", "1"]

    @pytest.mark.parametrize("kind", ["open to others", "a file", "a link"])
    def test_a_folder_that_others_prepared_is_not_used(self, tmp_path, homeless, kind):
        folder = tmp_path / "tmp" / f"edl6dof-{os.getuid()}"
        if kind == "a file":
            folder.write_text("")
        elif kind == "a link":
            (tmp_path / "elsewhere").mkdir(mode=0o700)
            folder.symlink_to(tmp_path / "elsewhere")
        else:
            folder.mkdir()
            folder.chmod(0o777)
        result, (line,) = self.ended(tmp_path, homeless)
        assert result == ["3.0", "0"]
        assert line.startswith("edl6dof: no folder for machine code can be written to")

    def test_a_chosen_folder_of_another_user_or_open_to_others_is_not_used(self, tmp_path, monkeypatch):
        folder = tmp_path / "edl6dof"
        assert cache._can_be_written(folder) and folder.stat().st_mode & 0o777 == 0o700
        monkeypatch.setattr(cache, "_user", lambda: folder.stat().st_uid + 1)
        assert not cache._can_be_written(folder)
        monkeypatch.undo()
        folder.chmod(0o770)
        assert not cache._can_be_written(folder)

    def test_a_home_that_is_no_path_makes_no_folder_here(self, tmp_path, homeless):
        before = sorted(tmp_path.iterdir())
        assert self.ended(tmp_path, homeless | {"HOME": "home"})[0] == ["3.0", "0"]
        assert sorted(tmp_path.iterdir()) == before


def test_the_decorator_leaves_other_users_of_numba_alone(tmp_path):
    (tmp_path / "theirs.py").write_text(
        "import numba\n@numba.njit(cache=True)\ndef thrice(x):\n    return 3.0 * x\n"
    )
    (tmp_path / "mine.py").write_text(KERNEL)
    program = (
        "import mine, theirs; print(mine.twice(1.5), theirs.thrice(1.0), theirs.thrice.stats.cache_path)"
    )
    *results, place = run(program, tmp_path).split()
    assert results == ["3.0", "3.0"] and "edl6dof" not in Path(place).relative_to(tmp_path).parts
    assert not numba.config.CACHE_LOCATOR_CLASSES


def test_division_by_zero_follows_numpy_and_rounding_is_not_relaxed():
    @kernels.kernel
    def divide(a, b):
        return a / b

    @kernels.kernel
    def compensated(a, b):
        return (a + b) - a - b

    assert divide(1.0, 0.0) == float("inf")
    assert compensated(1.0, 1e-17) == -1e-17  # fast-math would make it 0
