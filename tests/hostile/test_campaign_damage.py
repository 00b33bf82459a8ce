"""Whatever happens to a file of a campaign's folder: a message that names it, or the part is flown again;
never another number.
"""

from __future__ import annotations

import contextlib
import io
import os
import shutil
import sys
from itertools import islice
from pathlib import Path
from random import Random

import pytest

sys.path.append(str(Path(__file__).resolve().parents[1] / "campaign"))

import in_process
from campaign_run import write_drop

from edl6dof.campaign import run
from edl6dof.campaign.design.plan import load_plan
from edl6dof.campaign.engines import Threads
from edl6dof.campaign.parts import PART
from edl6dof.campaign.store import Store

RUN, TWIN = "runs/drops", "runs/twin"
CASES = 120  # three parts

READERS = {
    "resume": ("campaign", RUN, "--resume", "--json"),
    "compare": ("compare", RUN, TWIN, "--json"),
    "report": ("report", RUN, "--out", "report.html", "--force"),
    "refly": ("refly", RUN, "3", "--no-replay", "--out", "runs/again", "--force"),
    "replay": ("replay", RUN, "--html", "replay.html", "--force"),
}


class StoppedThreads(Threads):
    """Threads that are stopped after two parts."""

    def rows(self, plan, ranges):
        """Rows of the first two ranges."""
        yield from islice(super().rows(plan, ranges), 2 * PART)
        raise KeyboardInterrupt


@pytest.fixture(scope="module")
def flown(tmp_path_factory):
    """A folder with a campaign complete, its twin, and the same campaign unfinished."""
    folder = tmp_path_factory.mktemp("flown")
    plan = load_plan(write_drop(folder), cases=CASES)
    complete = Store(folder / "complete/drops")
    run.begin(plan, complete, None)
    run.fly(plan, complete, Threads())
    shutil.copytree(complete.folder, folder / "complete/twin")
    store = Store(folder / "unfinished/drops")
    run.begin(plan, store, None)
    with pytest.raises(KeyboardInterrupt):
        run.fly(plan, store, StoppedThreads())
    return folder


@pytest.fixture
def lay_out(flown, tmp_path, monkeypatch):
    """Puts a copy of the complete or the unfinished campaign into ``runs``, and returns its folder."""
    monkeypatch.chdir(tmp_path)

    def laid_out(kind: str) -> Path:
        shutil.rmtree("runs", ignore_errors=True)
        shutil.copytree(flown / "complete", "runs")
        if kind == "unfinished":
            shutil.rmtree(RUN)
            shutil.copytree(flown / "unfinished/drops", RUN)
        return Path(RUN)

    return laid_out


def edl6dof(*words: str) -> tuple[int, str, str]:
    """Status, standard output and standard error of a command; anything that it does not catch comes out."""
    sys.argv = ["edl6dof", *words]
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err), pytest.raises(SystemExit) as end:
        in_process.main()
    return int(end.value.code or 0), out.getvalue(), err.getvalue()


def flip(path: Path, random: Random) -> str:
    """Turn one bit of a file over; returns which."""
    content = bytearray(path.read_bytes())
    place, bit = random.randrange(len(content)), random.randrange(8)
    content[place] ^= 1 << bit
    path.write_bytes(content)
    return f"{path.name}: byte {place}, bit {bit}"


