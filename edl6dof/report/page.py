"""A report as one HTML file that opens offline: the words as HTML, the figures as plotly, plotly.js itself
inlined once.

A content security policy forbids the page any connection; nothing in it comes from anywhere else.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from html import escape
from importlib import resources
from importlib.util import find_spec
from pathlib import Path

from edl6dof.config.base import STATUS_MARKS
from edl6dof.report.document import Block, Cell, Listing, Report, Section, Table, Text
from edl6dof.report.drawing import drawing
from edl6dof.report.figure import Figure

_POLICY = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:"
_MARK = re.compile(r"#\s*\[([" + "".join(STATUS_MARKS) + r"])\](.*)$")


def page(report: Report) -> str:
    """The whole page."""
    own = resources.files("edl6dof.report")
    style, script = ((own / name).read_text(encoding="utf-8") for name in ("page.css", "page.js"))
    return "".join(
        [
            "<!DOCTYPE html>\n<html lang='en'>\n<head>\n<meta charset='utf-8'>\n",
            f'<meta http-equiv="Content-Security-Policy" content="{_POLICY}">\n',
            "<meta name='viewport' content='width=device-width, initial-scale=1'>\n",
            f"<title>{escape(report.title)}</title>\n<style>\n{style}</style>\n</head>\n<body>\n",
            _head(report),
            "<div class='columns'>",
            _contents(report),
            "<main>\n",
            *(_section(section) for section in report.sections),
            f"<footer>{escape(report.footer)}</footer>\n</main></div>\n",
            f"<script type='application/json' id='figure-data'>{_drawings(report)}</script>\n",
            f"<script>{plotly_js()}</script>\n<script>\n{script}</script>\n</body>\n</html>\n",
        ]
    )


def plotly_js() -> str:
    """The plotly.js of the installed plotly, read without importing plotly."""
    found = find_spec("plotly")
    if found is None or found.origin is None:
        raise ModuleNotFoundError("plotly is not installed; pip install plotly")
    return (Path(found.origin).parent / "package_data" / "plotly.min.js").read_text(encoding="utf-8")


def _drawings(report: Report) -> str:
    """Figures by key as JSON, without ``<``, which could end the script element."""
    return json.dumps(
        {figure.key: drawing(figure) for figure in report.figures()}, separators=(",", ":")
    ).replace("<", "\\u003c")


def _head(report: Report) -> str:
    facts = "".join(
        f"<div class='fact {f.mood}'><b>{escape(f.value)}</b><span>{escape(f.label)}</span></div>"
        for f in report.facts
    )
    subtitle = f"<p class='subtitle'>{escape(report.subtitle)}</p>" if report.subtitle else ""
    return (
        f"<header><h1>{escape(report.title)}</h1>{subtitle}"
        f"<p class='verdict {report.mood}'>{escape(report.verdict)}</p><div class='facts'>{facts}</div></header>\n"
    )


def _contents(report: Report) -> str:
    links = "".join(
        f"<li><a href='#{section.key}'>{escape(section.title)}</a></li>" for section in report.sections
    )
    return f"<nav aria-label='Contents'><ol>{links}</ol></nav>\n"


def _section(section: Section) -> str:
    return (
        "<section "
        f"id='{section.key}'><h2>{escape(section.title)}</h2>\n{''.join(map(_block, section.blocks))}</section>\n"
    )


def _block(block: Block) -> str:
    if isinstance(block, Figure):
        caption = f"<figcaption>{escape(block.caption)}</figcaption>" if block.caption else ""
        return (
            f"<figure id='{block.key}'><h3>{escape(block.title)}</h3><div class='plot' "
            f"data-figure='{block.key}'></div>{caption}</figure>\n"
        )
    if isinstance(block, Table):
        return _table(block)
    if isinstance(block, Listing):
        note = f" <small>{escape(block.note)}</small>" if block.note else ""
        lines = "\n".join(_line(line) for line in block.text.splitlines())
        return f"<details><summary>{escape(block.title)}{note}</summary><pre>{lines}</pre></details>\n"
    assert isinstance(block, Text)
    return f"<p>{escape(block.words)}</p>\n"


def _table(table: Table) -> str:
    numeric = [column.endswith(">") for column in table.columns]
    heads = "".join(
        f"<th{' class=num' if n else ''}>{escape(c.rstrip('>'))}</th>"
        for c, n in zip(table.columns, numeric, strict=True)
    )
    rows = "".join("<tr>" + "".join(_cells(row, numeric)) + "</tr>\n" for row in table.rows)
    caption = f"<caption>{escape(table.caption)}</caption>" if table.caption else ""
    return (
        "<div "
        f"class='table'><table>{caption}<thead><tr>{heads}</tr></thead><tbody>\n{rows}</tbody></table></div>\n"
    )


def _cells(row: tuple[str | Cell, ...], numeric: list[bool]) -> Iterator[str]:
    for item, is_number in zip(row, numeric, strict=True):
        cell = item if isinstance(item, Cell) else Cell(item)
        classes = " ".join(
            filter(None, ["num" if is_number else "", cell.mood if cell.mood != "plain" else ""])
        )
        bar = (
            ""
            if cell.bar is None
            else (f"<i class='bar'><i style='width:{100.0 * min(max(cell.bar, 0.0), 1.0):.1f}%'></i></i>")
        )
        yield f"<td{f' class={classes!r}' if classes else ''}>{escape(cell.text)}{bar}</td>"


def _line(line: str) -> str:
    """A line of YAML with its status mark coloured."""
    found = _MARK.search(line)
    if found is None:
        return escape(line)
    letter, words = found.groups()
    return f"{escape(line[: found.start()])}<span class='mark {letter}'>[{letter}]{escape(words)}</span>"
