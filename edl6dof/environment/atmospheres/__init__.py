"""Models of the air against altitude: one file for each, one line for each in the registry."""
