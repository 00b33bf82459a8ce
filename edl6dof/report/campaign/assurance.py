"""A campaign judged by requirements: verdicts, worst cases, and evidence for the credibility of the results,
as data and as one page for a review board.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from math import ceil, floor
from pathlib import Path
from shlex import quote
from typing import Any

import numpy as np

from edl6dof.campaign import assurance as judging
from edl6dof.campaign.assurance import CONFIDENCE, SHARE, Verdict, judge
from edl6dof.campaign.constants import Separation, flights_to_separate, separate
from edl6dof.campaign.row_columns import BELIEF, TRUTH
from edl6dof.campaign.statistics import percent
from edl6dof.campaign.store import Store
from edl6dof.config.document.source import parse_document
from edl6dof.config.errors import refusal
from edl6dof.config.wording import counted
from edl6dof.metrics.figures import DECLARED, figure_of_merit
from edl6dof.report.campaign.campaign_results import Results
from edl6dof.report.document import (
    Block,
    Cell,
    Fact,
    Mood,
    Report,
    Row,
    Section,
    Table,
    Text,
    in_percent,
    printed,
    significant,
)

_MOODS: dict[str, Mood] = {"verified": "good", "undecided": "warn", "violated": "bad"}
#: Columns that are numbers and no figures of merit.
_NO_FIGURES = {"case", "success", "profile", "end_s"}
_MEANING = """\
Verified: were the true share smaller than the required one, so few failures would have a probability of at \
most one minus the confidence (consumer risk). Violated: the upper confidence bound of the share is below \
the required share. Bound: confidence bound of the figure at the required share, by order statistics. A \
flight that ended before it reached the figure, or failed for another reason than a limit, is a failure of \
every requirement. Each verdict has a consumer risk of its own."""
_KINDS = """\
The plan does not separate uncertainties that are random from flight to flight from those that are constant \
but unknown (campaign.constant): each share is an average over both."""
_AVERAGE = "Each share of the verdicts is an average over random and constant uncertainties."
_CONSTANTS = """\
Constant but unknown: {}. All other dispersions are random from flight to flight. Due to constants: share of \
the variance of the figure. Worst tenth: the flights whose constants have the smallest predicted margins. \
Demonstrated: for nine tenths of the values of the constants, at least this share of the flights meets the \
requirement, with its confidence, if the share falls with the predicted margin. Moved: share of all flights \
that meets it with the constants at the edge of the worst tenth, an estimate that takes the random part as \
independent of the constants."""
_SAMPLED = {
    "monte_carlo": "The flights are independent.",
    "sobol_indices": "Only the flights of matrices A and B of the design count.",
}
_STRATIFIED = """\
The flights are stratified ({}), not independent: the consumer risk is at most the stated one where failures \
depend on each input in one direction."""
_UNTIL = """\
The campaign stopped early ({}): its number of flights depended on their results, and the consumer risk may \
exceed the stated one."""
_MORE = """\
For the undecided: {}. A campaign that is repeated with more flights until it verifies has a larger consumer \
risk: choose the number of flights before the decision."""
#: Columns of the credibility sheet.
_SHEET = ("factor", "evidence", "command")
_ABSENT = "not assessed by this program"
#: Factors of credibility of NASA-STD-7009, with the evidence of the program and the command that shows it.
_FACTORS = (
    ("verification", "comparison with exact solutions and check cases", "edl6dof verify"),
    ("validation", "comparison with measured values of flown missions", "edl6dof validate"),
    ("input pedigree", "status of the values: {pedigree}", "edl6dof show {folder}/campaign.yaml"),
    ("results uncertainty", "this page: shares with their confidence", "edl6dof assure {folder}"),
    ("results robustness", "inputs that drive each figure", "edl6dof report {folder}"),
    ("use history", _ABSENT, ""),
    ("M&S management", "hashes of plan, sources and files; repeated case", "edl6dof refly {folder} 0"),
    ("people qualifications", _ABSENT, ""),
)


@dataclass(frozen=True, repr=False)
class Assurance:
    """A campaign judged by requirements.

    Attributes:
        results: rows of the campaign.
        verdicts: each requirement with its verdict.
        separations: for each requirement, its failures where the constants are at their worst; ``None`` if no
            dispersion is constant, or the flights are too few.
        source: origin of the requirements, in words.
    """

    results: Results
    verdicts: tuple[Verdict, ...]
    separations: tuple[Separation | None, ...]
    source: str

    @property
    def verified(self) -> bool:
        """True if every requirement is verified."""
        return all(one.verdict == "verified" for one in self.verdicts)

    @property
    def headline(self) -> str:
        """Outcome in one line."""
        count = Counter(one.verdict for one in self.verdicts)
        rest = "".join(f", {count[name]} {name}" for name in ("violated", "undecided") if count[name])
        whole = counted(len(self.verdicts), "requirement")
        return f"{self.results.name}: {count['verified']} of {whole} verified{rest}"

    @property
    def next_command(self) -> str | None:
        """Command that flies a campaign that verifies what is undecided, if it has no further failures."""
        if not (needed := [one.needed for one in self.verdicts if one.verdict == "undecided"]):
            return None
        cases, folder = ceil(max(needed) / (2 if self.results.has_design else 1)), self.results.folder
        plan, out = quote(f"{folder}/campaign.yaml"), quote(f"{folder}-{cases}")
        return f"edl6dof campaign {plan} -n {cases} --out {out}"

    @property
    def data(self) -> dict[str, Any]:
        """Everything, ready for JSON."""
        requirements = []
        for one, apart in zip(self.verdicts, self.separations, strict=True):
            own = {"requirement": one.requirement.model_dump(), "worst": self.worst(one)}
            requirements.append({**vars(one), **own, "constants_at_worst": apart and vars(apart)})
        return {
            "campaign": self.results.name,
            "requirements_from": self.source,
            "flights": self.results.success.trials,
            "within_all_limits": self.results.success.successes,
            "requirements": requirements,
            "next": self.next_command,
            "notes": list(_notes(self)),
            "credibility": [dict(zip(_SHEET, row, strict=True)) for row in _factors(self)],
        }

    def worst(self, one: Verdict) -> list[dict[str, Any]]:
        """Worst cases of a requirement: number, value (NaN if the flight has none), and refly command."""
        cases, again = self.results.cases, f"edl6dof refly {quote(str(self.results.folder))}"
        found = [(int(cases[row]), value) for row, value in one.worst]
        return [{"case": case, "value": value, "command": f"{again} {case}"} for case, value in found]

    def __repr__(self) -> str:
        return f"<Assurance {self.headline}>"


def assess(folder: Path, requirements: Path | None = None) -> Assurance:
    """Judge the campaign of a folder; by default by the limits of its scenario, each as a requirement.

    Raises:
        ConfigError: the folder has no complete campaign, or one whose flights are no random sample; or the
            requirements are wrong.
    """
    Store(folder).require_complete()
    results = Results(folder)
    if not results.is_sample:
        kind = "cells of a fault matrix" if results.has_faults else "points of a grid"
        raise refusal(folder, f"its flights are the {kind}, no random sample: they demonstrate no share")
    if requirements is None:
        source = f"limits of the scenario, share {percent(SHARE)}, confidence {percent(CONFIDENCE)}"
        limits = judging.limits_as_requirements(results.document["limits"])
        wanted = [one for one in limits if results.has(one.figure)]
    else:
        columns = {name for name in results.table.column_names if results.has(name)} - _NO_FIGURES
        known = DECLARED | {name for name in columns if not name.startswith((TRUTH, BELIEF))}
        source, wanted = str(requirements), judging.load_requirements(requirements, known)
    if not wanted:
        raise refusal(folder, "its scenario has no limits: name a file of requirements")
    absent = np.full(len(results.cases), np.nan)
    figures = [results[one.figure] if results.has(one.figure) else absent for one in wanted]
    verdicts = [judge(*pair, results.failed) for pair in zip(wanted, figures, strict=True)]
    constants = np.array(list(results.constants.values())).T
    kept = (np.where(results.failed, np.nan, own) for own in figures)
    margins = (one.margins(own) for one, own in zip(wanted, kept, strict=True))
    separations = [separate(constants, own) if len(constants) else None for own in margins]
    return Assurance(results, tuple(verdicts), tuple(separations), source)


def assurance_report(found: Assurance) -> Report:
    """Return the page for a review board."""
    success, identity = found.results.success, found.results.store.info.identity
    failures = success.trials - success.successes
    low, _ = judging.share_bounds(failures, success.trials, CONFIDENCE)
    sheet = Table(_SHEET, list(_factors(found)))
    return Report(
        title=f"{found.results.name}: assurance",
        headline=found.headline,
        mood=max((_MOODS[one.verdict] for one in found.verdicts), key=("good", "warn", "bad").index),
        subtitle=f"requirements: {found.source}",
        facts=[
            Fact("flights", f"{success.trials:,}"),
            Fact("within all limits", f"{success.successes:,}"),
            Fact(f"demonstrated with {percent(CONFIDENCE)} confidence", _rounded_down(low, SHARE)),
        ],
        sections=[
            Section("requirements", "Requirements", [_requirements(found)]),
            Section("constants", "Random and constant uncertainties", list(_separated(found))),
            Section("worst", "Worst cases", [_worst_cases(found)]),
            Section("meaning", "Meaning and conditions", list(map(Text, _notes(found)))),
            Section("credibility", "Credibility (factors of NASA-STD-7009)", [sheet]),
        ],
        footer=f"edl6dof {identity.versions['edl6dof']}; source SHA-256 {identity.sources}",
    )


def _requirements(found: Assurance) -> Table:
    rows: list[Row] = []
    for one in found.verdicts:
        asked, words = one.requirement, one.verdict
        limit = f"{'<=' if asked.sign > 0.0 else '>='} {significant(asked.limit)}"
        limit = f"{limit} {printed(figure_of_merit(asked.figure).unit.label)}".strip()
        bound = "-" if one.bound is None else significant(one.bound)
        required = f"{percent(asked.share)} at {percent(asked.confidence)}"
        shown = _rounded_down(one.demonstrated, asked.share)
        verdict = f"{words}: needs {one.needed:,}" if words == "undecided" else words
        cells = (limit, bound, f"{one.failures:,}", required, shown)
        rows.append([asked.label, *cells, Cell(verdict, _MOODS[words])])
    heads = ("requirement", "limit>", "bound>", "failures>", "required>", "demonstrated>", "verdict")
    return Table(heads, rows)


def _separated(found: Assurance) -> Iterator[Block]:
    """Yield the results for the worst values of the constants, or the reason for having none."""
    constants, flights = found.results.constants, len(found.results.cases)
    if not constants:
        yield Text(_KINDS)
        return
    campaign = found.results.document["campaign"]
    yield Text(_CONSTANTS.format(", ".join(campaign["constant"])))
    if (needed := flights_to_separate(len(constants))) > flights:
        yield Text(f"Too few flights: {counted(len(constants), 'constant')} would need {needed:,}.")
        return
    heads = ("requirement", "due to constants>", "worst tenth>", "failures>", "demonstrated>", "moved>")
    rows: list[Row] = []
    for one, apart in zip(found.verdicts, found.separations, strict=True):
        share = one.requirement.share
        if apart is None:
            rows.append([one.requirement.id, "too few flights with the figure", *[""] * 4])
            continue
        low, _ = judging.share_bounds(apart.failures, apart.flights, one.requirement.confidence)
        cells = in_percent(apart.explained), f"{apart.flights:,}", f"{apart.failures:,}"
        moved = 1.0 - apart.moved_failures / flights
        rows.append([one.requirement.id, *cells, _rounded_down(low, share), _rounded_down(moved, share)])
    yield Table(heads, rows)


def _rounded_down(share: float, required: float) -> str:
    """Format a share, rounded down to the decimals of the required one, at least two."""
    places = max(2, len(f"{100.0 * required:g}".partition(".")[2]))
    return f"{floor(share * 10.0 ** (places + 2)) / 10.0**places:.{places}f} %"


def _worst_cases(found: Assurance) -> Table:
    rows: list[Row] = []
    for one in found.verdicts:
        worst = found.worst(one)
        cases = ", ".join(f"{item['case']} ({significant(item['value'])})" for item in worst)
        rows.append([one.requirement.id, cases.replace("(nan)", "(not reached)"), worst[0]["command"]])
    return Table(["requirement", "worst cases (value)", "the worst again"], rows)


def _notes(found: Assurance) -> Iterator[str]:
    """Yield the meaning of the verdicts, and the conditions under which they hold."""
    sampling, until = found.results.document["campaign"]["sampling"], found.results.store.info.until
    yield _MEANING
    yield _SAMPLED.get(sampling) or _STRATIFIED.format(sampling)
    yield _AVERAGE if found.results.constants else _KINDS
    if until:
        yield _UNTIL.format(until)
    if found.next_command:
        yield _MORE.format(found.next_command)


def _factors(found: Assurance) -> Iterator[tuple[str, ...]]:
    marks = Counter(parse_document(found.results.store.plan_text, "campaign.yaml").status.values())
    pedigree = ", ".join(f"{number:,} {status}" for status, number in marks.most_common())
    for row in _FACTORS:
        yield tuple(cell.format(pedigree=pedigree, folder=quote(str(found.results.folder))) for cell in row)
