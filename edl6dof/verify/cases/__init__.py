"""Check cases: each a function whose docstring, or that of its file, states what it verifies and against
what.
"""
