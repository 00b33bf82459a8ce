"""A signature is a right of access: the cycle alone holds the memories of all modules of the flight software,
one module alone opens valves, and a module writes of the signals that it exchanges those that it declares.
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


def signal_of(node, known):
    """Signal that an expression is part of, by the names ``known`` for signals; none for another one."""
    while isinstance(node, ast.Subscript | ast.Attribute):
        if isinstance(node.value, ast.Name) and node.value.id == "signals":
            return getattr(node, "attr", None)
        node = node.value
    return known.get(node.id) if isinstance(node, ast.Name) else None


def written_signals(source):
    """Signals that functions of ``signals`` write, by themselves or by names that they give them."""
    found = set()
    for function in ast.walk(ast.parse(source)):
        if not isinstance(function, ast.FunctionDef) or "signals" not in [a.arg for a in function.args.args]:
            continue
        known = {}
        for node in ast.walk(function):
            if isinstance(node, ast.Assign):
                for target in node.targets:
                    values = getattr(node.value, "elts", [node.value])
                    for name, value in zip(getattr(target, "elts", [target]), values, strict=False):
                        if isinstance(name, ast.Name):
                            known[name.id] = signal_of(value, known)
        found |= {
            signal_of(node, known)
            for node in ast.walk(function)
            if isinstance(node, ast.Subscript | ast.Attribute) and isinstance(node.ctx, ast.Store)
        }
    return found - {None}


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
EXCHANGE = {"diagnosis/diagnose.py": ("diagnosis/leak_isolation.py",), "diagnosis/exercise.py": ()}


@pytest.mark.parametrize("module, helpers", EXCHANGE.items(), ids=EXCHANGE)
def test_a_module_takes_the_signals_that_it_reads_and_writes_those_that_it_declares(module, helpers):
    sources = [(FSW / file).read_text() for file in (module, *helpers)]
    fields, writes = declared_signals(sources[0])
    assert fields and writes <= fields
    assert set.union(*map(read_signals, sources)) == fields
    assert set.union(*map(written_signals, sources)) <= writes


def test_every_module_with_signals_is_looked_at():
    found = {file.relative_to(FSW).as_posix() for file in FSW.rglob("*.py") if "signals." in file.read_text()}
    assert found == {*EXCHANGE, *(helper for helpers in EXCHANGE.values() for helper in helpers)}


@pytest.mark.parametrize(
    "planted", ["signals.nav.t = 0.0", "signals.nav[0] = 1", "t, n = 0, signals.nav\n    n.r_I[0] = t"]
)
def test_planted_write_of_a_signal_is_found(planted):
    assert written_signals(f"def f(params, signals, memory):\n    {planted}\n") == {"nav"}
