"""Check cases that ship with the package: each compares the simulator with an independent source."""
