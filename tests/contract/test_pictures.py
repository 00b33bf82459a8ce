"""Every picture of README and docs has a command that draws it, and those older than their code are reported.

They are not refused: drawing all of them takes long.
"""

from __future__ import annotations

import json
import sys
import warnings
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tools"))
import pictures
from doc_results import ROOT, pages
from docs_notebooks import NAMES
from docs_notebooks import page as notebook_page
from pictures import PICTURES, Picture, out_of_date, shown_by

SUFFIXES = (".webp", ".png", ".jpg", ".jpeg", ".gif", ".svg")


def test_pictures_that_are_out_of_date_are_reported():
    for picture in out_of_date():
        warnings.warn(f"{picture.file}: out of date: python tools/pictures.py {picture.name}", stacklevel=1)


def test_every_picture_of_the_documents_has_a_command_and_every_command_a_picture():
    kept = {str(path.relative_to(ROOT)) for path in (ROOT / "docs").rglob("*") if path.suffix in SUFFIXES}
    assert kept == {picture.file for picture in PICTURES}
    assert len({picture.name for picture in PICTURES}) == len(PICTURES), "names choose pictures"


def test_every_picture_is_shown_and_every_shown_picture_is_kept():
    shown = set().union(*(shown_by(page) for page in pages()))
    shown |= {f"docs/notebooks/{name}.webp" for name in NAMES if f"({name}.webp)" in notebook_page(name)}
    assert shown == {picture.file for picture in PICTURES}


def test_the_page_of_the_gallery_is_that_of_the_table():
    assert (ROOT / "docs" / "gallery.md").read_text(encoding="utf-8") == pictures.text()


@pytest.fixture
def picture(monkeypatch, tmp_path) -> Picture:
    """A picture that was just drawn, of a flight and of two files of code."""
    for name in ("a.py", "b.py"):
        (tmp_path / "code" / name).parent.mkdir(exist_ok=True)
        (tmp_path / "code" / name).write_text("1\n", encoding="utf-8")
    made = Picture("docs/gallery/x.webp", "", ("runs/tianwen1",), "edl6dof x", "x.png", ("tianwen1", "code"))
    monkeypatch.setattr(pictures, "ROOT", tmp_path)
    monkeypatch.setattr(pictures, "DRAWN", tmp_path / "drawn.json")
    monkeypatch.setattr(pictures, "PICTURES", (made,))
    pictures.DRAWN.write_text(json.dumps({made.file: made.hash}), encoding="utf-8")
    return made


def test_a_picture_is_out_of_date_once_its_code_changes(picture, tmp_path):
    assert out_of_date() == []
    (tmp_path / "code" / "b.py").write_text("2\n", encoding="utf-8")
    assert out_of_date() == [picture]


def test_a_picture_is_out_of_date_once_its_flight_changes(picture, monkeypatch):
    monkeypatch.setattr(pictures, "golden_hashes", lambda: {"tianwen1": {"tables.air": "other"}})
    assert out_of_date() == [picture]


def test_a_picture_is_out_of_date_once_its_command_changes(picture, monkeypatch):
    monkeypatch.setitem(pictures.FLIGHTS, "runs/tianwen1", "fly tianwen1 --set seed=2")
    assert out_of_date() == [picture]


def test_code_that_is_not_there_is_no_code():
    with pytest.raises(FileNotFoundError, match="edl6dof/nowhere"):
        pictures.code("edl6dof/nowhere")


def test_a_picture_is_kept_with_its_hash_and_a_failed_one_is_not(picture, monkeypatch, tmp_path):
    from PIL import Image

    (tmp_path / "docs" / "gallery").mkdir(parents=True)
    (tmp_path / "out").mkdir()
    pictures.DRAWN.write_text("{}", encoding="utf-8")
    monkeypatch.setattr(pictures, "execute", lambda command, folder: False)
    assert pictures.make([picture], tmp_path / "out") == ["edl6dof fly tianwen1", "edl6dof x"]
    assert out_of_date() == [picture]
    (tmp_path / "out" / "tools").unlink()

    def draw(command, folder):
        Image.new("RGB", (3000, 1000)).save(folder / "x.png")
        return True

    monkeypatch.setattr(pictures, "execute", draw)
    assert pictures.make([picture], tmp_path / "out") == []
    assert Image.open(tmp_path / picture.file).size == (1500, 500)
    assert out_of_date() == []
