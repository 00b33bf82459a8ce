"""The trajectories of a campaign as one layer that stands still, in the colours of how they ended."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    import rerun as rr

SUCCESS = (110, 205, 130)
#: Colours of the causes of failure, the commonest first; those beyond share the last.
CAUSES = ((240, 80, 80), (250, 170, 60), (200, 120, 245), (90, 170, 250), (240, 225, 90), (150, 150, 155))
COLOURS = ("green", "red", "orange", "violet", "blue", "yellow", "grey")


class Trajectory(NamedTuple):
    """Where one case flew: places (n, 3) in L, m; and why it failed, empty when it did not."""

    places: np.ndarray
    cause: str


class Ensemble(NamedTuple):
    """The trajectories of a campaign's cases; and which flight among them the camera follows, and why."""

    trajectories: Sequence[Trajectory]
    followed: str


def write_ensemble(recording: rr.RecordingStream, ensemble: Ensemble) -> None:
    """Write ``/site/campaign``: one entity for the successes and one for each cause, and as text the counts
    and whom the camera follows.
    """
    import rerun as rr

    trajectories = ensemble.trajectories
    found = [one.cause for one in trajectories]
    causes = sorted(set(found) - {""}, key=lambda cause: (-found.count(cause), cause))
    lines = [
        f"## {found.count('')} of {len(found)} succeed\n",
        f"Followed here, in white: {ensemble.followed}\n",
        "| cases | colour | outcome |",
        "|--:|:--|:--|",
    ]
    for k, cause in enumerate(["", *causes]):
        colour = SUCCESS if not cause else CAUSES[min(k - 1, len(CAUSES) - 1)]
        strips = [
            one.places[np.isfinite(one.places).all(axis=-1)] for one in trajectories if one.cause == cause
        ]
        entity = f"site/campaign/{'success' if not cause else f'failure_{k}'}"
        recording.log(
            entity, rr.LineStrips3D(strips, colors=colour, radii=rr.Radius.ui_points(0.8)), static=True
        )
        lines.append(f"| {len(strips)} | {COLOURS[min(k, len(CAUSES))]} | {cause or 'success'} |")
    recording.log("campaign", rr.TextDocument("\n".join(lines), media_type="text/markdown"), static=True)
