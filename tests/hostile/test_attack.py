"""A short run of each attack; the long ones are commands in CONTRIBUTING.md."""

from __future__ import annotations

from subprocess import CompletedProcess

import attack
import attempt
import pytest


@pytest.mark.parametrize(
    ("kind", "number", "ends"),
    [
        ("lines", 12, {0, 1, 2}),
        ("trees", 20, {0, 2}),
        ("damage", 12, {0, 2}),
        ("received", 3, {0, 1, 2}),
        pytest.param("lines", 200, {0, 1, 2}, marks=pytest.mark.long),
        pytest.param("trees", 200, {0, 1, 2}, marks=pytest.mark.long),
        pytest.param("kills", 6, {0, 1}, marks=pytest.mark.long),
        pytest.param("damage", 60, {0, 1, 2}, marks=pytest.mark.long),
        pytest.param("received", 40, {0, 1, 2}, marks=pytest.mark.long),
    ],
)
def test_attempts_end_with_a_message_and_never_with_a_traceback(kind, number, ends):
    results = attack.run(kind, number, seed=2026, jobs=1)
    assert [result for result in results if result["wrong"]] == []
    assert ends <= {result["status"] for result in results}, "some pass, some are refused"
    assert len({result["number"] for result in results}) == number


@pytest.mark.parametrize(
    "status, out, err, wrong",
    [
        (0, "ok", "", False),
        (2, "", "x.yaml:3:1: mass: must be a number", False),
        (70, "", "Traceback (most recent call last):", True),
        (1, "", "Traceback (most recent call last):", True),
        (-11, "", "", True),
        (2, "", "", True),
        (2, "", "bell \a", True),
    ],
)
def test_attack_sees_a_wrong_ending(status, out, err, wrong, monkeypatch, tmp_path):
    monkeypatch.setattr(attempt, "called", lambda *words: CompletedProcess(words, status, out, err))
    assert bool(attempt.ended(["check"], tmp_path).wrong) == wrong


def test_attack_sees_what_a_refusal_leaves_behind(monkeypatch, tmp_path):
    def careless(*words):
        (tmp_path / "half-written").touch()
        return CompletedProcess(words, 2, "", "no")

    monkeypatch.setattr(attempt, "called", careless)
    assert "half-written" in attempt.ended(["fly"], tmp_path).wrong


def test_attack_names_a_mutation_that_kills_the_process_and_goes_on(monkeypatch, tmp_path):
    deadly = tmp_path / "worker.py"
    deadly.write_text(
        "import json, os, sys\n"
        "for number in map(int, sys.argv[-1].split(',')):\n"
        "    print(json.dumps({'begin': number}), flush=True)\n"
        "    if number == 2:\n"
        "        os.abort()\n"
        "    done = {'number': number, 'words': ['check'], 'status': 0, 'wrong': ''}\n"
        "    print(json.dumps(done), flush=True)\n"
    )
    monkeypatch.setattr(attack, "__file__", str(deadly))
    results = attack.batch("lines", 1, [0, 1, 2, 3])
    assert [(result["number"], bool(result["wrong"])) for result in results] == [
        (0, False),
        (1, False),
        (2, True),
        (3, False),
    ]
