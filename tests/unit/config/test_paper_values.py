"""Named settings: as_printed has the paper's numbers, and nothing else goes by that name."""

from __future__ import annotations

import pytest
from pydantic import ValidationError

from edl6dof.config.base import Params, PrintedParams, group, param
from edl6dof.config.document.overrides import apply_overrides
from edl6dof.config.document.source import parse_document
from edl6dof.config.dump import dump_resolved
from edl6dof.config.errors import ConfigError
from edl6dof.config.parameter_table import rows
from edl6dof.config.validate import validate


class Law(PrintedParams):
    """A law of a paper."""

    gain: float = param(0.5, "gain", printed=2.0, source="A & B 1999", gt=0.0)
    time_s: float = param(0.1, "time", status="published", source="A & B 1999", gt=0.0)
    limit: float = param(7.0, "limit")


class Guidance(Params):
    """Guidance."""

    law: Law = group(Law, "law")


def read(text):
    return parse_document(text, "toy.yaml")


def numbers(law):
    return law.gain, law.time_s, law.limit


def test_defaults_are_flown_and_as_printed_are_those_of_the_paper():
    assert numbers(Law()) == (0.5, 0.1, 7.0)
    assert numbers(Law(settings="as_printed")) == (2.0, 0.1, 7.0)
    assert Law.printed() == {"gain": 2.0, "time_s": 0.1}


def test_what_the_paper_does_not_print_may_be_chosen():
    assert numbers(Law(settings="as_printed", limit=3.0)) == (2.0, 0.1, 3.0)


@pytest.mark.parametrize("text", ["{}\n", "law: {gain: 0.7, limit: 3.0}\n"])
def test_one_key_chooses_on_the_command_line_whatever_gains_the_file_has(text):
    document = apply_overrides(read(text), ["law.settings=as_printed"], Guidance)
    assert validate(Guidance, document).law.gain == 2.0
    back = apply_overrides(document, ["law.settings=flown", "law.gain=0.9"], Guidance)
    law = validate(Guidance, back).law
    assert (law.gain, law.limit) == (0.9, 3.0 if "limit" in text else 7.0)


def test_another_number_does_not_go_by_the_name_of_the_paper():
    with pytest.raises(ValidationError):
        Law(settings="as_printed", gain=0.5, time_s=3.0)
    document = read("law:\n  settings: as_printed\n  gain: 0.5\n  time_s: 3.0\n")
    with pytest.raises(ConfigError) as refused:
        validate(Guidance, document)
    first, second = map(str, refused.value.problems)
    assert first.startswith("toy.yaml:3:3: law.gain: is 2 with settings: as_printed (got 0.5)")
    assert second.startswith("toy.yaml:4:3: law.time_s: is 0.1 with") and "say flown" in second


def test_resolved_settings_read_back_and_bear_the_mark_of_the_paper():
    text = dump_resolved(Guidance(law=Law(settings="as_printed")))
    assert "gain: 2.0  # [P] A & B 1999" in text
    assert validate(Guidance, read(text)).law == Law(settings="as_printed")
    assert "gain: 0.5  # [S]\n" in dump_resolved(Guidance())


def test_reference_shows_what_the_paper_prints():
    table = {row.path: row for row in rows(Guidance)}
    assert (table["law.gain"].default, table["law.gain"].printed) == ("0.5", "2.0")
    assert table["law.limit"].printed == ""
