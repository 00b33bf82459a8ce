"""One picture of all missions: standard deviations from each counted flown value to its prediction."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from edl6dof.missions.comparison import WITHIN, Compared, Predicted
from edl6dof.report.figure import BLUE, PHASES, SKY, VERMILION, Axis, Band, Figure, Mark, Panel, Trace

#: Standard deviations at the edge of the picture; what lies beyond stands there, with its number.
EDGE = 10.0
#: Px of a row, one for each figure.
_ROW = 18.0


def drawing(missions: Sequence[Compared]) -> Figure:
    """A panel for each mission, its figures below each other in the order of its file."""
    drawn = [mission for mission in missions if _known(mission)]
    rows = [len(_known(mission)) for mission in drawn]
    mean = sum(rows) / max(len(rows), 1)
    panels = [_panel(mission, count / mean) for mission, count in zip(drawn, rows, strict=True)]
    return Figure(
        "validation",
        "Flown values and what dispersed flights predict",
        panels,
        share_x=True,
        height=int(_ROW * max(mean, 5.0)),
    )


def _known(mission: Compared) -> list[Predicted]:
    """Figures that have a place in the picture."""
    return [one for one in mission.counted if one.flights]


def _panel(mission: Compared, weight: float) -> Panel:
    figures = _known(mission)[::-1]
    kinds = (
        ("within three sigma", BLUE, "circle", lambda one: one.inside and not one.fitted),
        ("within, fitted", SKY, "square", lambda one: one.inside and one.fitted),
        ("outside", VERMILION, "diamond", lambda one: not one.inside),
    )
    traces = []
    for name, colour, symbol, belongs in kinds:
        here = [(k, one) for k, one in enumerate(figures) if belongs(one)]
        x = np.clip(np.array([one.sigmas for _, one in here]), -EDGE, EDGE)
        y = np.array([float(k) for k, _ in here])
        labels = [f"{one.sigmas:+.0f}" if abs(one.sigmas) > EDGE else "" for _, one in here]
        traces.append(Trace(x, y, name, kind="points", colour=colour, symbol=symbol, labels=labels))
    return Panel(
        Axis("predicted less flown, standard deviations", (-EDGE - 1.0, EDGE + 1.0)),
        Axis("", names=[one.figure.meaning for one in figures]),
        traces,
        bands=(Band(PHASES[2], x=(-WITHIN, WITHIN)),),
        marks=(Mark("x", 0.0),),
        title=mission.name,
        weight=weight,
    )
