"""Mutations that know what a file is made of: nodes of YAML trees go from one shipped file into another,
values change their unit, form or script, columns of tables and elements of DAVE-ML change places.
"""

from __future__ import annotations

import copy
import json
import math
import random
import re
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import yaml
from attack_lines import DAVEML, ROOT, TABLES, checked_and_flown
from attempt import Ended

#: Factors by which a value is wrong when its unit is another one.
UNITS = (1e3, 1e-3, 1e-6, math.radians(1.0), math.degrees(1.0), 0.3048, 4.4482216, 9.80665, 60.0, 101325.0)
SUFFIXES = ("_m", "_km", "_deg", "_rad", "_s", "_ms", "_kg", "_n", "_pa", "_kpa", "_m_s", "_deg_s", "_g", "")
NUMBERS = (
    *(5e-324, 2.2250738585072014e-308, 1.7976931348623157e308, 2**53 + 1, 2**63, -(2**63) - 1, 1e22, -0.0),
    *(0.1 + 0.2, 1.0 - 2**-53, 1.0 + 2**-52, math.nan, math.inf, -math.inf, True, False, 10**40),
)
#: Ways to write the same text, or one that looks the same.
SCRIPTS: tuple[Callable[[str], str], ...] = (
    lambda text: "".join(chr(ord(c) + 0xFEE0) if "!" <= c <= "~" else c for c in text),  # full width
    lambda text: text.translate(str.maketrans("aeopcx", "аеорсх")),  # Cyrillic
    lambda text: text.translate(str.maketrans("0123456789", "٠١٢٣٤٥٦٧٨٩")),
    lambda text: "\u200b".join(text),
    lambda text: f"\u202e{text}",
    lambda text: f"\ufeff{text}",
    lambda text: text + "\u0301" * 40,
    lambda text: text.replace("_", "\u00a0").replace("-", "\u2212"),
    lambda text: f"{text}\x85\u2028\u2029",
    lambda text: f"{text}\U000e0041\U0001f468\u200d\U0001f680",
    lambda text: text.upper().replace("I", "\u0130").replace("S", "\u1e9e"),
    lambda text: f"{text}\x00",
)
#: Ways to write a whole document.
FORMS: tuple[Callable[[str], bytes], ...] = (
    lambda text: text.encode(),
    lambda text: text.encode(),
    lambda text: text.encode(),
    lambda text: text.encode("utf-8-sig"),
    lambda text: text.encode("utf-16"),
    lambda text: text.encode("utf-32-le"),
    lambda text: text.replace("\n", "\r\n").encode(),
    lambda text: text.replace("\n", "\r").encode(),
    lambda text: f"%YAML 1.1\n---\n{text}...\n".encode(),
    lambda text: f"{text}---\n{text}".encode(),
    lambda text: f"--- !!omap\n{text}".encode(),
    lambda text: re.sub(r"^(\w+):", r'"\1":', text, flags=re.MULTILINE).encode(),
    lambda text: re.sub(r": (-?[\d.]+)$", r': !!str "\1"', text, flags=re.MULTILINE).encode(),
    lambda text: re.sub(r": (-?\d+)\.(\d+)$", r": \1_\2:30", text, flags=re.MULTILINE).encode(),
    lambda text: (text + "<<: {name: merged}\n").encode(),
    lambda text: (text + "<<: [*x, &x {name: merged}]\n").encode(),
    lambda text: text.encode("cp1252", "replace") + b"# \xe9\n",
)

Node = tuple[Any, Any]  #: a container, and the key or index of a value in it


class Loader(yaml.CSafeLoader):
    """Takes a value with a tag of the program's own, such as ``!replace``, without it."""


Loader.add_multi_constructor(
    "!",
    lambda loader, tag, node: (
        loader.construct_sequence(node, deep=True)
        if isinstance(node, yaml.SequenceNode)
        else loader.construct_mapping(node, deep=True)
    ),
)


@cache
def shipped(folder: str) -> dict[str, Any]:
    """Trees of all shipped files of a kind."""
    place = ROOT / ("edl6dof/data/planets" if folder == "planets" else folder)
    files = sorted(place.rglob("*.yaml"))
    return {str(file.relative_to(ROOT)): yaml.load(file.read_bytes(), Loader) for file in files}


def attempt(number: int, seed: int, home: Path) -> Iterator[Ended]:
    """One mutation, with random numbers of its own."""
    draw = random.Random(f"trees/{seed}/{number}")
    kind = draw.choice((_scenario, _scenario, _scenario, _vehicle, _planet, _set, _table, _dave))
    yield from checked_and_flown(home, lambda folder: kind(draw, folder))


def _scenario(draw: random.Random, folder: Path) -> list[str]:
    return ["check", _write(draw, folder / "mutant.yaml", _changed(draw, "scenarios"))]


