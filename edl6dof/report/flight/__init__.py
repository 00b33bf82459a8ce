"""The review of one flight: the words, tables and figures that an entry, descent and landing review
expects.
"""
