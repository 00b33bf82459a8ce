"""A report as one HTML file that opens offline: ``page.html`` with its style, script, plotly.js and numbers.

plotly.js is compressed, which leaves room for curves to zoom into in a page that can still be mailed.

All text is escaped where the template puts it in; only style, scripts and numbers are taken as they are.
"""

from __future__ import annotations

import base64
import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from edl6dof.config.base import STATUS_MARKS
from edl6dof.report import palette
from edl6dof.report.document import Listing, Report, Table, as_cell
from edl6dof.report.figure import Figure
from edl6dof.report.plotly_figure import TEMPLATE, plotly_figure, plotly_layout

_HERE = Path(__file__).parent
#: plotly.js for plots of two axes, compressed; its source is stated next to it.
PLOTLY = _HERE.parent / "data" / "plotly" / "plotly-cartesian.min.js.gz"
#: Colours by their names in the style of the page.
COLOURS: dict[str, str] = {
    name: getattr(palette, name.upper())
    for name in (
        *("ink", "soft", "rule", "axis", "paper", "ground"),
        *("good", "warn", "bad", "published", "recalled", "estimate"),
    )
}
_MARK = re.compile(r"#\s*\[([" + "".join(STATUS_MARKS) + r"])\](.*)$")


def page(report: Report) -> str:
    """Return the whole page."""
    return (
        _environment()
        .get_template("page.html")
        .render(
            report=report,
            style=_verbatim(_HERE / "page.css"),
            script=_verbatim(_HERE / "page.js"),
            colours=COLOURS,
            plotly=base64.b64encode(PLOTLY.read_bytes()).decode("ascii"),
            template=TEMPLATE,
            drawings={one.key: drawing(one) for one in report.figures()},
            dark=palette.DARK,
        )
    )


def drawing(shown: Figure) -> dict[str, Any]:
    """Return the plotly.js drawing, with a second layout for narrow windows if panels stand side by side."""
    drawn = plotly_figure(shown)
    if shown.columns > 1:
        drawn["narrow"] = plotly_layout(replace(shown, columns=1))
    return drawn


def _environment() -> Environment:
    environment = Environment(
        loader=FileSystemLoader(_HERE), autoescape=True, undefined=StrictUndefined, keep_trailing_newline=True
    )
    environment.filters.update(as_cell=as_cell, split_at_mark=_split_at_mark, first_of_words=_first_of_words)
    for name, kind in (("figure", Figure), ("table", Table), ("listing", Listing)):
        environment.tests[name] = lambda block, kind=kind: isinstance(block, kind)
    environment.policies["json.dumps_kwargs"] = {"separators": (",", ":")}
    return environment


def _verbatim(path: Path) -> Markup:
    return Markup(path.read_text(encoding="utf-8").rstrip("\n"))


def _first_of_words(columns: Sequence[str]) -> int:
    """The first column of words: in a narrow window it heads the card of a row."""
    return next((k for k, name in enumerate(columns) if not name.endswith(">")), 0)


def _split_at_mark(line: str) -> tuple[str, str, str]:
    """A line of YAML, the letter of its status mark, and the words after it; empty without one."""
    found = _MARK.search(line)
    return (line[: found.start()], found[1], found[2]) if found else (line, "", "")