def _vehicle(draw: random.Random, folder: Path) -> list[str]:
    _write(draw, folder / "craft.yaml", _changed(draw, "vehicles"))
    base = draw.choice(("tianwen1", "msl", "phoenix", "viking1"))
    (folder / "mutant.yaml").write_text(f"extends: {base}\nname: mutant\nvehicle: craft.yaml\n")
    return ["check", str(folder / "mutant.yaml")]


def _planet(draw: random.Random, folder: Path) -> list[str]:
    _write(draw, folder / "world.yaml", _changed(draw, "planets"))
    (folder / "mutant.yaml").write_text("extends: tianwen1\nname: mutant\nplanet: world.yaml\n")
    return ["check", str(folder / "mutant.yaml")]


def _set(draw: random.Random, folder: Path) -> list[str]:
    """A section of one scenario set in another from the command line."""
    words = ["check", draw.choice(("tianwen1", "msl", "insight", "nesc/case06"))]
    for _ in range(draw.choice((1, 1, 2))):
        tree = draw.choice(list(shipped("scenarios").values()))
        path = draw.choice([path for path in _paths(tree) if path])
        value = copy.deepcopy(_at(tree, path))
        if draw.random() < 0.5:
            holder = [value]
            _on_value(draw, (holder, 0))
            value = holder[0]
        text = json.dumps(value, default=str, ensure_ascii=False)
        words += ["--set", f"{'.'.join(map(str, path))}={text}".replace("\0", "")]
    return words


def _changed(draw: random.Random, kind: str) -> Any:
    """The tree of a shipped file with one to three changes; the donor is of any kind."""
    tree = copy.deepcopy(draw.choice(list(shipped(kind).values())))
    donors = [donor for other in ("scenarios", "vehicles", "planets") for donor in shipped(other).values()]
    for _ in range(draw.choice((1, 1, 1, 2, 3))):
        draw.choice(_CHANGES)(draw, tree, draw.choice(donors))
    return tree


def _paths(tree: Any, here: tuple = ()) -> list[tuple]:
    inside = tree.items() if isinstance(tree, dict) else enumerate(tree) if isinstance(tree, list) else ()
    return [here, *(path for key, value in inside for path in _paths(value, (*here, key)))]


def _at(tree: Any, path: tuple) -> Any:
    for key in path:
        tree = tree[key]
    return tree


def _node(draw: random.Random, tree: Any) -> Node:
    """Any value below the root."""
    path = draw.choice([path for path in _paths(tree) if path] or [()])
    return (_at(tree, path[:-1]), path[-1]) if path else ([tree], 0)


def _graft(draw: random.Random, tree: Any, donor: Any) -> None:
    """The donor's value of the same name, or of the same type, or any."""
    place, key = _node(draw, tree)
    paths = [path for path in _paths(donor) if path]
    alike = [path for path in paths if path[-1] == key]
    typed = [path for path in paths if type(_at(donor, path)) is type(place[key])]
    place[key] = copy.deepcopy(_at(donor, draw.choice(draw.choice((alike, typed, paths)) or paths)))


def _swap(draw: random.Random, tree: Any, donor: Any) -> None:
    """Two values of the same tree, unless one holds the other."""
    (one, first), (two, second) = _node(draw, tree), _node(draw, tree)
    one[first], two[second] = copy.deepcopy(two[second]), copy.deepcopy(one[first])


def _moved(draw: random.Random, tree: Any, donor: Any) -> None:
    """A key and its value put into another section."""
    place, key = _node(draw, tree)
    sections = [found for path in _paths(tree) if isinstance(found := _at(tree, path), dict)]
    if isinstance(place, dict) and sections:
        draw.choice(sections)[key] = copy.deepcopy(place.pop(key))


def _renamed(draw: random.Random, tree: Any, donor: Any) -> None:
    """A key with another unit, or written in another script."""
    place, key = _node(draw, tree)
    if not isinstance(place, dict) or not isinstance(key, str):
        return
    stem = re.sub(r"_(m|km|deg|rad|s|kg|n|pa|m_s|deg_s)$", "", key)
    name = stem + draw.choice(SUFFIXES) if draw.random() < 0.6 else draw.choice(SCRIPTS)(key)
    place[draw.choice((name, name, name, 3, None, 1.5, True))] = place.pop(key)


def _repeated(draw: random.Random, tree: Any, donor: Any) -> None:
    """A list longer than its place, empty, backwards, nested; a value as a list, a list as a value."""
    lists = [path for path in _paths(tree) if path and isinstance(_at(tree, path), list)]
    path = draw.choice(lists) if lists else ()
    place, key = (_at(tree, path[:-1]), path[-1]) if path else _node(draw, tree)
    value = place[key] if isinstance(place[key], list) else [place[key]]
    place[key] = draw.choice(
        (value * 2, value * 40, [], value[::-1], [value], value[0] if value else None, {"0": value})
    )


def _value(draw: random.Random, tree: Any, donor: Any) -> None:
    leaves = [path for path in _paths(tree) if path and not isinstance(_at(tree, path), dict | list)]
    if leaves:
        path = draw.choice(leaves)
        _on_value(draw, (_at(tree, path[:-1]), path[-1]))


