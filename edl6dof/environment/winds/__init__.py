"""Models of the mean wind against altitude: one file for each, one line for each in the registry."""
