"""Plain scalars of the YAML 1.2 core schema: text to Python value and back.

PyYAML follows YAML 1.1, where ``1e5`` is text, ``on`` is a boolean and ``1_000`` a number; none of that is
wanted here.
"""

from __future__ import annotations

import json
import math
import re
from typing import Any

Scalar = str | int | float | bool | None

_NULL = {"", "~", "null", "Null", "NULL"}
_BOOL = {"true": True, "True": True, "TRUE": True, "false": False, "False": False, "FALSE": False}
_INT = re.compile(r"[-+]?[0-9]+")
_BASED = re.compile(r"0o[0-7]+|0x[0-9a-fA-F]+")
_FLOAT = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?")
_NOT_FINITE = re.compile(r"[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN)")
_PLAIN = re.compile(r"[A-Za-z_][A-Za-z0-9_./+-]*( [A-Za-z0-9_(][A-Za-z0-9_./+()-]*)*")
_LONGEST_NUMBER = 300
#: Words that YAML 1.1, and so many a program, takes for true and false.
BOOLEAN_WORDS = {
    **dict.fromkeys(("y", "yes", "on"), True),
    **dict.fromkeys(("n", "no", "off"), False),
}


def read_scalar(text: str) -> Scalar:
    """Value of a plain (unquoted) scalar.

    Raises:
        ValueError: the number is infinite, not a number or absurdly long.
    """
    if text in _NULL:
        return None
    if text in _BOOL:
        return _BOOL[text]
    if _NOT_FINITE.fullmatch(text):
        raise ValueError("must be a finite number")
    is_number = _FLOAT.fullmatch(text) or _BASED.fullmatch(text)
    if is_number and len(text) > _LONGEST_NUMBER:
        raise ValueError(f"number with more than {_LONGEST_NUMBER} characters")
    if _INT.fullmatch(text):
        return int(text)
    if _BASED.fullmatch(text):
        return int(text, 0)
    if _FLOAT.fullmatch(text):
        value = float(text)
        if not math.isfinite(value):
            raise ValueError("must be a finite number; this one is too large")
        return value
    return text


def write_scalar(value: Scalar) -> str:
    """Text that reads back as exactly ``value``, in YAML 1.1 too: ``'off'`` in quotes, ``1.0e-05``."""
    if value is None:
        return "null"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int | float):
        text = repr(value)
        return text.replace("e", ".0e") if "e" in text and "." not in text else text
    if _PLAIN.fullmatch(value) and read_scalar(value) == value and value.lower() not in BOOLEAN_WORDS:
        return value
    return "".join(ch if ch.isprintable() else _escape(ch) for ch in json.dumps(value, ensure_ascii=False))


def write_flow(value: Any) -> str:
    """A scalar, or nested lists and mappings of scalars, on one line."""
    if isinstance(value, list | tuple):
        return "[" + ", ".join(write_flow(item) for item in value) + "]"
    if isinstance(value, dict):
        return (
            "{"
            + ", ".join(f"{write_scalar(str(key))}: {write_flow(item)}" for key, item in value.items())
            + "}"
        )
    return write_scalar(value)


def _escape(ch: str) -> str:
    code = ord(ch)
    return f"\\u{code:04x}" if code <= 0xFFFF else f"\\U{code:08x}"
