"""Models of a landing engine's thrust: one file for each, one line for each in the registry."""
