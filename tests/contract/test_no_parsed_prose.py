"""What an event or an outcome says in words is for people: what a program needs of it is a datum of its
own.
"""

import pytest
from source_rules import breaches, modules, parsed_prose


def test_nothing_is_read_back_out_of_words():
    assert breaches(lambda _, source: parsed_prose(source), modules()) == {}


@pytest.mark.parametrize(
    "planted",
    [
        "event['key'].startswith('phase.')",
        "event['name'].removeprefix('phase ')",
        "re.search('D7', event['name'])",
        "str(event['detail']).partition(': ')",
        "flight.outcome.startswith('landed within')",
        "'outside limits' in str(summary['outcome'])",
    ],
)
def test_planted_parsing_is_found(planted):
    assert parsed_prose(planted)


@pytest.mark.parametrize(
    "fine", ["event['key'] == 'fault'", "event['key'] in ('fault', 'diagnosis')", "print(flight.outcome)"]
)
def test_comparing_whole_keys_and_showing_words_is_fine(fine):
    assert not parsed_prose(fine)
