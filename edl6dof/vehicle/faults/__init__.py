"""Faults of the true vehicle and when they begin; the kinds of one component each, listed in the registry."""
