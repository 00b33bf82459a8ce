"""Figures of merit of a flight, the limits they must keep, and the published values they stand beside."""
