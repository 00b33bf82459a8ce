"""The report of a campaign: where the flights came down, how they stand against the limits, and what drives
them.
"""
