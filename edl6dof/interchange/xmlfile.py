"""XML from strangers, read safely: no entities, no DTD, no network, no giant trees.

A file that declares entities is refused as a whole (they are how XML attacks work, and no model needs them);
a mere reference to a DTD, as NASA's files carry it, is allowed and never followed.
"""

from __future__ import annotations

from pathlib import Path
from xml.etree.ElementTree import Element, TreeBuilder
from xml.parsers import expat

from edl6dof.config.document.locate import shown
from edl6dof.config.document.regular import read_regular
from edl6dof.config.errors import ConfigError, Problem

MAX_BYTES = 5_000_000
#: No model nests its elements as deep.
DEEPEST = 100

_ENTITIES = "declares XML entities, which are not allowed"


class Located(Element):
    """An element, without its namespace, and the line on which it begins."""

    line = 0


def read_xml(path: Path) -> Element:
    """Root element of an XML file.

    Raises:
        ConfigError: the file cannot be read, is no XML, or declares entities.
    """
    try:
        content = read_regular(path, MAX_BYTES)
    except OSError as error:
        raise refused(path, 0, f"cannot be read: {error.strerror or error}") from None
    tree, parser, open_tags = TreeBuilder(element_factory=Located), expat.ParserCreate(), list[str]()

    def start(tag: str, attributes: dict[str, str]) -> None:
        open_tags.append(tag.rpartition(":")[2])
        if len(open_tags) > DEEPEST:
            raise refused(path, parser.CurrentLineNumber, f"is nested more than {DEEPEST} elements deep")
        element = tree.start(open_tags[-1], attributes)
        assert isinstance(element, Located)
        element.line = parser.CurrentLineNumber

    def entity(*_: object) -> None:
        raise refused(path, parser.CurrentLineNumber, _ENTITIES)

    parser.StartElementHandler, parser.EndElementHandler = start, lambda _: tree.end(open_tags.pop())
    parser.CharacterDataHandler, parser.buffer_text = tree.data, True
    parser.EntityDeclHandler = parser.SkippedEntityHandler = entity
    try:
        parser.Parse(content, True)
    except expat.ExpatError as error:
        words = f"is not well-formed XML: {expat.ErrorString(error.code)}"
        raise refused(path, error.lineno, words, error.offset + 1) from None
    return tree.close()


def refused(path: Path, line: int, message: str, column: int = 1, name: str = "") -> ConfigError:
    """The error of one place in a file."""
    return ConfigError([Problem(shown(path), line, column if line else 0, name, message)])


def line_of(element: Element) -> int:
    """Line on which an element begins."""
    return getattr(element, "line", 0)


def text_of(element: Element) -> str:
    """Text of an element without blanks around it; empty when it has none."""
    return (element.text or "").strip()
