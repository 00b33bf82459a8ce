"""Two-level designs: in which flights each quantity is high and in which low.

Source: Plackett and Burman, Biometrika 33 (1946) 305; Paley, J. Math. Phys. 12 (1933) 311.
"""

from __future__ import annotations

from itertools import count

import numpy as np


def hadamard(order: int) -> np.ndarray | None:
    """Matrix of -1 and 1 with orthogonal columns, shape (order, order), by Paley's first construction and by
    doubling; ``None`` where neither makes one.
    """
    if order == 1:
        return np.ones((1, 1))
    if order % 4 == 0 and _is_prime(order - 1):
        return _paley(order - 1)
    half = hadamard(order // 2) if order % 2 == 0 else None
    return None if half is None else np.kron([[1.0, 1.0], [1.0, -1.0]], half)


def at_least(order: int) -> np.ndarray:
    """The smallest such matrix of at least an order."""
    return next(found for size in count(max(order, 1)) if (found := hadamard(size)) is not None)


def design(columns: int, more: int, pairs: int, seed: int) -> np.ndarray:
    """Signs of the first flight of each pair, shape (at least ``pairs``, columns + more); those of the second
    are opposite.

    The first ``columns`` are orthogonal to each other, as there are at least as many pairs; ``more`` columns
    are drawn.
    """
    generator = np.random.default_rng(seed)
    matrix = at_least(max(pairs, columns))
    orthogonal = matrix[:, generator.permutation(len(matrix))[:columns]]
    return np.hstack([orthogonal, generator.choice([-1.0, 1.0], (len(matrix), more))])


def _is_prime(number: int) -> bool:
    return number > 1 and all(number % divisor for divisor in range(2, int(number**0.5) + 1))


def _paley(prime: int) -> np.ndarray:
    """``prime`` leaves 3 when divided by 4."""
    numbers = np.arange(prime)
    character = np.where(np.isin(numbers, numbers[1:] ** 2 % prime), 1.0, -1.0)
    character[0] = 0.0
    matrix = np.eye(prime + 1)
    matrix[0, 1:], matrix[1:, 0] = 1.0, -1.0
    matrix[1:, 1:] += character[(numbers[:, None] - numbers) % prime]
    return matrix
