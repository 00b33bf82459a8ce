"""Figures of merit of a flight, their limits, and the published values to compare them with."""
