"""Numbers for people."""

from __future__ import annotations


def significant(value: float, digits: int = 4) -> str:
    """A number to some significant digits; large ones whole, as 12346 is read more easily than 1.235e+04."""
    text = f"{value:.{digits}g}"
    return f"{value:.0f}" if "e+" in text else text


def printed(unit: str) -> str:
    """A unit as it is printed: its powers raised."""
    return unit.translate(str.maketrans("234", "²³⁴"))
