"""The format of numbers and units in reports and tables."""

from __future__ import annotations

from math import floor, log10


def significant(value: float, digits: int = 4) -> str:
    """Format a number to some significant digits; large ones whole, not as 1.235e+04."""
    text = f"{value:.{digits}g}"
    return f"{value:.0f}" if "e+" in text else text


def aligned(*values: float) -> list[str]:
    """Format numbers with the same decimals: two digits of the span between them, and four at most in all.

    >>> aligned(86.12345, 86.0, 86.9)
    ['86.12', '86.00', '86.90']
    >>> aligned(12345.6, 12000.0, 13000.0)
    ['12346', '12000', '13000']
    """
    largest = max(map(abs, values)) or 1.0
    span = max(values) - min(values) or largest
    places = max(min(1 - floor(log10(span)), 3 - floor(log10(largest))), 0)
    return [f"{value:.{places}f}" for value in values]


def in_percent(share: float, decimals: int = 0) -> str:
    """Format a share as a percentage.

    >>> in_percent(0.963, 2), in_percent(0.5)
    ('96.30 %', '50 %')
    """
    return f"{100.0 * share:.{decimals}f} %"


def printed(unit: str) -> str:
    """Format a unit for print, with raised powers."""
    return unit.translate(str.maketrans("234", "²³⁴"))
