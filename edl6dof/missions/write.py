"""The table of missions, the same on the terminal, in the documents and in files, and the folder of a
validation: the table as Markdown, CSV and JSON, the predictions without the flown values, every flight as
Parquet, a picture of the table, and one of each flown trajectory over the dispersed flights.
"""

from __future__ import annotations

import csv
import io
from collections import Counter
from collections.abc import Mapping, Sequence
from math import floor, isfinite, isinf, log10, sqrt
from pathlib import Path
from typing import Any, get_args

import numpy as np
import pyarrow.parquet as pq

from edl6dof import __version__
from edl6dof.campaign.executor import Row, table_of
from edl6dof.config.base import STATUS_MARKS
from edl6dof.config.dump import json_text
from edl6dof.config.wording import counted
from edl6dof.metrics.published import COUNTED, Evidence
from edl6dof.missions.agreement import DECIDES, LEVELS, covariances, coverage, is_calibrated
from edl6dof.missions.bands import bands_drawing, in_bands
from edl6dof.missions.mission import RECALLED, WITHIN, Compared, Predicted, percentiles
from edl6dof.report.document import significant
from edl6dof.report.figure import Axis, Band, Figure, Mark, Panel, Trace
from edl6dof.report.matplotlib_figure import write_figure
from edl6dof.report.palette import BLUE, PHASES, SKY, VERMILION

HEADS = ("figure", "predicted>", "flown>", "reconstructed>", "planned>", "", "sigma>", "percentile>", "")
_LETTERS = {status: letter for letter, status in STATUS_MARKS.items()}
#: Remarks in the last column: beyond three sigma; no prediction, as the scenario was calibrated on it.
OUTSIDE, FITTED = "outside", "fitted"


def cells(one: Predicted) -> tuple[str, ...]:
    """A row of the table under :data:`HEADS`."""
    return (
        one.figure.meaning + (f" ({one.figure.unit.label})" if one.figure.unit.label else ""),
        predicted(one),
        *_in_column(one),
        f"[{_LETTERS[one.status]}]" if one.status in _LETTERS else "",
        sigmas(one),
        f"{100.0 * one.share:.0f}" if one.counted and one.flights else "",
        remark(one),
    )


def _in_column(one: Predicted) -> list[str]:
    """The published value in its column: flown, reconstructed or planned."""
    column = {"reconstructed": 1, "planned": 2}.get(one.published.evidence, 0)
    return [published(one) if k == column else "" for k in range(3)]


def predicted(one: Predicted) -> str:
    """Mean and standard deviation, with the decimals that show two digits of the latter."""
    if not one.flights:
        return "not reached"
    if not one.deviation > 0.0:
        return f"{significant(one.mean)} +- 0"
    places = max(1 - floor(log10(one.deviation)), 0)
    return f"{one.mean:.{places}f} +- {one.deviation:.{places}f}"


def published(one: Predicted) -> str:
    """The published value with its uncertainty."""
    known = "" if one.published.sigma is None else f" +- {one.published.sigma:g}"
    return f"{one.published.bound} {one.published.number:.10g}{known}".strip()


def sigmas(one: Predicted) -> str:
    """The difference in standard deviations; empty for a requirement or a planned value."""
    if one.published.required or one.published.planned or not one.flights:
        return ""
    return ("-inf" if one.sigmas < 0.0 else "+inf") if isinf(one.sigmas) else f"{one.sigmas:+.1f}"


def remark(one: Predicted) -> str:
    """Say whether the flown value lies within three sigma, or why it does not count; for a requirement the
    share that meets it.
    """
    if one.published.required:
        return f"{100.0 * one.share:.3g} % meet" if isfinite(one.share) else "not reached"
    verdict = ("" if one.inside else OUTSIDE) if one.counted else one.evidence
    return ", ".join(filter(None, (verdict, FITTED if one.fitted else "")))


def heading(mission: Compared) -> tuple[str, ...]:
    """Heading row of a mission in the table: numbers of flights and of flown values in the central 68 %."""
    share = coverage(percentiles([mission], fitted=True), DECIDES)
    return mission.name, counted(mission.flights, "flight"), *[""] * 6, f"{share.successes} of {share.trials}"


def distances(missions: Sequence[Compared]) -> list[str]:
    """Mahalanobis distance of each mission."""
    return [
        f"{mission.name}: Mahalanobis distance {sqrt(one.squared):.1f} for {counted(one.values, 'value')}, "
        f"not fitted; probability of a larger one {_percent(one.farther)}"
        for mission in missions
        if (one := mission.distance)
    ]


def _percent(share: float) -> str:
    return f"{100.0 * share:.2g} %" if share >= 1e-4 else "below 0.01 %"


def failures(mission: Compared) -> list[str]:
    """Causes of flights that did not end within limits, and their numbers."""
    return [
        f"{mission.name}: {counted(number, 'flight')}: {cause}" for cause, number in mission.causes.items()
    ]


def causes(mission: Compared) -> list[str]:
    """Every flown value that counts and lies beyond three sigma, with its cause."""
    return [
        f"{mission.name}, {one.figure.meaning}: {one.published.because or 'no cause is known'}"
        for one in mission.counted
        if not one.inside
    ]


def outcome(missions: Sequence[Compared]) -> str:
    """Return the result of all missions in one line."""
    every = [one for mission in missions for one in mission.predicted]
    own, all_of_them = percentiles(missions), percentiles(missions, fitted=True)
    if not all_of_them:
        return "no flown value counts" + _not_counted(every)
    words = f"{counted(len(own), 'flown value')} not fitted: {_coverages(own)}"
    if len(own) < len(all_of_them):
        words += f"; with fitted values ({len(all_of_them)}): {_coverages(all_of_them)}"
    words += f"; {sum(one.inside for one in every if one.counted)} within {WITHIN:g} sigma"
    return words + _not_counted(every)


