"""``edl6dof cache``: what machine code is kept, and how it is cleared."""

from __future__ import annotations

import pytest
from cli_run import run

from edl6dof.kernels import cache


@pytest.fixture
def kept(tmp_path, monkeypatch):
    """Folders of this installation, and of another."""
    own, other = tmp_path / "this", tmp_path / "other"
    for place in (own, other):
        place.mkdir()
        (place / "kernel.nbc").write_bytes(bytes(1_500_000))
    monkeypatch.setattr(cache, "folder", lambda: own)
    return own, other


def test_sizes_are_shown(kept, capsys, monkeypatch):
    sizes = "  this installation: 1.5 MB in 1 files\n  others: 1.5 MB in 1 files\n"
    assert run(capsys, monkeypatch, "cache") == (0, f"{kept[0].parent}\n{sizes}", "")


@pytest.mark.parametrize("words, left", [((), [False, True]), (("--all",), [False, False])])
def test_own_code_is_cleared_or_all(words, left, kept, capsys, monkeypatch):
    code, out, _ = run(capsys, monkeypatch, "cache", "--clear", *words)
    assert code == 0 and f"removed: {left.count(False)} folder" in out
    assert [place.exists() for place in kept] == left


def test_nothing_is_removed_without_being_asked_to(kept, capsys, monkeypatch):
    assert run(capsys, monkeypatch, "cache", "--all")[0] == 2
    assert all(place.exists() for place in kept)
