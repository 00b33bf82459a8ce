"""YAML text to data, places and provenance marks."""

from __future__ import annotations

import pytest
import yaml
from config_toy import GOOD, document, write

from edl6dof.config.document import yamltree
from edl6dof.config.document.source import read_document
from edl6dof.config.document.yamltree import read_scalar, write_flow
from edl6dof.config.errors import ConfigError


@pytest.fixture(params=["libyaml", "pure python"])
def loader(request, monkeypatch):
    if request.param == "pure python":
        monkeypatch.setattr(yamltree, "LOADER", yaml.SafeLoader)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1e5", 1e5),
        ("1.0e5", 1e5),
        ("-3.5E-2", -0.035),
        (".5", 0.5),
        ("5.", 5.0),
        ("+1.5", 1.5),
        ("010", 10),
        ("-7", -7),
        ("0x1F", 31),
        ("0o17", 15),
        ("true", True),
        ("false", False),
        ("null", None),
        ("~", None),
        ("on", "on"),
        ("yes", "yes"),
        ("No", "No"),
        ("1_000", "1_000"),
        ("1:30", "1:30"),
        ("2021-05-14", "2021-05-14"),
        ("inf", "inf"),
        ("1e", "1e"),
        ("0.1.2", "0.1.2"),
        ("100000000000000000000", 10**20),
    ],
)
def test_plain_scalars_follow_yaml_1_2(text, value):
    result = document(f"key: {text}\n").data["key"]
    assert result == value
    assert type(result) is type(value)


def test_quotes_make_text():
    assert document("a: '1.5'\nb: \"true\"\nc: ''\n").data == {"a": "1.5", "b": "true", "c": ""}


TEXTS = ["true", "null", "1e5", "a: b", "a #b", " x", "", "[1]", "é\u2028\x7f\U0001f680\n", "x y", "-", "~"]


@pytest.mark.parametrize("text", TEXTS)
def test_written_text_reads_back_as_the_same_text(text):
    assert document(f"key: {write_flow(text)}\n").data["key"] == text
    assert document(f"key: [{write_flow(text)}, 1]\n").data["key"] == [text, 1]


@pytest.mark.parametrize("value", [0.1, 1e22, 5e-324, -0.0, 1.7976931348623157e308, 3.0, 2**62, -5])
def test_written_numbers_read_back_with_the_same_bits(value):
    result = read_scalar(write_flow(value))
    assert (repr(result), type(result)) == (repr(value), type(value))


def test_marks_give_line_and_column_of_keys_and_list_items(loader):
    marks = document(GOOD).marks
    assert marks["vehicle", "mass", "entry_mass_kg"] == ("toy.yaml", 7, 5)
    assert marks["vehicle", "rcs", "thrusters", 1] == ("toy.yaml", 12, 9)
    assert marks["vehicle", "rcs", "thrusters", 1, "thrust_n"][1:] == (13, 9)
    assert marks["vehicle", "rcs", "thrusters", 0, "position_m"][1:] == (11, 20)


def test_status_marks_stand_at_the_end_of_a_line_and_are_inherited_from_the_parents_key(loader):
    read = document(GOOD)
    assert read.status == {
        "vehicle.mass.entry_mass_kg": "published",
        "vehicle.mass.cg_m": "estimate",
        "vehicle.rcs.thrusters.1.thrust_n": "derived",
    }
    assert read.sources["vehicle.mass.entry_mass_kg"] == "S1 section 7"


def test_status_marks_are_found_behind_every_kind_of_value(loader):
    text = """\
a: 1  # [P] one
b: {c: 1, d: [1, 2]}  # [R]
e:  # [E]
  - [1, 2]
  - [3, 4]  # [D]
f: 'x # [P]'
g: [1,
    2]   # [S] two
h: 3 # see [P]
i: 4 # [Z]
j:
  - name: x  # [P]
    k: 2
m:  # [R] all
  - n: 1
l: 1# [P]
"""
    assert document(text).status == {
        "a": "published",
        "b.c": "recalled",
        "b.d": "recalled",
        "e": "estimate",
        "e.1": "derived",
        "g": "design",
        "j.0.name": "published",
        "m.0.n": "recalled",
    }


