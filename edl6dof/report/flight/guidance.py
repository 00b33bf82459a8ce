"""Entry guidance: the bank angle asked for and flown, the reference that is tracked, and what is left to the
target.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from edl6dof.report.figure import BLUE, GREEN, GREY, VERMILION, Figure
from edl6dof.report.flight.parts import Curve, has_signal, over_time, stacked
from edl6dof.runs.run import Run


def figures(run: Run) -> Iterator[Figure]:
    """Figures of the section."""
    rows = run.between(until="mortar")
    if not has_signal(run, "guide.range_to_go_km", rows):
        return
    bank = [
        Curve("guide.bank_deg", "commanded", colour=VERMILION, dash="dash"),
        Curve("truth.bank_deg", "flown", colour=BLUE),
    ]
    panels = [over_time(run, "bank (deg)", bank, rows, (-185.0, 185.0))]
    if has_signal(run, "truth.rate_p_deg_s", rows):
        panels.append(
            over_time(
                run,
                "bank rate about\nthe body axis (deg/s)",
                [Curve("truth.rate_p_deg_s", colour=BLUE)],
                rows,
            )
        )
    caption = f"{int(np.nan_to_num(run.summary['figures'].get('bank_reversals') or 0.0))} bank reversals."
    yield stacked("bank", "Bank angle", panels, caption, 230)
    drag = [
        Curve("guide.reference_drag_m_s2", "reference", colour=GREY, dash="dash"),
        Curve("nav.drag_m_s2", "measured", colour=BLUE),
    ]
    panels = [
        over_time(run, "drag (m/s²)", drag, rows),
        over_time(run, "range to go (km)", [Curve("guide.range_to_go_km", colour=BLUE)], rows),
        over_time(run, "crossrange (km)", [Curve("guide.crossrange_km", colour=BLUE)], rows),
    ]
    panels += [
        over_time(run, title, [Curve(name, "", 1.0, GREEN)], rows)
        for title, name in (
            ("estimated drag\ndisturbance (m/s⁴)", "guide.drag_disturbance_m_s4"),
            ("estimated path\ndisturbance (deg/s)", "guide.path_disturbance_deg_s"),
        )
        if has_signal(run, name, rows)
    ]
    caption = (
        "Range and crossrange to the aim point of the entry; crossrange is positive when heading right of it."
    )
    yield stacked("targeting", "Drag against the reference, and the way to go", panels, caption)
