"""Many flights of one scenario: cases, sampling, executor, store of results, statistics."""
