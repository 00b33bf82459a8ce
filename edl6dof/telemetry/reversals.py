"""Reversals of the bank angle: turns from one side to the other."""

from __future__ import annotations

import numpy as np

#: Bank angle (deg) on either side that a reversal exceeds.
_ASIDE_DEG = 5.0


def reversal_rows(bank: np.ndarray) -> list[int]:
    """Return the rows in which a bank angle (deg), shape (rows,), passes zero for a reversal: from more than
    ``_ASIDE_DEG`` on one side to more on the other.  Heading alignment passes zero with smaller angles.
    """
    aside = np.flatnonzero(np.abs(bank) > _ASIDE_DEG)
    turned = np.flatnonzero(np.diff(np.sign(bank[aside])))
    spans = zip(aside[turned], aside[turned + 1], strict=True)
    return [int(start + 1 + np.flatnonzero(bank[start:end] * bank[end] <= 0.0)[-1]) for start, end in spans]
