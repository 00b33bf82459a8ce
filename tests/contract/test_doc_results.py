"""Measured results in the documents carry the hash of the flights that they were measured on.

Results that are out of date are reported, not refused: renewing all of them takes an hour.
"""

from __future__ import annotations

import sys
import warnings
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tools"))
import doc_results
from doc_results import ROOT, flights_hash, pages, renewed, results

OLD = "<!-- measured by `edl6dof fly msl` on msl 00000000 -->\n"
BLOCK = "```text\nold\n```\n"


def test_results_that_are_out_of_date_are_reported():
    found = [result for path in pages() for result in results(str(path.relative_to(ROOT)), path.read_text())]
    assert len({result.page for result in found}) >= 5
    for result in found:
        if not result.current:
            warnings.warn(f"{result.page}:{result.line}: out of date: {result.command}", stacklevel=1)


def test_every_remark_is_read():
    """A remark with a slip of the pen would never be reported."""
    for path in pages():
        text = path.read_text(encoding="utf-8")
        assert text.count("<!-- measured") == len(results(path.name, text)), path.name


def test_a_result_is_current_until_its_flights_change():
    text = f"<!-- measured by `edl6dof fly msl` on msl {flights_hash('msl')} -->\n" + BLOCK + OLD
    first, second = results("page", text)
    assert (first.current, first.generated) == (True, True)
    assert (second.current, second.generated, second.line) == (False, False, 5)
    assert len({flights_hash(names) for names in ("msl", "tianwen1", "msl, tianwen1", "all")}) == 4


def test_an_unknown_flight_is_refused():
    with pytest.raises(KeyError, match="no_such_flight"):
        results("page", OLD.replace("on msl", "on no_such_flight"))


def test_renewing_runs_the_command_and_keeps_what_stands_around():
    now = flights_hash("msl")
    text = "before\n" + OLD + BLOCK + "after\n"
    remark = OLD.replace("00000000", now)
    expected = f"before\n{remark}```text\nran edl6dof fly msl\n```\nafter\n"
    assert renewed(text, "", lambda command: f"ran {command}") == expected
    assert renewed(text, "campaign", lambda command: "never") == text
    assert (
        renewed(OLD, "", lambda command: "never") == OLD
    )  # nothing to replace: renewed by hand, then stamped
    assert renewed(OLD, "fly msl", None) == OLD.replace("00000000", now)


def test_markdown_is_replaced_up_to_its_end():
    text = OLD + "<!-- markdown -->\n| old |\n\nold\n<!-- /measured -->\nafter\n"
    (result,) = results("page", text)
    assert result.generated and not result.current
    remark = OLD.replace("00000000", flights_hash("msl"))
    expected = f"{remark}<!-- markdown -->\n| new |\n<!-- /measured -->\nafter\n"
    assert renewed(text, "", lambda command: "| new |") == expected


def test_output_is_what_the_command_prints(capfd):
    assert doc_results.output_of("echo one; echo; echo; echo; echo two; pwd >&2") == "one\n\ntwo"
    with pytest.raises(SystemExit, match="printed nothing"):
        doc_results.output_of("true")
