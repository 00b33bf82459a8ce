"""Make every picture of README and docs, and the gallery, docs/gallery.md:

    python tools/pictures.py              # draw the pictures that are out of date
    python tools/pictures.py NAME ...     # draw these
    python tools/pictures.py --list       # name those that are out of date; exit status 1 if there are any

The table of this file holds each picture with its command, the golden flights that it shows, and the code
that draws it.  A picture is out of date when one of these has changed since it was drawn, of which
``tools/pictures.json`` keeps the hash.  Everything is flown and drawn in a temporary folder.  Pictures of
replays need the viewer (see ``edl6dof replay --help``), that of notebook ``train`` Stable-Baselines3, and
``work_precision`` the extra ``bench``.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import re
import shlex
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

from doc_results import ROOT, golden_hashes
from docs_notebooks import NAMES
from PIL import Image

#: Hash of what each picture showed when it was drawn, by its file.
DRAWN = ROOT / "tools" / "pictures.json"
#: Greatest width (pixels) and quality of the pictures as they are kept.
WIDTH, QUALITY = 1500, 85
#: Code that draws replays and reports.
REPLAY, REPORT = "edl6dof/replay", "edl6dof/report"
#: Markdown of a picture: its file.
_SHOWN = re.compile(r"!\[[^\]]*\]\(([^)]+)\)")

#: Commands that fly what the pictures show, by the folder that they write.
FLIGHTS = {
    "runs/tianwen1": "fly tianwen1",
    "runs/heavy": "fly tianwen1 --out runs/heavy --set vehicle.mass.entry_kg=1350",
    "runs/rocks": "fly tianwen1_hazards --out runs/rocks --set terrain.landing_area.rock_abundance=0.1",
    "runs/fnpeg": (
        "fly tianwen1 --out runs/fnpeg --set flight_software.guidance.entry.law=fnpeg "
        "--set flight_software.guidance.entry.reversal.logic=own_sign"
    ),
    "runs/convex": "fly tianwen1 --out runs/convex --set flight_software.guidance.powered.law=convex",
    "runs/mc": "campaign tianwen1_mc -n 100 --out runs/mc",
    "runs/titan_probe": "fly titan_probe",
    "runs/earth_drop": "fly earth_drop",
    "runs/faults": (
        "faults tianwen1_meters --out runs/faults --pairs --kinds stuck_on --at 200 "
        "--components A1,A2,A3,A4,P1,P2,P3,P4,D1,D3,D5,D7"
    ),
}
#: Remarks for tools/run_docs.py above commands that end with status 1.
OUTSIDE_LIMITS = {"runs/faults": "<!-- or status 1: `faults tianwen1_meters`: some are not within limits -->"}


class Picture(NamedTuple):
    """A picture.

    Attributes:
        file: where it is kept, below the root of the repository.
        shows: text below it in the gallery; empty for a picture of another page.
        runs: the folders of :data:`FLIGHTS` that it needs.
        command: draws it, in a folder with these runs.
        writes: the file that the command writes.
        needs: golden flights, and files and folders of code, whose change makes it out of date.
    """

    file: str
    shows: str
    runs: tuple[str, ...]
    command: str
    writes: str
    needs: tuple[str, ...]

    @property
    def name(self) -> str:
        """File name without suffix."""
        return Path(self.file).stem

    @property
    def hash(self) -> str:
        """Hash of flights and code that the picture shows, and of the commands that make it."""
        flights, made = golden_hashes(), [FLIGHTS[run] for run in self.runs]
        held = {one: flights[one] if one in flights else code(one) for one in self.needs}
        text = json.dumps([self.command, self.writes, made, held], sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()[:8]


def code(place: str) -> dict[str, str]:
    """Return the text of a file, or of every Python file in a folder, by its path.

    Raises:
        FileNotFoundError: there is none.
    """
    files = [ROOT / place] if (ROOT / place).is_file() else sorted((ROOT / place).rglob("*.py"))
    if not files:
        raise FileNotFoundError(place)
    return {str(path.relative_to(ROOT)): path.read_text(encoding="utf-8") for path in files}


def shown(name: str, shows: str, runs: tuple[str, ...], command: str, writes: str, drawing: str) -> Picture:
    """A picture of the gallery; ``drawing``: the code that draws it."""
    flown = dict.fromkeys(FLIGHTS[run].split()[1] for run in runs)
    return Picture(f"docs/gallery/{name}.webp", shows, runs, f"edl6dof {command}", writes, (*flown, drawing))


def tour(name: str, shows: str, run: str, t: float) -> Picture:
    """The picture of the scripted camera of a run at a time (s)."""
    command = f"replay {run} --tour --screenshot {name}.png --at {t:g}"
    return shown(name, shows, (run,), command, f"{name}.png", REPLAY)


def page(name: str, shows: str, title: str, t: float, *runs: str) -> Picture:
    """A page of the replay of some runs at a time (s)."""
    command = f"replay {' '.join(runs)} --page {shlex.quote(title)} --screenshot {name}.png --at {t:g}"
    return shown(name, shows, runs, command, f"{name}.png", REPLAY)


def figure(name: str, shows: str, run: str, key: str) -> Picture:
    """A figure of the report of a run or a campaign."""
    return shown(name, shows, (run,), f"report {run} --png", f"{run}/report/{key}.png", REPORT)


def plot(name: str, shows: str, runs: tuple[str, ...], words: str) -> Picture:
    """Channels of some runs."""
    command = f"plot {' '.join(runs)} {words} --out {name}.png"
    return shown(name, shows, runs, command, f"{name}.png", REPORT)


def notebook(name: str) -> Picture:
    """The figure of the last cell of a notebook."""
    source, command = f"docs/notebooks/{name}.py", f"python tools/docs_notebooks.py --picture {name}"
    file, flown = f"docs/notebooks/{name}.webp", ("tianwen1", "tianwen1_mc")
    return Picture(file, "", (), command, f"{name}.png", (*flown, source, REPORT))


#: Pictures of the gallery in their order.
GALLERY = (
    tour("entry", "Entry at Mach 24, banked.", "runs/tianwen1", 100.0),
    tour("parachute", "The disk-gap-band parachute, 22 s after the mortar.", "runs/tianwen1", 302.0),
    tour("heat_shield", "The heat shield falls away.", "runs/tianwen1", 311.3),
    tour("powered", "Powered descent, 300 m above the ground.", "runs/tianwen1", 470.0),
    tour("touchdown", "Dust under the engine, metres above the ground.", "runs/tianwen1", 532.2),
    tour("landed", "The lander on its legs.", "runs/tianwen1", 536.5),
    page(
        "flight", "The whole replay: views, readout, plots, phases, events.", "Flight", 296.0, "runs/tianwen1"
    ),
    page("hazards", "The hazard map that the lander made in hover.", "Hazards", 508.0, "runs/rocks"),
    page("two_flights", "Two flights in one replay.", "Flight", 480.0, "runs/tianwen1", "runs/heavy"),
    page(
        "campaign",
        "A campaign: trajectories, landing footprint, and the cases nearest to a limit.",
        "Campaign",
        300.0,
        "runs/mc",
    ),
    shown(
        "vehicle",
        "A vehicle with its nozzles, tank and centres of mass.",
        (),
        "show tianwen1 --vehicle -o vehicle.png",
        "vehicle.png",
        REPORT,
    ),
    figure("overview", "One flight from entry to touchdown.", "runs/tianwen1", "overview"),
    plot("rates", "Body rates during the entry.", ("runs/tianwen1",), "'truth.rate_*' --from 60 --to 280"),
    figure(
        "phase_plane",
        "Phase planes of lift control: bank reversals at the largest bank rate.",
        "runs/tianwen1",
        "phase_plane_bank_to_steer",
    ),
    figure("thrusters", "Mean duty of each thruster.", "runs/tianwen1", "thrusters"),
    plot(
        "laws",
        "Bank angles of two guidance laws on the same entry.",
        ("runs/tianwen1", "runs/fnpeg"),
        "truth.bank_deg --to 280",
    ),
    figure("convex", "Powered descent with the least propellant.", "runs/convex", "powered"),
    figure("footprint", "Landing points of a hundred dispersed flights.", "runs/mc", "footprint"),
    figure(
        "faults",
        "All pairs of twelve thrusters stuck on at 200 s: isolated thrusters and times of isolation "
        "(with flow meters, an estimate).",
        "runs/faults",
        "faults_stuck_on_0",
    ),
    tour("titan", "A probe sinks through the haze of Titan.", "runs/titan_probe", 6000.0),
    tour("earth", "A capsule falls on Earth.", "runs/earth_drop", 60.0),
)


#: Missions whose golden flights validation compares with the real ones.
MISSIONS = (
    *("genesis", "insight", "mars2020", "msl_landing", "pathfinder", "phoenix", "schiaparelli", "stardust"),
    *("tianwen1_mc", "viking1"),
)
PICTURES = (
    *GALLERY,
    Picture(
        "docs/gallery/validation.webp",
        "",
        (),
        "edl6dof validate",
        "runs/validation/validation.png",
        (*MISSIONS, "edl6dof/missions", REPORT),
    ),
    Picture(
        "docs/gallery/work_precision.webp",
        "",
        (),
        "python tools/bench.py --only precision --in-place --picture precision.png",
        "precision.png",
        ("tianwen1", "tools/bench_precision.py", "tools/peers_jsbsim.py", "tools/peers_basilisk.py", REPORT),
    ),
    Picture(
        "docs/gallery/modulation.webp",
        "",
        (),
        "python tools/modulation.py --figure modulation.png -n 100",
        "modulation.png",
        ("tianwen1", "tianwen1_mc", "tools/modulation.py", REPORT),
    ),
    Picture(
        "docs/conventions.webp",
        "",
        (),
        "python tools/docs_conventions.py conventions.png",
        "conventions.png",
        ("tools/docs_conventions.py", "edl6dof/spatial/frames.py", "edl6dof/spatial/quaternion.py"),
    ),
    *(notebook(name) for name in NAMES),
)


def drawn() -> dict[str, str]:
    """Return the hash of each picture when it was drawn, by its file."""
    found: dict[str, str] = json.loads(DRAWN.read_text(encoding="utf-8"))
    return found


def out_of_date() -> list[Picture]:
    """Return the pictures whose flights or code have changed since they were drawn."""
    known = drawn()
    return [picture for picture in PICTURES if known.get(picture.file) != picture.hash]


def shown_by(page: Path) -> set[str]:
    """Return the files of the pictures that a page of README or docs shows, below the root."""
    links = _SHOWN.findall(page.read_text(encoding="utf-8"))
    return {os.path.relpath(page.parent / link, ROOT) for link in links if "://" not in link}


def make(pictures: Iterable[Picture], folder: Path) -> list[str]:
    """Fly and draw in a folder, and keep the pictures; return the commands that failed."""
    failed: list[str] = []
    (folder / "tools").symlink_to(ROOT / "tools")
    for picture in pictures:
        new = [run for run in picture.runs if not (folder / run).exists()]
        commands = [*(f"edl6dof {FLIGHTS[run]}" for run in new), picture.command]
        if bad := [command for command in commands if not execute(command, folder)]:
            failed += bad
            continue
        with Image.open(folder / picture.writes) as image:
            image.thumbnail((WIDTH, 10 * WIDTH), Image.Resampling.LANCZOS)
            image.convert("RGB").save(ROOT / picture.file, quality=QUALITY)
        text = json.dumps(drawn() | {picture.file: picture.hash}, indent=0, sort_keys=True)
        DRAWN.write_text(text + "\n", encoding="utf-8")
    return failed


def execute(command: str, folder: Path) -> bool:
    """Run a command; return False if it failed.  A flight outside its limits is one that can be shown."""
    print(f"$ {command}", flush=True)
    words = shlex.split(command)
    starts = {"edl6dof": [sys.executable, "-m", "edl6dof"], "python": [sys.executable]}
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    program = [*starts[words[0]], *words[1:]]
    return subprocess.run(program, cwd=folder, env=environment, stdout=subprocess.PIPE).returncode < 2


def text() -> str:
    """Return the page of the gallery."""
    parts = [
        "# Gallery\n\nEach picture shows a simulated flight, with the commands that made it.\n"
        "`edl6dof report RUN --png` writes the figures of a report to the folder `report` in the run folder "
        "`RUN`.\n"
    ]
    begun: set[str] = set()  # campaigns, which a second command would refuse to replace
    for picture in GALLERY:
        lines = "\n".join(
            [*(f"edl6dof {FLIGHTS[run]}" for run in picture.runs if run not in begun), picture.command]
        )
        begun |= {run for run in picture.runs if FLIGHTS[run].startswith("campaign")}
        outside = "".join(f"{OUTSIDE_LIMITS[run]}\n" for run in picture.runs if run in OUTSIDE_LIMITS)
        image = f"![{picture.shows}]({picture.file.removeprefix('docs/')})"
        parts.append(f"## {picture.shows.rstrip('.')}\n\n{image}\n\n{outside}```sh\n{lines}\n```\n")
    return "\n".join(parts)


def main() -> int:
    """Make or list what the command line asks for."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help="names of pictures")
    parser.add_argument("--list", action="store_true", help="name the pictures that are out of date")
    asked = parser.parse_args()
    if unknown := set(asked.names) - {picture.name for picture in PICTURES}:
        parser.error(f"no such picture: {', '.join(sorted(unknown))}")
    chosen = (
        [picture for picture in PICTURES if picture.name in asked.names] if asked.names else out_of_date()
    )
    if asked.list:
        print("".join(f"{picture.file}: out of date: {picture.command}\n" for picture in chosen), end="")
        return 1 if chosen else 0
    (ROOT / "docs" / "gallery.md").write_text(text(), encoding="utf-8")
    with TemporaryDirectory(prefix="edl6dof-") as folder:
        failed = make(chosen, Path(folder))
    print("".join(f"failed: {command}\n" for command in failed), end="", file=sys.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
