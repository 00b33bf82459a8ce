"""What the flight software is told about the world: the only door between plant and flight software."""
