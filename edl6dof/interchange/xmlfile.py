"""XML from strangers, read safely: no entities, no DTD, no network, no giant trees.

A file that declares entities is refused as a whole (they are how XML attacks work, and no model needs them);
a mere reference to a DTD, as NASA's files carry it, is allowed and never followed.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from edl6dof.config.document.locate import shown
from edl6dof.config.document.regular import read_regular
from edl6dof.config.errors import ConfigError, Problem

if TYPE_CHECKING:
    from lxml import etree

MAX_BYTES = 5_000_000

_ENTITIES = "declares XML entities, which are not allowed"


def read_xml(path: Path) -> etree._Element:
    """Root element of an XML file.

    Raises:
        ConfigError: the file cannot be read, is no XML, or declares entities.
    """
    try:
        content = read_regular(path, MAX_BYTES)
    except OSError as error:
        raise refused(path, 0, f"cannot be read: {error.strerror or error}") from None
    declared = content.replace(b"\0", b"").find(b"<!ENTITY")  # without the zeros of UTF-16
    if declared >= 0:
        raise refused(path, content.count(b"\n", 0, declared) + 1, _ENTITIES)
    from lxml import etree  # here: most runs read no XML, and need not hold its library

    parser = etree.XMLParser(
        resolve_entities=False,
        load_dtd=False,
        dtd_validation=False,
        no_network=True,
        huge_tree=False,
        remove_comments=True,
        remove_pis=True,
    )
    try:
        root = etree.fromstring(content, parser)
    except etree.XMLSyntaxError as error:
        line, column = error.position
        raise refused(path, line, f"is not well-formed XML: {error.msg}", column) from None
    dtd: Any = root.getroottree().docinfo.internalDTD
    if dtd is not None and any(True for _ in dtd.iterentities()):
        raise refused(path, 1, _ENTITIES)
    return root


def refused(path: Path, line: int, message: str, column: int = 1, name: str = "") -> ConfigError:
    """The error of one place in a file."""
    return ConfigError([Problem(shown(path), line, column if line else 0, name, message)])


def line_of(element: etree._Element) -> int:
    """Line on which an element begins."""
    line: Any = element.sourceline
    return int(line or 0)


def text_of(element: etree._Element) -> str:
    """Text of an element without blanks around it; empty when it has none."""
    return (element.text or "").strip()


def local_name(element: etree._Element) -> str:
    """Tag without its namespace."""
    return str(element.tag).rpartition("}")[2]
