"""A signature is a right of access: the cycle alone holds the memories of all modules of the flight software,
one module alone opens valves, each record is written by the steps that the cycle declares, and a module
writes of the signals that it exchanges those that it declares.
"""

import ast
import importlib
from typing import Any, NamedTuple

import pytest
from source_rules import PACKAGE
from step_effects import arguments, calls, stored, unused, written, written_by_calls

from edl6dof.fsw.cycle import WRITERS, run
from edl6dof.fsw.functions import PLACES

FSW = PACKAGE / "fsw"
CYCLE = FSW / "cycle.py"
CYCLE_RUN = run.py_func


def handed_on_whole(source: str, function: str, record: str) -> list[int]:
    """Lines in which ``function`` uses ``record`` other than for one of its fields: whoever gets it there
    sees everything.
    """
    body = next(
        node
        for node in ast.walk(ast.parse(source))
        if isinstance(node, ast.FunctionDef) and node.name == function
    )
    assert record in [argument.arg for argument in body.args.args]
    fields = {id(node.value) for node in ast.walk(body) if isinstance(node, ast.Attribute)}
    return [
        node.lineno
        for node in ast.walk(body)
        if isinstance(node, ast.Name) and node.id == record and id(node) not in fields
    ]


def valve_writers(source: str) -> list[int]:
    """Lines that write an opening or closing time of a valve anywhere but into a module's own memory."""
    return [
        node.lineno
        for node in ast.walk(ast.parse(source))
        if isinstance(node, ast.Subscript)
        and isinstance(node.ctx, ast.Store)
        and ast.unparse(node.value).split(".")[-1]
        in ("open_time", "close_time", "valve_open_time", "valve_close_time")
        and not ast.unparse(node.value).startswith("memory.")
    ]


def test_the_cycle_hands_each_module_its_own_memory():
    assert handed_on_whole(CYCLE.read_text(), "run", "fsw") == []


def test_nothing_else_of_the_flight_software_asks_for_all_memories():
    for file in FSW.rglob("*.py"):
        for node in ast.walk(ast.parse(file.read_text())):
            if isinstance(node, ast.FunctionDef) and (file, node.name) != (CYCLE, "run"):
                assert "fsw" not in [argument.arg for argument in node.args.args], f"{file}: {node.name}"


@pytest.mark.parametrize("planted", ["helper(onboard, fsw)", "whole = fsw", "helper(fsw.nav, memory=fsw)"])
def test_planted_hand_over_is_found(planted):
    source = f"def run(onboard, fsw):\n    navigate(fsw.nav)\n    {planted}\n"
    assert handed_on_whole(source, "run", "fsw") == [3]


def test_modulation_alone_writes_valve_intervals():
    writers = {file.name for file in FSW.rglob("*.py") if valve_writers(file.read_text())}
    assert writers == {"modulation.py"}


def test_planted_second_writer_is_found():
    assert valve_writers("def f(i, t, command):\n    command.valve_open_time[i] = t\n") == [2]
    assert valve_writers("def f(i, t, open_time, close_time):\n    open_time[i] = close_time[i] = t\n") == [
        2,
        2,
    ]


def declared_signals(source):
    """Signals that a module declares, none without; and those of them that it declares to write."""
    fields, writes = set(), set()
    for node in ast.parse(source).body:
        if isinstance(node, ast.ClassDef) and node.name.endswith("Signals"):
            fields = {field.target.id for field in node.body if isinstance(field, ast.AnnAssign)}
        elif isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "WRITES":
            writes = set(ast.literal_eval(node.value))
    return fields, writes


def read_signals(source):
    """Signals that a module names."""
    return {
        node.attr
        for node in ast.walk(ast.parse(source))
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id == "signals"
    }


#: Modules that take signals, each with those that it shares its own with.
EXCHANGE = {
    "diagnosis/diagnose.py": (
        "diagnosis/hypotheses.py",
        "diagnosis/leak_isolation.py",
        "diagnosis/openings.py",
    ),
    "diagnosis/exercise.py": (),
}


@pytest.mark.parametrize("module, helpers", EXCHANGE.items(), ids=EXCHANGE)
def test_a_module_takes_the_signals_that_it_reads_and_writes_those_that_it_declares(module, helpers):
    sources = [(FSW / file).read_text() for file in (module, *helpers)]
    fields, writes = declared_signals(sources[0])
    assert fields and writes <= fields
    assert set.union(*map(read_signals, sources)) == fields
    exchanging = exchanging_functions("edl6dof.fsw." + module.removesuffix(".py").replace("/", "."))
    assert {f"signals.{name}" for name in writes} == set().union(*map(signals_written, exchanging))


def test_every_module_with_signals_is_looked_at():
    found = {file.relative_to(FSW).as_posix() for file in FSW.rglob("*.py") if "signals." in file.read_text()}
    assert found == {*EXCHANGE, *(helper for helpers in EXCHANGE.values() for helper in helpers)}


def exchanging_functions(module):
    """Kernels of a module that take signals."""
    kernels = [getattr(one, "py_func", None) for one in vars(importlib.import_module(module)).values()]
    return [one for one in kernels if one and one.__module__ == module and "signals" in arguments(one)]


def signals_written(function):
    """Signals that a function writes."""
    return {record for record in written(function) if record.startswith("signals.")}


def test_each_record_is_written_by_the_steps_that_the_cycle_declares():
    found = {}
    for step, record in [*written_by_calls(CYCLE_RUN), *(("run", record) for record in stored(CYCLE_RUN))]:
        if record is not None:
            found.setdefault(record.removeprefix("fsw."), set()).add(step)
    assert found == {record: set(steps) for record, steps in WRITERS.items()}


def test_a_step_is_handed_nothing_that_it_does_not_look_at():
    assert [
        (step, unused(called))
        for step, called, _ in calls(CYCLE_RUN)
        if step not in PLACES and unused(called)
    ] == []


class Packed(NamedTuple):
    """Signals that carry a record."""

    nav: Any


def nudge(place):
    """Write into an array."""
    place[0] += 1.0


def writes_by_a_call(nav, goal, t):
    """Write a part of ``nav`` under another name."""
    place, goal = nav.r_I, nav.t
    nudge(place)
    return goal


def writes_signals(signals):
    """Write a signal."""
    nudge(signals.nav.v_I)


def writes_by_signals(nav, goal):
    """Write a record that is handed on as a signal."""
    signals = Packed(nav=nav)
    writes_signals(signals)
    return goal.t


def test_planted_writes_and_idle_arguments_are_found():
    assert written(writes_by_a_call) == {"nav"} and unused(writes_by_a_call) == {"t"}
    assert written(writes_signals) == {"signals.nav"}
    assert written(writes_by_signals) == {"nav"} and unused(writes_by_signals) == set()
