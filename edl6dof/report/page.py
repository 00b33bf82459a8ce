"""A report as one HTML file that opens offline: ``page.html`` with its style, script, plotly.js and numbers.

All text is escaped where the template puts it in; only style, scripts and numbers are taken as they are.
plotly.js is compressed, which leaves room for curves to zoom into in a page that can still be mailed.  Its
figures are plain dicts, so that no plotly need be installed; :data:`TEMPLATE` holds what all of them share.
"""

from __future__ import annotations

import base64
import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from jinja2 import Environment, FileSystemLoader, StrictUndefined, Template
from markupsafe import Markup

from edl6dof.config.base import STATUS_MARKS
from edl6dof.report import palette
from edl6dof.report.document import Listing, Report, Table, as_cell
from edl6dof.report.figure import Axis, Figure, Heat, Panel, Trace, thinned
from edl6dof.report.label_layout import Side, sides, spelt
from edl6dof.report.palette import AXIS, GREY, INK, PAPER, RULE

_HERE = Path(__file__).parent
#: plotly.js for plots of two axes, compressed; its source is stated next to it.
PLOTLY = _HERE.parent / "data" / "plotly" / "plotly-cartesian.min.js.gz"
_NAMES = "ink soft rule axis paper ground good warn bad published recalled estimate"
#: Colours by their names in the style of the page.
COLOURS: dict[str, str] = {name: getattr(palette, name.upper()) for name in _NAMES.split()}
_MARK = re.compile(r"#\s*\[([" + "".join(STATUS_MARKS) + r"])\](.*)$")
FONT = "system-ui, -apple-system, 'Segoe UI', Roboto, 'DejaVu Sans', sans-serif"
#: Pixels around and between panels, and of the title of a panel.
TOP, BOTTOM, GAP_SHARED, GAP, TITLE = 34, 52, 26, 84, 22
#: Share of the width between columns.
COLUMN_GAP = 0.11
_AXIS = {
    "showline": True, "linecolor": GREY, "mirror": True, "ticks": "outside", "tickcolor": GREY,
    "showgrid": True, "gridcolor": RULE, "zerolinecolor": AXIS, "automargin": True, "exponentformat": "power",
    "minexponent": 6, "title": {"standoff": 6},
}  # fmt: skip
TEMPLATE: dict[str, Any] = {
    "layout": {
        "font": {"family": FONT, "size": 13, "color": INK},
        "paper_bgcolor": PAPER,
        "plot_bgcolor": PAPER,
        "hovermode": "closest",
        "hoverlabel": {"font": {"family": FONT, "size": 12}},
        "legend": {"orientation": "h", "x": 0, "xanchor": "left", "yanchor": "bottom",
                   "bgcolor": "rgba(0,0,0,0)", "font": {"size": 12}},
        "annotationdefaults": {"showarrow": False, "font": {"size": 11, "color": GREY}},
        "xaxis": _AXIS,
        "yaxis": _AXIS,
    }
}  # fmt: skip
_LEVELS = {"above": "top", "below": "bottom"}


def page(report: Report) -> str:
    """Return the whole page as HTML."""
    return _template().render(
        report=report,
        style=_verbatim(_HERE / "page.css"),
        script=_verbatim(_HERE / "page.js"),
        colours=COLOURS,
        plotly=base64.b64encode(PLOTLY.read_bytes()).decode("ascii"),
        template=TEMPLATE,
        drawings={one.key: drawing(one) for one in report.figures()},
        dark=palette.DARK,
    )


def drawing(shown: Figure) -> dict[str, Any]:
    """Return the plotly.js drawing, with a second layout for narrow windows if panels stand side by side."""
    drawn = plotly_figure(shown)
    if shown.columns > 1:
        drawn["narrow"] = plotly_layout(replace(shown, columns=1))
    return drawn


