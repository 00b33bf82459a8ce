"""Counts of flights that may turn out either way."""

from scipy import stats


def fewest(flights: int, share: float) -> int:
    """Least number of successes, but for a chance of 1e-5, where each flight has this share of chances."""
    return int(stats.binom.ppf(1e-5, flights, share))
