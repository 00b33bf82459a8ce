"""Covariance at an event from a few dozen designed flights, and what each dispersion gives to it."""
