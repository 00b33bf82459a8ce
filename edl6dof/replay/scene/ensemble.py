"""The cases of a campaign: their trajectories, the landing footprint, and the worst cases."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import log, sqrt
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from edl6dof.campaign.statistics import ellipse
from edl6dof.replay.scene.landscape import Landscape
from edl6dof.replay.scene.mesh import RGB
from edl6dof.report.palette import GREEN, GREY, ORANGE, PURPLE, SKY, VERMILION, rgb

if TYPE_CHECKING:
    import rerun as rr

#: Colours of success and of the causes of failure, the commonest first; causes beyond share the last colour.
OUTCOMES = {
    "light blue": rgb(SKY),
    "vermilion": rgb(VERMILION),
    "pink": rgb(PURPLE),
    "green": rgb(GREEN),
    "orange": rgb(ORANGE),
    "grey": rgb(GREY),
}
#: Okabe and Ito's yellow, in which the worst cases are drawn; and the colour of the ellipse.
WORST, ELLIPSE = (240, 228, 66), (255, 255, 255)
#: Share of a normal cloud of landing points inside the ellipse, and the height (m) of what is drawn above the
#: ground.
SHARE, ABOVE_M = 0.99, 100.0


class Trajectory(NamedTuple):
    """Number of a case, its path (m in L, shape (n, 3)), the cause of its failure, empty for a success, and
    True if it has landed.
    """

    case: int
    places: np.ndarray
    cause: str
    landed: bool


class Worst(NamedTuple):
    """The case with the worst value of a figure that has a limit; both as text; used share of the limit."""

    case: int
    figure: str
    value: str
    limit: str
    used: float


class Ensemble(NamedTuple):
    """The trajectories of a campaign, its worst cases, and a text on the flight that the camera follows."""

    trajectories: Sequence[Trajectory]
    worst: Sequence[Worst]
    followed: str

    @property
    def landings(self) -> np.ndarray:
        """Landing points, m in L, shape (n, 3)."""
        return np.array([one.places[-1] for one in self.trajectories if one.landed]).reshape(-1, 3)

    @property
    def marked(self) -> list[Trajectory]:
        """Trajectories of the worst cases."""
        worst = {one.case for one in self.worst}
        return [one for one in self.trajectories if one.case in worst]


def write_ensemble(recording: rr.RecordingStream, ensemble: Ensemble, ground: Landscape) -> None:
    """Write ``/site/campaign`` (paths and landing points by outcome, worst cases, ellipse), the names of the
    worst cases as ``/site/labels/worst``, and the legend, ``/campaign``.
    """
    import rerun as rr

    def write(entity: str, drawn: rr.AsComponents) -> None:
        recording.log(f"site/{entity}", drawn, static=True)

    def landings(cases: Sequence[Trajectory], colour: RGB, points: float, named: bool) -> rr.Points3D:
        names, places = _names(cases), [ground.above(one.places[-1, :2], ABOVE_M) for one in cases]
        return rr.Points3D(places, colors=colour, radii=-points, labels=names, show_labels=named)

    found = [one.cause for one in ensemble.trajectories]
    causes = ["", *sorted(set(found) - {""}, key=lambda cause: (-found.count(cause), cause))]
    for k, cause in enumerate(causes):
        cases = [one for one in ensemble.trajectories if one.cause == cause]
        name, colour = f"failure_{k}" if cause else "success", _colour(k)[1]
        write(f"campaign/paths/{name}", _lines(cases, colour, 0.8))
        landed = [one for one in cases if one.landed]
        write(f"campaign/footprint/{name}", landings(landed, colour, 3.0, named=False))
    east, north, _ = ensemble.landings.T
    if len(east) > 2:
        curve = np.column_stack(ellipse(east, north, sqrt(-2.0 * log(1.0 - SHARE))))
        line = rr.LineStrips3D([ground.above(curve, ABOVE_M)], colors=ELLIPSE, radii=-1.2)
        write("campaign/footprint/ellipse", line)
    for one in ensemble.marked:
        write(f"campaign/paths/worst/case_{one.case}", _lines([one], WORST, 1.8))
        if one.landed:
            write(f"labels/worst/case_{one.case}", landings([one], WORST, 5.0, named=True))
    text = "\n".join(_legend(ensemble, causes))
    recording.log("campaign", rr.TextDocument(text, media_type="text/markdown"), static=True)


def _lines(cases: Sequence[Trajectory], colour: RGB, points: float) -> rr.LineStrips3D:
    """Trajectories in a colour; the viewer shows the number of the case that is pointed at."""
    import rerun as rr

    strips = [one.places[np.isfinite(one.places).all(axis=-1)] for one in cases]
    return rr.LineStrips3D(strips, colors=colour, radii=-points, labels=_names(cases), show_labels=False)


def _names(cases: Sequence[Trajectory]) -> list[str]:
    return [f"case {one.case}" for one in cases]


def _colour(outcome: int) -> tuple[str, RGB]:
    """Name and colour of an outcome; 0: success."""
    return [*OUTCOMES.items()][min(outcome, len(OUTCOMES) - 1)]


def _legend(ensemble: Ensemble, causes: Sequence[str]) -> Iterator[str]:
    """Lines (Markdown) on the outcomes, the footprint and the worst cases."""
    found = [one.cause for one in ensemble.trajectories]
    yield f"## {found.count('')} of {len(found)} succeed\n"
    yield f"Followed, in white: {ensemble.followed}\n"
    yield "| cases | colour | outcome |\n|--:|:--|:--|"
    for k, cause in enumerate(causes):
        yield f"| {found.count(cause)} | {_colour(k)[0]} | {cause or 'success'} |"
    yield f"\n{len(ensemble.landings)} landing points, in the colours of their outcomes. The white ellipse"
    yield f"contains {SHARE:.0%} of a normal distribution with their mean and covariance.\n"
    if ensemble.worst:
        yield "In yellow, the cases nearest to a limit or beyond it (`--case K` follows case K):\n"
        yield "| case | used | value | limit | figure |\n|--:|--:|--:|--:|:--|"
    for one in ensemble.worst:
        yield f"| {one.case} | {one.used:.0%} | {one.value} | {one.limit} | {one.figure} |"