def _on_value(draw: random.Random, node: Node) -> None:
    place, key = node
    value = place[key]
    if isinstance(value, str):
        place[key] = draw.choice(SCRIPTS)(value)
    elif isinstance(value, int | float) and draw.random() < 0.5:
        factor = draw.choice(UNITS)
        place[key] = draw.choice(
            (value * factor, -value, math.nextafter(value, math.inf), str(value), [value])
        )
    else:
        place[key] = draw.choice(NUMBERS)


def _gone(draw: random.Random, tree: Any, donor: Any) -> None:
    place, key = _node(draw, tree)
    if draw.random() < 0.5:
        place[key] = None
    else:
        del place[key]


_CHANGES = (_graft, _graft, _graft, _swap, _moved, _renamed, _repeated, _value, _value, _value, _gone)


def _write(draw: random.Random, path: Path, tree: Any) -> str:
    """The tree as YAML: flow or block, values that occur twice as aliases or not, in some form of text."""
    text = yaml.dump(
        tree,
        default_flow_style=draw.choice((False, False, False, None, True)),
        allow_unicode=True,
        width=1000,
    )
    path.write_bytes(draw.choice(FORMS)(text) if isinstance(tree, dict) else text.encode())
    return str(path)


def _table(draw: random.Random, folder: Path) -> list[str]:
    """A table with columns or rows in another place, in another unit, or under the key of another table."""
    key, source = draw.choice(list(TABLES)), draw.choice(list(TABLES.values()))
    rows = [line.split(",") for line in (ROOT / source).read_text().splitlines()]
    head = next(i for i, row in enumerate(rows) if len(row) == len(rows[-1]))
    body, width = rows[head + 1 :], len(rows[-1])
    one, two = draw.randrange(width), draw.randrange(width)
    whole = [row for row in rows[head:] if len(row) == width]  # others are remarks
    change = draw.randrange(9)
    if change == 0:
        for row in whole[draw.choice((0, 1)) :]:
            row[one], row[two] = row[two], row[one]
    elif change == 1:
        factor = draw.choice(UNITS)
        for row in whole[1:]:
            row[one] = f"{row[one]}e{round(math.log10(factor))}"
    elif change == 2:
        body.reverse()
    elif change == 3:
        draw.shuffle(body)
    elif change == 4:
        body[:] = [row for row in body for _ in range(2)]
    elif change == 5:
        draw.choice(whole)[one] = draw.choice(
            ("", "1,5", "١", "1e5\u200b", "0x1p3", "1_0", "NaN", "-inf", '"')
        )
    elif change == 6:
        body[:] = [list(column) for column in zip(*body, strict=False)]
    elif change == 7:
        rows[head] = [draw.choice(SCRIPTS)(name) for name in rows[head]]
    mark = draw.choice((",", ",", ",", ";", "\t", " , "))
    text = "\n".join(mark.join(row) for row in [*rows[: head + 1], *body]) + "\n"
    (folder / "table.csv").write_bytes(draw.choice(FORMS)(text))
    return ["check", "tianwen1", "--set", f"{key}={folder / 'table.csv'}"]


def _dave(draw: random.Random, folder: Path) -> list[str]:
    """A DAVE-ML model with elements of itself or of another one in the place of its own."""
    source, other = (ROOT / draw.choice(DAVEML) for _ in range(2))
    tree, donor = ElementTree.parse(source), ElementTree.parse(other)
    for _ in range(draw.choice((1, 1, 2))):
        parents = [element for element in tree.iter() if len(element)]
        parent = draw.choice(parents)
        place, element = draw.randrange(len(parent)), draw.choice(list(donor.iter()))
        alike = [one for one in donor.iter() if one.tag == parent[place].tag]
        change = draw.randrange(6)
        if change == 0:
            parent[place] = copy.deepcopy(element)
        elif change == 1 and alike:
            parent[place] = copy.deepcopy(draw.choice(alike))
        elif change == 2:
            parent.append(copy.deepcopy(parent[place]))
        elif change == 3:
            parent.remove(parent[place])
        elif change == 4 and parent[place].attrib:
            name = draw.choice(list(parent[place].attrib))
            parent[place].set(name, draw.choice([*element.attrib.values(), "", "1e400", "٣", "a" * 300]))
        else:
            value = (parent[place].text or "").strip() or "0"
            parent[place].text = draw.choice((f"{value} {value}", "", "NaN", "1,2", f"-({value})", "1 2\n3"))
    text = ElementTree.tostring(tree.getroot(), encoding="unicode")
    (folder / "model.dml").write_bytes(draw.choice(FORMS[:8])(text))
    model = source.name.split("_")[0]
    rest = [str(ROOT / one) for one in DAVEML if model in one and not one.endswith(source.name)]
    case = "nesc/case02" if model == "brick" else "nesc/case01"
    return ["check", case, "--set", f"vehicle.daveml={json.dumps([str(folder / 'model.dml'), *rest])}"]