def _template() -> Template:
    environment = Environment(
        loader=FileSystemLoader(_HERE), autoescape=True, undefined=StrictUndefined, keep_trailing_newline=True
    )
    environment.filters.update(as_cell=as_cell, split_at_mark=_split_at_mark, first_of_words=_first_of_words)
    for name, kind in (("figure", Figure), ("table", Table), ("listing", Listing)):
        environment.tests[name] = lambda block, kind=kind: isinstance(block, kind)
    environment.policies["json.dumps_kwargs"] = {"separators": (",", ":")}
    return environment.get_template("page.html")


def _verbatim(path: Path) -> Markup:
    return Markup(path.read_text(encoding="utf-8").rstrip("\n"))


def _first_of_words(columns: Sequence[str]) -> int:
    """Index of the first column of text: in a narrow window it becomes the heading of a row's card."""
    return next((k for k, name in enumerate(columns) if not name.endswith(">")), 0)


def _split_at_mark(line: str) -> tuple[str, str, str]:
    """A line of YAML without its status mark, its letter and the words after it; both may be empty."""
    found = _MARK.search(line)
    return (line[: found.start()], found[1], found[2]) if found else (line, "", "")


def plotly_figure(figure: Figure) -> dict[str, Any]:
    """Return ``{"data": [...], "layout": {...}}`` for ``Plotly.newPlot``, without the template."""
    data: list[dict[str, Any]] = []
    named: set[str] = set()
    for index, panel in enumerate(figure.panels):
        number = _number(index)
        if panel.heat is not None:
            data.append(_heat(panel.heat, number))
        placed = sides(panel, figure.spans(index), *figure.size(index))
        for k, trace in enumerate(panel.coloured()):
            shown = trace.legend and bool(trace.name) and trace.name not in named
            named.add(trace.name)
            data.append(_trace(thinned(trace), number, shown, placed.get(k, [])))
    return {"data": data, "layout": plotly_layout(figure)}


def plotly_layout(figure: Figure) -> dict[str, Any]:
    """Return the layout; layouts of the figure with different ``columns`` fit the same data."""
    weights = [panel.weight for panel in figure.panels[:: figure.columns]]
    gap = GAP_SHARED if figure.share_x else GAP
    height = figure.height * sum(weights) + gap * (figure.rows - 1)
    title = TITLE if any(panel.title for panel in figure.panels) else 0  # the legend goes above them
    layout: dict[str, Any] = {
        "height": round(height + TOP + BOTTOM) + title,
        "margin": {"l": 68, "r": 20, "t": TOP + title, "b": BOTTOM},
        "legend": {"y": 1.0 + title / height},
        **{"showlegend": bool(figure.entries), "shapes": [], "annotations": []},
    }
    width = (1.0 - COLUMN_GAP * (figure.columns - 1)) / figure.columns
    for index, panel in enumerate(figure.panels):
        row, column = divmod(index, figure.columns)
        left, number, spans = column * (width + COLUMN_GAP), _number(index), figure.spans(index)
        top = 1.0 - (figure.height * sum(weights[:row]) + gap * row) / height
        xs = [left, min(left + width, 1.0)]
        ys = [max(top - figure.height * weights[row] / height, 0.0), top]
        titled = not figure.share_x or index + figure.columns >= len(figure.panels)
        x, y = _axis(panel.x, spans[0], titled), _axis(panel.y, spans[1])
        x |= {"domain": xs, "anchor": f"y{number}"}
        y |= {"domain": ys, "anchor": f"x{number}"}
        if figure.share_x and row:
            x["matches"] = f"x{_number(column)}"
        if panel.equal:
            y |= {"scaleanchor": f"x{number}", "scaleratio": 1}
        if panel.heat is not None:  # axes end with the map
            x["constrain"] = y["constrain"] = "domain"
        layout |= {f"xaxis{number}": x, f"yaxis{number}": y}
        layout["shapes"] += _shapes(panel, number, spans)
        layout["annotations"] += _words(panel, number, spans)
        if panel.heat is not None:
            layout[f"coloraxis{number}"] = _scale(panel.heat, xs, ys)
    return layout


def _number(index: int) -> str:
    """Suffix of the names of a panel's axes."""
    return str(index + 1) if index else ""


