"""Machine code of plugins goes when their files have gone, and no other."""

import os
import time

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
    cache = tmp_path / "__pycache__"
    cache.mkdir()
    gone = folder(cache, "plugins-000000000000", [tmp_path / "gone.py"])
    program = f"import edl6dof.jit as jit; jit.called_from = lambda path: [{str(plugin)!r}]"
    ran = small_programs.run(f"{program}; import mine; mine.twice(1.5)", cwd=tmp_path)
    assert ran.returncode == 0, ran.stderr
    (mine,) = cache.glob("plugins-*")
    assert mine != gone and (mine / "sources.txt").read_text() == str(plugin)
    assert list(mine.glob("*.nbc"))