BROKEN = {
    "empty": ("", 1, "empty"),
    "only a comment": ("# nothing\n", 1, "empty"),
    "list at the top": ("- 1\n", 1, "mapping of keys"),
    "number at the top": ("12\n", 1, "mapping of keys"),
    "duplicate key": ("a: 1\nb:\n  c: 1\n  c: 2\n", 4, "twice (first on line 3)"),
    "duplicate key in flow style": ("a: {b: 1, b: 2}\n", 1, "twice"),
    "not a number": ("a: 1\nb: .nan\n", 2, "finite"),
    "infinity": ("b: -.inf\n", 1, "finite"),
    "too large": ("b: 1e999\n", 1, "finite"),
    "absurdly long integer": ("b: " + "9" * 5000, 1, "300 characters"),
    "alias": ("a: &x 1\nb: *x\n", 2, "alias"),
    "merge of an alias": ("a: &x {c: 1}\nb:\n  <<: *x\n", 3, "alias"),
    "python tag": ("a: !!python/object/apply:os.getcwd []\n", 1, "tags"),
    "string tag": ("a: !!str 1\n", 1, "tags"),
    "tab": ("a:\n\tb: 1\n", 2, "tab"),
    "unclosed list": ("a: [1, 2\nb: 3\n", 2, "not valid YAML"),
    "unclosed quote": ("a: 'x\n", 2, "not valid YAML"),
    "wrong indent": ("a: 1\n  b: 2\n", 2, "not valid YAML"),
    "two colons": ("a: b: c\n", 1, "not valid YAML"),
    "two documents": ("a: 1\n---\nb: 2\n", 2, "one YAML document"),
    "list as key": ("? [1, 2]\n: 3\n", 1, "key must be a name"),
    "missing key": ("a: 1\n: 3\n", 2, "not valid YAML"),
    "empty key": ("a: 1\n'': 3\n", 2, "key must be a name"),
    "control character": ("a: 1\nb: \x07\n", 2, "'\\x07'"),
    "deep nesting": ("a: " + "[" * 100_000, 1, "levels deep"),
    "deep mappings": ("{a: " * 2000, 1, "levels deep"),
}


@pytest.mark.parametrize("name", BROKEN)
def test_broken_text_is_a_problem_with_its_line(name, loader):
    text, line, words = BROKEN[name]
    with pytest.raises(ConfigError) as caught:
        document(text)
    (problem,) = caught.value.problems
    assert words in problem.message
    assert problem.file == "toy.yaml"
    # the two parsers stop at different lines
    assert problem.line == line or name in ("unclosed quote", "unclosed list")
    assert "\n" not in str(caught.value)


def test_all_mistakes_of_a_text_are_reported_together():
    with pytest.raises(ConfigError) as caught:
        document("a: .nan\nb: 1\nb: 2\nc: !!str x\n")
    assert [problem.line for problem in caught.value.problems] == [1, 3, 4]


def test_unreadable_files_are_problems(tmp_path):
    def message(path):
        with pytest.raises(ConfigError) as caught:
            read_document(path)
        return str(caught.value)

    assert "no such file" in message(tmp_path / "missing.yaml")
    assert "folder" in message(tmp_path)
    latin = message(write(tmp_path, "latin.yaml", b"a: 1\nb: \xe9t\xe9\n"))
    assert "latin.yaml:2:4: is not UTF-8" in latin
    assert "not UTF-8" in message(write(tmp_path, "utf16.yaml", "a: 1\n".encode("utf-16")))
    assert "at most 2000000" in message(write(tmp_path, "big.yaml", b"#" * 2_000_001))
    assert "regular file" in message("/dev/null")


def test_byte_order_mark_and_windows_line_ends_are_harmless(tmp_path):
    read = read_document(write(tmp_path, "a.yaml", b"\xef\xbb\xbfa: 1  # [P] x\r\nb: 2\r\n"))
    assert read.data == {"a": 1, "b": 2}
    assert read.marks["b",].line == 2
    assert read.sources == {"a": "x"}
