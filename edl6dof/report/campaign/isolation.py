"""Faults that every flight of a campaign carries, and whether the flight computer found them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from edl6dof.campaign.statistics import Proportion
from edl6dof.metrics.figures import figure_of_merit
from edl6dof.report.campaign.margins import head, in_words, shown_shares
from edl6dof.report.campaign.results import Results
from edl6dof.report.document import Block, Row, Table
from edl6dof.report.numbers import printed

#: Figures that count what should be none: what it says of a flight in which there is none.
_COUNTS = {
    "missed_isolations": "every failed thruster isolated",
    "false_alarms": "no sound thruster isolated, and none for a wrong kind of fault",
    "instrument_false_alarms": "no sound instrument excluded",
}
_TIMES = ("time_to_detect_s", "time_to_exclude_s")


def injected(results: Results) -> list[str]:
    """The faults of every flight in words: ``D7 stuck off at lift + 2 s``."""
    return [_in_words(fault) for fault in _of_every_flight(results)]


def blocks(results: Results) -> Iterator[Block]:
    """In how many flights the faults were isolated, and how fast; nothing without faults."""
    if not _of_every_flight(results):
        return
    shares: list[Row] = []
    for name, meaning in _COUNTS.items():
        if results.has(name):
            counts = results[name]
            told = counts[np.isfinite(counts)]
            share = Proportion(int(np.sum(told == 0)), len(told))
            shares.append([meaning, f"{share.successes} of {share.trials}", str(share)])
    if shares:
        yield Table(["", "flights>", "share, 95 % interval>"], shares)
    quantiles = shown_shares(results)
    times: list[Row] = [
        [
            figure.meaning,
            printed(figure.unit.label),
            *(in_words(results, results[figure.name], share) for share in quantiles),
        ]
        for figure in map(figure_of_merit, _TIMES)
        if results.has(figure.name)
    ]
    if times:
        yield Table(["", "unit", *(f"{head(share)}>" for share in quantiles)], times)


def _of_every_flight(results: Results) -> Sequence[Mapping[str, Any]]:
    """The scenario's own faults; a fault matrix tells of those of its cells."""
    return () if results.has_faults else results.document.get("faults") or ()


def _in_words(fault: Mapping[str, Any]) -> str:
    named = [value for key, value in fault.items() if isinstance(value, str) and key != "kind"]
    what, begins = " ".join([*named, fault["kind"].replace("_", " ")]), fault["at"]
    if begins.get("phase") is None:
        return f"{what} at {begins['time_s']:g} s"
    after = f" + {begins['plus_s']:g} s" if begins.get("plus_s") else ""
    return f"{what} at {begins['phase'].replace('_', ' ')}{after}"
