"""Faults of the true vehicle: their kinds, the components that they act on, and when they begin."""
