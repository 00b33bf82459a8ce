"""Many flights of one scenario: cases, the executor that flies them, sampling, the store of results,
statistics.
"""
