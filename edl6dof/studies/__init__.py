"""The papers' own experiments, flown with this simulator, and their published figures beside what comes
out.
"""