def _axis(axis: Axis, span: tuple[float, float], titled: bool = True) -> dict[str, Any]:
    title = axis.title.replace("\n", "<br>") if titled else ""
    ends = [float(np.log10(bound)) if axis.log else float(bound) for bound in span]
    found: dict[str, Any] = {"title": {"text": title}, "range": ends}
    if not titled:
        found["showticklabels"] = False
    texts: dict[float, str] = {}
    if axis.log:
        found["type"] = "log"
        texts = {value: _power(value) for value in axis.decades(span)}
    if axis.names:
        found["zeroline"] = False
        texts = {k: name.replace("\n", "<br>") for k, name in enumerate(axis.names)}
    if texts:
        found |= {"tickmode": "array", "tickvals": list(texts), "ticktext": list(texts.values())}
    return found


def _power(value: float) -> str:
    """A number of a logarithmic axis, as a power of ten if it is long."""
    if 1e-3 <= value < 1e5:
        return f"{value:,.10g}"
    exponent = int(np.floor(np.log10(value) + 1e-9))
    step = round(value / 10.0**exponent)
    return f"{step} x 10<sup>{exponent}</sup>" if step > 1 else f"10<sup>{exponent}</sup>"


def _shapes(panel: Panel, number: str, spans: Sequence[tuple[float, float]]) -> list[dict[str, Any]]:
    """Bands, below or above the data, and marks across the whole panel."""

    def along(axis: str, ends: tuple[float, float] | None) -> dict[str, Any]:
        """Ends along an axis; without ``ends`` those of the panel."""
        if ends is None:
            return {f"{axis}ref": f"{axis}{number} domain", f"{axis}0": 0, f"{axis}1": 1}
        return {f"{axis}ref": f"{axis}{number}", f"{axis}0": float(ends[0]), f"{axis}1": float(ends[1])}

    found: list[dict[str, Any]] = []
    for band in panel.bands:
        layer = "above" if band.opacity == 1.0 or panel.heat is not None else "below"
        look = {"type": "rect", "layer": layer, "fillcolor": band.colour, "opacity": band.opacity}
        line = {"width": 1.2, "color": band.colour} if band.outline else {"width": 0}
        ends = along("x", band.bounds("x", spans[0])) | along("y", band.bounds("y", spans[1]))
        found.append({**look, "line": line, **ends})
    for mark in panel.marks:
        line = {"color": mark.colour, "width": 1.1, "dash": mark.dash}
        other = "y" if mark.axis == "x" else "x"
        ends = along(mark.axis, (mark.at, mark.at)) | along(other, None)
        found.append({"type": "line", "layer": "below", "line": line, **ends})
    return found


def _words(panel: Panel, number: str, spans: Sequence[tuple[float, float]]) -> list[dict[str, Any]]:
    """Panel title, and the words of marks and bands."""

    def words(text: str, x: Any, y: Any, anchors: tuple[str, str], **more: Any) -> dict[str, Any]:
        """Put words at a place; a coordinate given as text is a share of the panel."""
        found = {"text": text, "xanchor": anchors[0], "yanchor": anchors[1], **more}
        for axis, at in (("x", x), ("y", y)):
            found[f"{axis}ref"] = f"{axis}{number}" + (" domain" if isinstance(at, str) else "")
            found[axis] = float(at)
        return found

    found = []
    if panel.title:
        font = {"size": 13, "color": INK}
        found.append(words(f"<b>{panel.title}</b>", "0.5", "1", ("center", "bottom"), font=font))
    for mark in (*spelt(panel.marks, "x", spans[0]), *spelt(panel.marks, "y", spans[1])):
        font = {"color": mark.colour}
        if mark.label and mark.axis == "x":
            upright = {"font": font, "textangle": -90}
            found.append(words(mark.label, mark.at, "0.98", ("right", "top"), **upright))
        elif mark.label:
            found.append(words(mark.label, "0.995", mark.at, ("right", "bottom"), font=font))
    for band in (band for band in panel.bands if band.label):
        found.append(words(band.label, _end(band.x), _end(band.y), ("right", "top")))
    return found


