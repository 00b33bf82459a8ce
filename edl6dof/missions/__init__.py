"""Comparison of dispersed flights with the published values of real missions."""
