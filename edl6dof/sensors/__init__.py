"""What the flight software is told about the world: the only door between plant and flight software.

A sensor is one file and one line in the registry; a vehicle carries several at once.
"""
