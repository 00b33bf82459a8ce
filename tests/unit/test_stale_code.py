"""Machine code of plugins goes when their files have gone, and no other."""

import os
import time
from pathlib import Path

import small_programs

from edl6dof.stale_code import OLDEST_S, note_sources, remove_stale


def folder(parent, name, files=None):
    made = parent / name
    made.mkdir()
    (made / "code.nbc").write_bytes(b"code")
    if files is not None:
        note_sources(made, [str(file) for file in files])
    return made


def test_folders_go_whose_plugins_are_no_longer_all_there(tmp_path):
    here, gone = tmp_path / "here.py", tmp_path / "gone.py"
    here.write_text("")
    kept = [folder(tmp_path, "plugins-1", [here]), folder(tmp_path, "other", [gone])]
    stale = [folder(tmp_path, "plugins-2", [gone]), folder(tmp_path, "plugins-3", [here, gone])]
    remove_stale(tmp_path)
    assert all(each.is_dir() for each in kept)
    assert not any(each.exists() for each in stale)


def test_a_folder_that_does_not_say_whose_it_is_goes_when_it_is_old(tmp_path):
    young, old = folder(tmp_path, "plugins-1"), folder(tmp_path, "plugins-2")
    for each, age in ((young, 0.9 * OLDEST_S), (old, 1.1 * OLDEST_S)):
        os.utime(each, (time.time() - age,) * 2)
    remove_stale(tmp_path)
    assert young.is_dir() and not old.exists()


def test_a_kernel_that_is_cached_notes_its_plugins_and_clears_those_of_others(tmp_path):
    """A process that has plugins: its folder says which, and that of a plugin since removed is gone."""
    (tmp_path / "mine.py").write_text(
        "from edl6dof.jit import kernel\n@kernel\ndef twice(x):\n    return x + x\n"
    )
    plugin = tmp_path / "plugin.py"
    plugin.write_text("")
    cache = tmp_path / "cache"
    program = (
        f"import edl6dof.jit as jit; jit.called_from = lambda path: [{str(plugin)!r}]; "
        "import mine; mine.twice(1.5)"
    )

    def flies():
        ran = small_programs.run(program, cwd=tmp_path, NUMBA_CACHE_DIR=str(cache))
        assert ran.returncode == 0, ran.stderr
        return list(cache.glob("*/plugins-*"))

    (mine,) = flies()
    gone = folder(mine.parent, "plugins-000000000000", [tmp_path / "gone.py"])
    assert flies() == [mine] and not gone.exists()
    assert (mine / "sources.txt").read_text() == str(plugin)
    assert list(mine.glob("*.nbc"))


def test_machine_code_beside_a_file_from_outside_is_neither_read_nor_written(tmp_path):
    """A ``.nbc`` is a pickle: one that was received would run whatever its author likes."""
    (tmp_path / "mine.py").write_text(
        "from edl6dof.jit import kernel\n@kernel\ndef twice(x):\n    return x + x\n"
    )
    program = "import mine; mine.twice(1.5); print(mine.twice._cache.cache_path)"
    ran = small_programs.run(program, cwd=tmp_path, XDG_CACHE_HOME=str(tmp_path / "user"))
    assert ran.returncode == 0, ran.stderr
    assert not list((tmp_path / "__pycache__").glob("*.nb*"))
    assert not Path(ran.stdout.strip()).is_relative_to(tmp_path / "__pycache__")
