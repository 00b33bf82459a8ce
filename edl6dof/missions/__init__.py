"""Missions that flew: dispersed flights of each beside what was published of it.

A mission is data: a scenario that says what was ``published`` of a real flight, and whose own file disperses
it (``campaign``).  The shipped ones are found by that.
"""
