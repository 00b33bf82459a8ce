"""Models of how a canopy fills and drags: one file for each, one line for each in the registry."""