@pytest.mark.parametrize("numbers", [range(0, 20, 4), pytest.param(range(30), marks=pytest.mark.long)])
def test_every_flipped_bit_of_a_complete_campaign_is_told(lay_out, numbers):
    """Nothing of a complete campaign can be flown again, so every reader says which file is damaged."""
    random, readers = Random(1), ("resume", "compare", "refly")
    for number in numbers:
        folder = lay_out("complete")
        name = ("cases.parquet", "cases.parquet", "summary.json", "campaign.json", "campaign.yaml")[
            number % 5
        ]
        what = flip(folder / name, random)
        status, out, err = edl6dof(*READERS[readers[number // 5 % 3]])
        assert (status, out) == (2, "") and name in err and "is damaged" in err, what


@pytest.mark.parametrize("numbers", [range(0, 15, 3), pytest.param(range(20), marks=pytest.mark.long)])
def test_every_flipped_bit_of_an_unfinished_campaign_is_flown_again_or_told(lay_out, flown, numbers):
    """The parts come back; what says which campaign it is does not."""
    random, undisturbed = Random(2), (flown / "complete/drops/cases.parquet").read_bytes()
    for number in numbers:
        folder = lay_out("unfinished")
        name = (
            "parts/000000.parquet",
            "parts/000001.parquet",
            "parts/000001.sha256",
            "campaign.json",
            "campaign.yaml",
        )[number % 5]
        what = flip(folder / name, random)
        status, _, err = edl6dof(*READERS["report" if number % 4 else "compare"])
        assert status == 2 and "is damaged" in err, what
        status, _, err = edl6dof(*READERS["resume"])
        if name.startswith("parts"):
            assert status == 0 and (folder / "cases.parquet").read_bytes() == undisturbed, what
        else:
            assert status == 2 and f"{name}: is damaged" in err, what


def damaged(path: Path, how: str) -> None:
    """Replace a file by something that it is not."""
    content = path.read_bytes()
    path.unlink()
    if how == "folder":
        path.mkdir()
    elif how == "link to nothing":
        path.symlink_to("nowhere")
    elif how != "gone":
        path.write_bytes(
            {
                "empty": b"",
                "truncated": content[: len(content) // 2],
                "longer": content + b"\0",
                "random": Random(3).randbytes(5000),
                "list": b"[]\n",
                "nothing in it": b"{}\n",
                "number": b"1e999999\n",
                "deep": b"[" * 100_000,
            }[how]
        )


KINDS = (
    "gone",
    "folder",
    "link to nothing",
    "empty",
    "truncated",
    "longer",
    "random",
    "list",
    "nothing in it",
    "number",
    "deep",
)


@pytest.mark.parametrize("every", [4, pytest.param(1, marks=pytest.mark.long)])
@pytest.mark.parametrize(
    "name",
    [
        "campaign.json",
        "campaign.yaml",
        pytest.param("summary.json", marks=pytest.mark.long),
        "cases.parquet",
    ],
)
def test_file_of_a_complete_campaign_that_is_not_what_it_was(lay_out, name, every):
    """A message with the folder or the file, by every command that reads it: each kind of damage meets every
    fourth of them, the next kind others.
    """
    needed_by = READERS if name.startswith("campaign") else ("resume", "compare", "report", "refly")
    for number, how in enumerate(KINDS):
        for reader in list(needed_by)[(number + 1) % every :: every]:
            if (how, name, reader) == ("gone", "summary.json", "resume"):
                continue  # it is unfinished then, and flies anew
            damaged(lay_out("complete") / name, how)
            status, out, err = edl6dof(*READERS[reader])
            assert (status, out) == (2, "") and RUN in err and len(err.splitlines()) == 1, (
                how,
                reader,
                status,
                out,
                err,
            )


PARTS = ("parts/000000.parquet", "parts/000001.sha256")


@pytest.mark.parametrize(
    ("name", "how"),
    [
        pytest.param(name, how, marks=[] if how in kinds else pytest.mark.long)
        for name, kinds in zip(PARTS, (("folder", "truncated"), ("gone",)), strict=True)
        for how in KINDS
    ],
)
def test_part_that_is_not_what_it_was_is_flown_again(lay_out, flown, name, how):
    damaged(lay_out("unfinished") / name, how)
    status, _, err = edl6dof(*READERS["compare"])
    assert status == 2 and "parts/0000" in err or (how, name) == ("gone", "parts/000000.parquet")
    status, _, err = edl6dof(*READERS["resume"])
    if how == "folder":
        assert status == 2 and f"{name}: Is a directory" in err
    else:
        assert (Path(RUN) / "cases.parquet").read_bytes() == (
            flown / "complete/drops/cases.parquet"
        ).read_bytes()


def test_part_of_another_plan_never_counts(lay_out, flown):
    """Its hash is right, and its cases have the right numbers."""
    folder = lay_out("unfinished")
    other = load_plan(write_drop(Path()), cases=CASES, seed=9)
    store = Store(Path("other"))
    run.begin(other, store, None)
    with pytest.raises(KeyboardInterrupt):
        run.fly(other, store, StoppedThreads())
    shutil.copytree(store.folder / "parts", folder / "parts", dirs_exist_ok=True)
    status, _, err = edl6dof(*READERS["report"])
    assert status == 2 and "parts/000000.parquet: belongs to another campaign" in err
    assert edl6dof(*READERS["resume"])[0] == 0
    assert (folder / "cases.parquet").read_bytes() == (flown / "complete/drops/cases.parquet").read_bytes()


def test_summary_and_table_of_another_campaign_are_told(lay_out):
    folder = lay_out("complete")
    other = Store(Path("other"))
    plan = load_plan(write_drop(Path()), cases=CASES, seed=9)
    run.begin(plan, other, None)
    run.fly(plan, other, Threads())
    for name in ("summary.json", "cases.parquet"):
        shutil.copy(other.folder / name, folder / name)
        status, _, err = edl6dof(*READERS["compare"])
        assert status == 2 and f"{RUN}/summary.json: belongs to another campaign" in err


@pytest.mark.parametrize(
    "stranger", ["thesis.txt", "parts/mine.parquet", "report/notes.md", ".thesis.swp", "runs"]
)
def test_force_names_what_it_does_not_know_and_removes_nothing(lay_out, stranger):
    """A folder counts as unknown too, as does what looks like a file half written by somebody else."""
    for kind in ("complete", "unfinished"):
        folder = lay_out(kind)
        place = folder / stranger
        place.parent.mkdir(exist_ok=True)
        place.mkdir() if stranger == "runs" else place.write_text("mine")
        before = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
        status, _, err = edl6dof("campaign", write_drop(Path()), "--force", "-q", "-n", "10")
        assert status == 2 and f"{place}: is not of the campaign" in err
        assert {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()} == before


def test_force_replaces_all_that_the_program_writes(lay_out):
    folder = lay_out("unfinished")
    (folder / "report").mkdir()
    for name in (
        "report.html",
        "report.pdf",
        "report/footprint.png",
        ".cases.parquet.77.part",
        ".77.report.html",
        "parts/.000002.parquet.77.part",
    ):
        (folder / name).write_bytes(b"")
    assert edl6dof("campaign", write_drop(Path()), "--force", "-q", "-n", "10")[0] == 0
    assert sorted(os.listdir(folder)) == ["campaign.json", "campaign.yaml", "cases.parquet", "summary.json"]
    assert Store(folder).table().num_rows == 10
