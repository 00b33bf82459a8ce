"""Make the gallery, docs/gallery.md and its pictures, from flights made now: ``python tools/gallery.py``.

Each picture stands beside the command that made it.  Everything is flown and drawn in a folder for the time
being; ``--only NAME,NAME`` draws some pictures again and keeps the others.  It needs the viewer (see
``edl6dof replay --help``) and, for small files, Pillow, which comes with matplotlib.
"""

from __future__ import annotations

import argparse
import re
import shlex
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

from doc_results import flights_hash
from PIL import Image

DOCS = Path(__file__).resolve().parents[1] / "docs"
#: Width (pixels) and quality of the pictures as they are kept.
WIDTH, QUALITY = 1280, 82

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
    """A picture: its name, what it shows, the flights it needs, the command that draws it, and the file
    that the command writes where that is not the picture's own name.
    """

    name: str
    shows: str
    flights: tuple[str, ...]
    command: str
    writes: str = ""


def tour(name: str, shows: str, run: str, t: float) -> Picture:
    """What the scripted camera sees of a run at a time (s)."""
    return Picture(name, shows, (run,), f"replay {run} --tour --screenshot {name}.png --at {t:g}")


def page(name: str, shows: str, title: str, t: float, *runs: str) -> Picture:
    """A page of the replay of some runs at a time (s)."""
    return Picture(
        name,
        shows,
        runs,
        f"replay {' '.join(runs)} --page {shlex.quote(title)} --screenshot {name}.png --at {t:g}",
    )


def figure(name: str, shows: str, run: str, key: str) -> Picture:
    """A figure of the report of a run or a campaign."""
    return Picture(name, shows, (run,), f"report {run} --png", f"{run}/report/{key}.png")


PICTURES = (
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
    Picture(
        "vehicle",
        "A vehicle with its nozzles, tank and centres of mass.",
        (),
        "show tianwen1 --vehicle -o vehicle.png",
    ),
    figure("overview", "One flight from entry to touchdown.", "runs/tianwen1", "overview"),
    Picture(
        "rates",
        "Body rates during the entry.",
        ("runs/tianwen1",),
        "plot runs/tianwen1 'truth.rate_*' --from 60 --to 280 --out rates.png",
    ),
    figure(
        "phase_plane",
        "Phase planes of lift control: bank reversals at the largest bank rate.",
        "runs/tianwen1",
        "phase_plane_bank_to_steer",
    ),
    figure("thrusters", "Mean duty of each thruster.", "runs/tianwen1", "thrusters"),
    Picture(
        "laws",
        "Bank angles of two guidance laws on the same entry.",
        ("runs/tianwen1", "runs/fnpeg"),
        "plot runs/tianwen1 runs/fnpeg truth.bank_deg --to 280 --out laws.png",
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


def depends_on(picture: Picture) -> str:
    """Golden flights of a picture, and the folder of the package that draws it."""
    flown = (FLIGHTS[run].split()[1] for run in picture.flights)
    drawing = "replay" if picture.command.startswith("replay") else "report"
    return ", ".join(dict.fromkeys([*flown, drawing]))


def remark(picture: Picture, page: str, drawn: bool) -> str:
    """Remark of a picture on the page, which dates it (:mod:`doc_results`): now, or as on the last page."""
    command, needs = f"python tools/gallery.py --only {picture.name}", depends_on(picture)
    found = re.search(rf"`{re.escape(command)}` on .* ([0-9a-f]{{8}}) -->", page)
    date = flights_hash(needs) if drawn else found[1] if found else "0" * 8
    return f"<!-- drawn by `{command}` on {needs} {date} -->\n"


def make(pictures: tuple[Picture, ...], folder: Path) -> None:
    """Fly and draw in a folder, and keep the pictures."""
    for run in dict.fromkeys(run for picture in pictures for run in picture.flights):
        execute(FLIGHTS[run], folder)
    for picture in pictures:
        execute(picture.command, folder)
        with Image.open(folder / (picture.writes or f"{picture.name}.png")) as drawn:
            height = round(drawn.height * WIDTH / drawn.width)
            small = drawn.convert("RGB").resize((WIDTH, height), Image.Resampling.LANCZOS)
            small.save(kept(picture), quality=QUALITY)


def execute(command: str, folder: Path) -> None:
    """Run a command of edl6dof; a flight outside its limits is one that can be shown."""
    print(f"edl6dof {command}", flush=True)
    words = [sys.executable, "-c", "from edl6dof.cli import main; main()", *shlex.split(command)]
    done = subprocess.run(words, cwd=folder, stdout=subprocess.PIPE, text=True, check=False)
    if done.returncode > 1:
        raise SystemExit(f"edl6dof {command}: exit status {done.returncode}\n{done.stdout}")


def kept(picture: Picture) -> Path:
    """Where a picture is kept."""
    return DOCS / "gallery" / f"{picture.name}.webp"


def text(page: str, drawn: Sequence[str]) -> str:
    """The page; ``page``: as it was before the pictures named ``drawn`` were made."""
    parts = [
        "# Gallery\n",
        "Each picture shows a simulated flight, with the commands that made it. `python tools/gallery.py`",
    ]
    parts[-1] += " makes all of them again.\n"
    parts[-1] += "`edl6dof report RUN --png` writes the figures of a report"
    parts[-1] += " to the folder `report` in the run folder `RUN`.\n"
    for picture in PICTURES:
        commands = [*(FLIGHTS[run] for run in picture.flights), picture.command]
        lines = "\n".join(f"edl6dof {command}" for command in commands)
        outside = "".join(f"{OUTSIDE_LIMITS[run]}\n" for run in picture.flights if run in OUTSIDE_LIMITS)
        dated = remark(picture, page, picture.name in drawn)
        parts.append(
            f"## {picture.shows.rstrip('.')}\n\n{dated}![{picture.shows}](gallery/{picture.name}.webp)\n\n"
            f"{outside}```sh\n{lines}\n```\n"
        )
    return "\n".join(parts)


def main() -> None:
    """Make what the command line asks for."""
    parser = argparse.ArgumentParser(description="Make docs/gallery.md and its pictures.")
    parser.add_argument("--only", help="names of pictures, with commas")
    asked = parser.parse_args()
    names = asked.only.split(",") if asked.only else [picture.name for picture in PICTURES]
    if unknown := set(names) - {picture.name for picture in PICTURES}:
        raise SystemExit(f"no such picture: {', '.join(sorted(unknown))}")
    (DOCS / "gallery").mkdir(exist_ok=True)
    with TemporaryDirectory(prefix="edl6dof-") as folder:
        make(tuple(picture for picture in PICTURES if picture.name in names), Path(folder))
    page = DOCS / "gallery.md"
    page.write_text(text(page.read_text(encoding="utf-8"), names), encoding="utf-8")


if __name__ == "__main__":
    main()
