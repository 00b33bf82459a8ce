"""A short run of the fuzzer; the long one is a command in CONTRIBUTING.md."""

from __future__ import annotations

from subprocess import CompletedProcess

import fuzz
import pytest


@pytest.mark.parametrize("mutations", [12, pytest.param(200, marks=pytest.mark.long)])
def test_mutated_inputs_end_with_a_message_and_never_with_a_traceback(mutations):
    results = fuzz.run(mutations, seed=2026, jobs=1)
    assert [result for result in results if result["wrong"]] == []
    statuses = {result["status"] for result in results}
    assert {0, 1, 2} == statuses, "some pass, some fly, some are refused"
    assert len({result["number"] for result in results}) == mutations


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
def test_fuzzer_sees_a_wrong_ending(status, out, err, wrong, monkeypatch, tmp_path):
    monkeypatch.setattr(fuzz, "called", lambda *words: CompletedProcess(words, status, out, err))
    assert bool(fuzz._ended(["check"], tmp_path)[1]) == wrong


def test_fuzzer_sees_what_a_refusal_leaves_behind(monkeypatch, tmp_path):
    def careless(*words):
        (tmp_path / "half-written").touch()
        return CompletedProcess(words, 2, "", "no")

    monkeypatch.setattr(fuzz, "called", careless)
    assert "half-written" in fuzz._ended(["fly"], tmp_path)[1]


def test_fuzzer_names_a_mutation_that_kills_the_process_and_goes_on(monkeypatch, tmp_path):
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
    monkeypatch.setattr(fuzz, "__file__", str(deadly))
    results = fuzz.batch(1, [0, 1, 2, 3])
    assert [(result["number"], bool(result["wrong"])) for result in results] == [
        (0, False),
        (1, False),
        (2, True),
        (3, False),
    ]
