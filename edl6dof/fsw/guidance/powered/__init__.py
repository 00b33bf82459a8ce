"""Powered guidance: the thrust vector from backshell release to touchdown."""
