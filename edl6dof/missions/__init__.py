"""Comparison of dispersed flights with the published values of real missions.

A mission is data: a scenario with the ``published`` values of a real flight and a file that disperses it
(``campaign``).  Shipped missions are found by these sections.
"""
