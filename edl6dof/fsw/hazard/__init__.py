"""Hazard detection: maps of the ground from the imaging sensors, safe cells, and the choice of a landing
spot.

The coarse choice, at the start of powered descent, uses an image of hazard density; the fine choice, in
hover, a map of elevations.
"""