def _end(ends: tuple[float | None, float | None]) -> float | str:
    """The upper bound of a band, else the lower one, else the edge of the panel."""
    return next((bound for bound in reversed(ends) if bound is not None), "1")


def _trace(trace: Trace, number: str, shown: bool, placed: Sequence[Side]) -> dict[str, Any]:
    """One trace; ``shown``: in the legend; ``placed``: the side of each of its labels."""
    kind, axes = "bar" if trace.kind == "bars" else "scatter", _axes(number)
    found: dict[str, Any] = {"type": kind, "x": packed(trace.x), "y": packed(trace.y), **axes}
    found |= {"name": trace.name, "legendgroup": trace.name, "showlegend": shown}
    if not trace.name:
        found["hoverinfo"] = "x+y"
    if trace.kind == "bars":
        return found | {"marker": {"color": trace.colour}}
    if trace.kind == "points":
        size, edge = 4.0 + 2.5 * trace.width, {"color": PAPER, "width": 0.6}
        marker = {"color": trace.colour, "size": size, "symbol": trace.symbol, "line": edge}
        found |= {"mode": "markers", "marker": marker}
    else:
        line: dict[str, Any] = {"color": trace.colour, "width": trace.width, "dash": trace.dash}
        line |= {"simplify": False} | ({"shape": "hv"} if trace.kind == "steps" else {})
        unseen = {"size": 9, "opacity": 0}  # invisible marker: space between label and line
        found |= {"mode": "lines+markers" if trace.labels else "lines", "line": line, "marker": unseen}
    if trace.kind == "region":
        found |= {"fill": "toself", "fillcolor": f"{trace.colour}22", "hoverinfo": "skip"}
        found["line"]["width"] = 0
    if trace.labels:
        places = []
        for first, last in ((side.split()[0], side.split()[-1]) for side in placed):
            places.append(f"{_LEVELS.get(first, 'middle')} {'center' if last in _LEVELS else last}")
        found |= {"text": list(trace.labels), "textposition": places, "mode": f"{found['mode']}+text"}
        found["textfont"] = {"size": 11, "color": trace.colour}
    return found


def _axes(number: str) -> dict[str, str]:
    return {"xaxis": f"x{number}", "yaxis": f"y{number}"}


def _heat(heat: Heat, number: str) -> dict[str, Any]:
    rows, columns = heat.values.shape
    z = {"dtype": "f4", "bdata": _in_base64(heat.values), "shape": f"{rows}, {columns}"}
    found: dict[str, Any] = {"type": "heatmap", "x": packed(heat.x), "y": packed(heat.y), "z": z}
    found |= {**_axes(number), "coloraxis": f"coloraxis{number}", "showlegend": False}
    if heat.labels:
        found |= {"text": [list(row) for row in heat.labels], "hoverinfo": "text", "xgap": 0.5, "ygap": 0.5}
    return found


def _scale(heat: Heat, across: list[float], up: list[float]) -> dict[str, Any]:
    """Colour scale of a field of cells, and its colour bar at the right of the panel."""
    bar = {
        "title": {"text": heat.title, "side": "right"}, "thickness": 12, "xanchor": "left",
        "x": across[1] + 0.01, "y": sum(up) / 2, "len": up[1] - up[0],
    }  # fmt: skip
    scale, (low, high) = [list(step) for step in heat.scale], heat.limits
    return {"cmin": low, "cmax": high, "colorscale": scale, "showscale": not heat.kinds, "colorbar": bar}


def packed(values: Any) -> dict[str, str] | list[Any]:
    """Return numbers as plotly's packed array in single precision; a short list as it is."""
    array = np.asarray(values, float)
    if len(array) < 8:
        return [None if not np.isfinite(value) else float(value) for value in array]
    return {"dtype": "f4", "bdata": _in_base64(array)}


def _in_base64(values: np.ndarray) -> str:
    with np.errstate(over="ignore"):  # numbers of a flight that diverged become infinite, and are not drawn
        return base64.b64encode(np.asarray(values, "<f4").tobytes()).decode()
