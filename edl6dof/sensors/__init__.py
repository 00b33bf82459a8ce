"""Sensors: the only way by which the flight software learns about the world.

A sensor is one file and one line in the registry; a vehicle carries several at once.
"""