def _coverages(places: Sequence[float]) -> str:
    """Shares of flown values in the central intervals, with 95 % confidence intervals."""
    found = []
    for level in LEVELS:
        share = coverage(places, level)
        value, low, high = (100.0 * x for x in (share.value, *share.interval))
        found.append(f"{value:.0f} % ({low:.0f} to {high:.0f}) in the central {100.0 * level:.0f} %")
    return ", ".join(found)


def _not_counted(predicted: Sequence[Predicted]) -> str:
    """Return the numbers of values that are not counted, by reason; empty if there are none."""
    found = Counter(one.evidence for one in predicted if not one.published.required)
    words = ", ".join(
        f"{found[kind]} {kind}"
        for kind in (*get_args(Evidence), RECALLED)
        if kind not in COUNTED and found[kind]
    )
    return f"; not counted: {words}" if words else ""


#: Standard deviations at the edge of the picture; larger ones are drawn there, with their number.
EDGE = 10.0
#: Px of a row, one for each figure.
_ROW = 18.0


def write_validation(missions: Sequence[Compared], rows: Mapping[str, Sequence[Row]], folder: Path) -> None:
    """Write every file into the existing ``folder``; ``rows`` are the flights of each mission by its name."""
    (folder / "prediction.json").write_text(prediction(missions), encoding="utf-8")
    (folder / "validation.md").write_text(to_markdown(missions), encoding="utf-8")
    (folder / "validation.csv").write_text(to_csv(missions), encoding="utf-8")
    (folder / "validation.json").write_text(to_json(missions), encoding="utf-8")
    for name, flown in rows.items():
        pq.write_table(table_of(flown), folder / f"{name}.parquet", compression="zstd")
    write_figure(drawing(missions), folder / "validation.png")
    for mission in missions:
        if mission.bands:
            write_figure(bands_drawing(mission.name, mission.bands), folder / f"{mission.name}_flown.png")


def prediction(missions: Sequence[Compared]) -> str:
    """Mean, standard deviation and covariance of the figures over the flights: no published value enters.

    A covariance is that of the flights that reached both figures.
    """
    found = [
        {
            "mission": mission.name,
            "figures": [
                {"figure": one.figure.name, "unit": one.figure.unit.label, "flights": one.flights}
                | {"mean": one.mean, "deviation": one.deviation}
                for one in mission.predicted
            ],
            "covariance": covariances(mission.values).tolist(),
        }
        for mission in missions
    ]
    return json_text({"edl6dof_version": __version__, "missions": found})


def to_markdown(missions: Sequence[Compared]) -> str:
    """One table of all missions, and below it distances, and values beyond three sigma with causes."""
    lines = [
        "| " + " | ".join(head.rstrip(">") for head in HEADS) + " |",
        "|" + "|".join("---:" if head.endswith(">") else "---" for head in HEADS) + "|",
    ]
    for mission in missions:
        lines.append("| " + " | ".join(f"**{words}**" if words else "" for words in heading(mission)) + " |")
        for one in mission.predicted:
            lines.append("| " + " | ".join(cells(one)).replace("+-", "±") + " |")
    lines += ["", f"{outcome(missions)}.", "", *(f"- {words}" for words in distances(missions)), ""]
    if curves := [words for mission in missions for words in in_bands(mission.name, mission.bands)]:
        lines += [*(f"- {words}" for words in curves), ""]
    for mission in missions:
        lines += [f"- {words}" for words in (*causes(mission), *failures(mission))]
    return "\n".join(lines) + "\n"


def to_csv(missions: Sequence[Compared]) -> str:
    """A row for each published figure of each mission."""
    rows = [{"mission": mission.name, **_plain(one)} for mission in missions for one in mission.predicted]
    text = io.StringIO()
    table = csv.DictWriter(text, rows[0], lineterminator="\n")
    table.writeheader()
    table.writerows(rows)
    return text.getvalue()


def to_json(missions: Sequence[Compared]) -> str:
    """The table with the outcome of each mission's flights; a figure without a value is null."""
    places = percentiles(missions)
    found = {
        "edl6dof_version": __version__,
        "flown_values": len(places),
        "central_intervals": [_interval(places, level) for level in LEVELS],
        "calibrated": is_calibrated(places),
        "missions": [
            {
                "mission": mission.name,
                "flights": mission.flights,
                "within_limits": mission.successes,
                "causes": mission.causes,
                "mahalanobis": mission.distance._asdict() if mission.distance else None,
                "figures": [_plain(one) for one in mission.predicted],
                "trajectory": [band.shares for band in mission.bands],
            }
            for mission in missions
        ],
    }
    return json_text(found)


def _interval(places: Sequence[float], level: float) -> dict[str, float]:
    found = coverage(places, level)
    low, high = found.interval
    return {"level": level, "inside": found.successes, "low": low, "high": high}


def _plain(one: Predicted) -> dict[str, Any]:
    published = one.published
    kinds = ("value", "magnitude", "at_most", "at_least")
    return {
        "figure": one.figure.name,
        "unit": one.figure.unit.label,
        "mean": one.mean,
        "deviation": one.deviation,
        "flights": one.flights,
        "published": published.number,
        "kind": next(kind for kind in kinds if getattr(published, kind) is not None),
        "published_sigma": published.sigma,
        "status": one.status,
        "evidence": None if published.required else one.evidence,
        "calibrated_on": one.fitted,
        "sigmas": None if published.required or published.planned else one.sigmas,
        "share": one.share,
        "crps": one.score,
        "inside": one.inside if one.counted else None,
        "because": published.because or "",
    }


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
    """Figures that are drawn."""
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
