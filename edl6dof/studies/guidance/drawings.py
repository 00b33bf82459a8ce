"""One figure that compares all laws in all conditions, and two of each vehicle that is flown dispersed."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from edl6dof.campaign.rows import Row
from edl6dof.report.figure import Axis, Figure, Heat, Panel
from edl6dof.studies import plots
from edl6dof.studies.guidance.conditions import DISPERSED
from edl6dof.studies.guidance.tables import TARGET_KM, best_first, conditions, largest, misses, names, of

#: Miss (km) at which the colour of the map ends.
_WORST_KM = 50.0
#: Height of the row of a law in a map, and of what stands above and below the rows.
_ROW_PX, _MARGINS_PX = 28, 84


def drawings(rows: Sequence[Row]) -> Iterator[Figure]:
    """The comparison; misses and footprints of dispersed entries."""
    yield _comparison(rows)
    dispersed = of(rows, condition=DISPERSED)
    for vehicle in names(dispersed, "vehicle"):
        yield from _of_dispersed(vehicle, of(dispersed, vehicle=vehicle))


def _comparison(rows: Sequence[Row]) -> Figure:
    vehicles = names(rows, "vehicle")
    panels = [_map(vehicle, of(rows, vehicle=vehicle)) for vehicle in vehicles]
    most = max(len(names(of(rows, vehicle=vehicle), "law")) for vehicle in vehicles)
    return Figure("comparison", "", panels, columns=2, height=_MARGINS_PX + _ROW_PX * most)


def _map(vehicle: str, rows: Sequence[Row]) -> Panel:
    """The largest miss, a row for each law, a column for each condition; coloured by its
    logarithm.
    """
    laws = best_first(rows)[::-1]
    columns = conditions(rows)
    miss = np.array([[largest(of(rows, law=law, condition=name)) for name in columns] for law in laws])
    shown = np.log10(np.clip(miss, 0.1, _WORST_KM))
    heat = Heat(
        np.arange(len(columns)), np.arange(len(laws)), shown, "log10 of the miss in km", -1.0,
        float(np.log10(_WORST_KM)), labels=[[_words(value) for value in line] for line in miss], written=True,
    )  # fmt: skip
    return Panel(Axis("", names=columns), Axis("", names=laws), heat=heat, title=f"{vehicle}: largest miss")


def _words(km: float) -> str:
    """Two digits, as the cells of a map hold; a flight that never came to the mortar is no number."""
    if np.isnan(km):
        return ""
    return "fails" if np.isinf(km) else f"{km:.1f}" if km < 9.95 else f"{km:.0f}"


def _of_dispersed(vehicle: str, rows: Sequence[Row]) -> Iterator[Figure]:
    order = best_first(rows)
    shares = []
    for law in order:
        miss = misses(of(rows, law=law))
        shares.append(plots.curve(np.sort(miss), np.arange(1, len(miss) + 1) / len(miss) * 100.0, law))
    limit = max(
        2.0 * TARGET_KM, 3.0 * float(np.quantile(misses(of(rows, law=order[0])), 0.99, method="higher"))
    )
    share = plots.panel(
        f"{vehicle}: miss at the mortar", "miss (km)", "flights within (%)", shares, x_range=(0.0, limit)
    )
    height = [
        plots.dots(misses(some := of(rows, law=law)), _column(some, "parachute_altitude_m") / 1e3, law)
        for law in order[:4]
    ]
    title = f"{vehicle}: altitude above the ellipsoid at the mortar, best four"
    altitude = plots.panel(title, "miss (km)", "altitude (km)", height, x_range=(0.0, limit))
    yield plots.figure(f"{vehicle}_miss", (share, altitude))
    prints = [_footprint(vehicle, law, of(rows, law=law)) for law in order[:3]]
    yield plots.figure(f"{vehicle}_footprint", prints)


def _footprint(vehicle: str, law: str, rows: Sequence[Row]) -> Panel:
    dots = plots.dots(
        _column(rows, "parachute_crossrange_m") / 1e3, _column(rows, "parachute_downrange_m") / 1e3
    )
    angle = np.linspace(0.0, 2.0 * np.pi, 100)
    circle = plots.reference(TARGET_KM * np.cos(angle), TARGET_KM * np.sin(angle), f"{TARGET_KM:g} km")
    return plots.panel(f"{vehicle}: {law}", "crossrange (km)", "downrange (km)", (dots, circle), equal=True)


def _column(rows: Sequence[Row], name: str) -> np.ndarray:
    return np.array([row.get(name, np.nan) for row in rows], float)
