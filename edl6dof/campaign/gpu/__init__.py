"""Flights on a GPU, by the loop that the processor flies: the same source, compiled by numba-cuda.

Only what flies there is imported here, so that the package needs no numba-cuda.
"""
