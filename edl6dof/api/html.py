"""A flight in a notebook: outcome, a small figure, timeline and limits."""

from __future__ import annotations

import base64
import math
from collections.abc import Iterable, Sequence
from html import escape
from typing import TYPE_CHECKING

from edl6dof.report.terminal import LIMIT_STATUS, aligned_pair

if TYPE_CHECKING:
    from edl6dof.api.results import FlightResults

#: What the small figure shows.
SHOWN = ("truth.height_m", "truth.mach")
_GOOD, _BAD = "#1a7f37", "#b42318"


def flight_html(flight: FlightResults) -> str:
    """The flight as a piece of HTML that needs nothing else."""
    colour = _GOOD if flight.success else _BAD
    head = (
        f'<p><b>{escape(flight.name)}</b>: <span style="color:{colour}">{escape(flight.outcome)}</span> '
        f"at t = {flight.time_s:.1f} s</p>"
    )
    timeline = table(
        ("t (s)", "event", "height (m)", "speed (m/s)", "Mach"),
        (
            (
                f"{event['t_s']:.2f}",
                str(event["name"]),
                number(event["height_m"], ",.0f"),
                number(event["speed_m_s"], ",.1f"),
                number(event["mach"], ".2f"),
            )
            for event in flight.events
        ),
    )
    limits = table(
        ("limit", "unit", "this flight", "allowed", ""),
        (
            (
                check.label,
                check.unit,
                *aligned_pair(check.value, check.limit, check.ok),
                LIMIT_STATUS[check.ok],
            )
            for check in flight.checks
        ),
    )
    return f"<div>{head}{_figure(flight)}<div>{timeline}</div><div>{limits}</div></div>"


def _figure(flight: FlightResults) -> str:
    """Height and Mach number over time; nothing where the telemetry is brief or gone."""
    channels = [name for name in SHOWN if name in flight.telemetry]
    if len(channels) < len(SHOWN) or len(flight.telemetry["t_s"]) < 2:
        return ""
    picture = flight.plot(*channels)._repr_png_()
    return f'<img width="480" alt="height and Mach number" src="data:image/png;base64,{_base64(picture)}">'


def _base64(content: bytes) -> str:
    return base64.b64encode(content).decode("ascii")


def number(value: float | None, form: str) -> str:
    """A number in a format; empty where there is none."""
    return f"{value:{form}}" if value is not None and math.isfinite(value) else ""


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table of texts."""
    cells = "".join(f"<th>{escape(cell)}</th>" for cell in head)
    body = "".join("<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in rows)
    return f"<table><thead><tr>{cells}</tr></thead><tbody>{body}</tbody></table>"
