"""Check cases that ship with the package: each compares the simulator with something that does not come from
it.
"""
