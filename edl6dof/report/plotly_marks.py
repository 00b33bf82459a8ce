"""What stands in a panel beside its data, as plotly.js reads it: bands, marks, and their words."""

from __future__ import annotations

from typing import Any

from edl6dof.report.beside import spelt
from edl6dof.report.figure import GREY, Band, Mark, Panel


def band_of(band: Band, number: str, spans: dict[str, tuple[float, float]], above: bool) -> dict[str, Any]:
    """A stretch of the ground, below or above the data; ``spans``: of the panel's axes."""
    line = {"width": 1.2, "color": band.colour} if band.outline else {"width": 0}
    shape = {
        "type": "rect",
        "layer": "above" if above else "below",
        "fillcolor": band.colour,
        "opacity": band.opacity,
        "line": line,
    }
    return {
        **shape,
        **_place("x", number, band.bounds("x", spans["x"])),
        **_place("y", number, band.bounds("y", spans["y"])),
    }


def mark_of(mark: Mark, number: str) -> dict[str, Any]:
    """A line across the whole panel."""
    other = "y" if mark.axis == "x" else "x"
    line = {"color": mark.colour, "width": 1.1, "dash": mark.dash}
    here, across = _place(mark.axis, number, (mark.at, mark.at)), _place(other, number, None)
    return {"type": "line", "layer": "below", "line": line, **here, **across}


def _place(axis: str, number: str, bounds: tuple[float, float] | None) -> dict[str, Any]:
    """Reference and ends of a shape along one axis; without bounds from edge to edge of the panel."""
    if bounds is None:
        return {f"{axis}ref": f"{axis}{number} domain", f"{axis}0": 0, f"{axis}1": 1}
    return {f"{axis}ref": f"{axis}{number}", f"{axis}0": float(bounds[0]), f"{axis}1": float(bounds[1])}


def words_of(panel: Panel, number: str, spans: dict[str, tuple[float, float]]) -> list[dict[str, Any]]:
    """Panel title, and the words of marks and bands."""
    plain = {"showarrow": False, "font": {"size": 11, "color": GREY}}
    found = []
    if panel.title:
        place = {
            "xref": f"x{number} domain",
            "yref": f"y{number} domain",
            "x": 0.5,
            "y": 1,
            "xanchor": "center",
            "yanchor": "bottom",
        }
        found.append({"text": f"<b>{panel.title}</b>", "showarrow": False, "font": {"size": 13}, **place})
    spoken = [*spelt(panel.marks, "x", spans["x"]), *spelt(panel.marks, "y", spans["y"])]
    for mark in (mark for mark in spoken if mark.label):
        font = {"size": 11, "color": mark.colour}
        if mark.axis == "x":
            place = {
                "xref": f"x{number}",
                "yref": f"y{number} domain",
                "x": mark.at,
                "y": 0.98,
                "xanchor": "right",
                "yanchor": "top",
            }
            found.append({**plain, **place, "font": font, "text": mark.label, "textangle": -90})
        else:
            place = {
                "xref": f"x{number} domain",
                "yref": f"y{number}",
                "x": 0.995,
                "y": mark.at,
                "xanchor": "right",
                "yanchor": "bottom",
            }
            found.append({**plain, **place, "font": font, "text": mark.label})
    for band in (band for band in panel.bands if band.label):
        x, y = (
            next((bound for bound in reversed(ends) if bound is not None), None) for ends in (band.x, band.y)
        )
        place = {
            "xref": f"x{number}" + (" domain" if x is None else ""),
            "yref": f"y{number}" + (" domain" if y is None else ""),
        }
        found.append(
            {
                **plain,
                **place,
                "x": 1 if x is None else x,
                "y": 1 if y is None else y,
                "xanchor": "right",
                "yanchor": "top",
                "text": band.label,
            }
        )
    return found
