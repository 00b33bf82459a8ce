"""A signature is a right of access: the cycle alone holds the memories of all modules of the flight software,
and one module alone opens valves.
"""

import ast

import pytest
from source_rules import PACKAGE

FSW = PACKAGE / "fsw"
CYCLE = FSW / "cycle.py"


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
        and ast.unparse(node.value).split(".")[-1] in ("opens", "closes")
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
    assert valve_writers("def f(i, t, command):\n    command.opens[i] = t\n") == [2]
    assert valve_writers("def f(i, t, opens, closes):\n    opens[i] = closes[i] = t\n") == [2, 2]
